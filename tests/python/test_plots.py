"""Pictures of a run: what is drawn is what is in the data, in the units on the axes."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from pockmark.crater import Crater
from pockmark.plots import history_figure, slice_figure

UM = 1e-6
H = 2.0 * UM  # point spacing
TARGET, PROJECTILE = 0, 1


@pytest.fixture
def snapshot() -> dict[str, NDArray[Any]]:
    """A slab of target 40 x 8 x 20 um (half model) under a cube of projectile 4 um wide, in uniform known stress."""
    slab = np.meshgrid(np.arange(-19, 20, 2.0), np.arange(1, 8, 2.0), np.arange(-19, 0, 2.0), indexing="ij")
    cube = np.meshgrid([-1.0, 1.0], [1.0, 3.0], [1.0, 3.0], indexing="ij")
    parts = [np.stack(p, axis=-1).reshape(-1, 3) for p in (slab, cube)]
    n = sum(map(len, parts))
    deviator = np.zeros((n, 6))
    deviator[:, 3] = 100e6  # simple shear: effective stress sqrt(3) tau
    return {
        "position": np.concatenate(parts) * UM,
        "volume": np.full(n, H**3),
        "body": np.repeat([TARGET, PROJECTILE], [len(p) for p in parts]),
        "deviator": deviator,
        "pressure": np.full(n, -250e6),
    }


def draw(snapshot: dict[str, NDArray[Any]], crater: Crater | None = None) -> Any:
    figure = slice_figure(snapshot, bodies_projectile=[PROJECTILE], spacing=H, crater=crater, title="a run")
    panels = [axes for axes in figure.axes if axes.get_title()]
    return figure, panels


def test_slice_shows_only_the_points_at_the_symmetry_plane(snapshot):
    _, panels = draw(snapshot)
    assert len(panels) == 3
    for axes in panels:
        target, projectile = axes.collections[:2]
        assert len(target.get_offsets()) == 20 * 10  # one layer, y = 1 um
        assert len(projectile.get_offsets()) == 2 * 2
        assert np.asarray(target.get_offsets()).min() == pytest.approx(-19)  # um


def test_slice_colours_are_effective_stress_and_pressure_in_mpa(snapshot):
    _, (_, stress, pressure) = draw(snapshot)
    assert np.allclose(stress.collections[0].get_array(), 100 * np.sqrt(3))
    assert stress.collections[0].get_clim() == (0, 600)
    assert np.allclose(pressure.collections[0].get_array(), -250)
    assert pressure.collections[0].get_clim() == (-600, 600)


def test_projectile_is_white_with_a_dark_edge_in_every_panel(snapshot):
    _, panels = draw(snapshot)
    for axes in panels:
        projectile = axes.collections[1]
        assert projectile.get_facecolor()[0, :3] == pytest.approx(1)
        assert projectile.get_edgecolor()[0, :3] == pytest.approx(0)


def test_original_surface_is_dotted(snapshot):
    _, panels = draw(snapshot)
    for axes in panels:
        (line,) = axes.lines
        assert line.get_linestyle() == ":"
        assert list(line.get_ydata()) == [0, 0]


def test_markers_tile_the_plane(snapshot, tmp_path: Path):
    """In the saved picture a marker is as wide as the point it stands for."""
    figure, panels = draw(snapshot)
    figure.savefig(tmp_path / "crater.png", dpi=100)
    for axes in panels:
        origin, one = axes.transData.transform([(0, 0), (2, 0)])  # a point is 2 um wide
        width = (one[0] - origin[0]) * 72 / figure.dpi
        drawn = float(np.sqrt(axes.collections[0].get_sizes()[0]))
        print(f"{axes.get_title()}: marker {drawn:.2f} pt, point {width:.2f} pt")
        assert drawn == pytest.approx(width, rel=0.1)


def test_crater_depth_is_marked(snapshot):
    crater = Crater(depth=7.3 * UM, diameter=20 * UM, volume=1e-15, bottom=(1 * UM, 1 * UM))
    _, panels = draw(snapshot, crater)
    assert all(any("7.3" in text.get_text() for text in axes.texts) for axes in panels)
    _, panels = draw(snapshot)
    assert not any(axes.texts for axes in panels)


def test_a_slice_without_projectile_is_drawn(snapshot, tmp_path: Path):
    kept = snapshot["body"] == TARGET
    figure, _ = draw({name: values[kept] for name, values in snapshot.items()})
    figure.savefig(tmp_path / "crater.png")


@pytest.fixture
def history() -> dict[str, NDArray[Any]]:
    """Half of the initial energy becomes internal, a tenth of it leaves with the points."""
    part, initial = np.linspace(0, 1, 5), 2e-5
    shares = {"kinetic": 1 - 0.7 * part, "internal": 0.5 * part, "absorbed": 0.1 * part}
    shares |= {"left_kinetic": 0.06 * part, "left_internal": 0.04 * part, "error": 0.01 * part}
    energies = {name: share * initial for name, share in shares.items()}
    return energies | {"time": part * 500e-9, "initial": np.full(5, initial), "depth": 12 * UM * part}


def test_history_shows_shares_per_cent_and_micrometres(history, tmp_path: Path):
    figure = history_figure(history)
    energy, error, depth = figure.axes
    last = {line.get_label(): line.get_ydata()[-1] for line in energy.lines}
    assert list(last.values()) == pytest.approx([0.3, 0.5, 0.1, 0.1])
    assert error.lines[0].get_ydata()[-1] == pytest.approx(1.0)
    assert "estimate" in depth.get_ylabel()
    assert depth.lines[0].get_ydata()[-1] == pytest.approx(12)
    assert depth.lines[0].get_xdata()[-1] == pytest.approx(500)
    figure.savefig(tmp_path / "history.png")


def test_no_pyplot_state_is_made(snapshot, history):
    import matplotlib.pyplot as plt

    before = plt.get_fignums()
    draw(snapshot)
    history_figure(history)
    assert plt.get_fignums() == before
