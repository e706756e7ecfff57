"""Pictures of a run: what is drawn is what is in the data, in the units on the axes."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib import colormaps
from numpy.typing import NDArray

from pockmark.base.geometry import Setup
from pockmark.metrology.crater import Crater
from pockmark.view.plots import Cut, history_figure, process_figure, slice_figure

UM = 1e-6
H = 2.0 * UM  # point spacing
TARGET, PROJECTILE = 0, 1
SETUP = Setup(H, names=("slab", "cube"), projectiles=(PROJECTILE,))


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
        "time": np.array([20e-9]),
    }


def draw(snapshot: dict[str, NDArray[Any]], crater: Crater | None = None) -> Any:
    figure = slice_figure(snapshot, SETUP, crater=crater, title="a run")
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
    figure, (_, stress, pressure) = draw(snapshot)
    for axes, value, limits, colours in (
        (stress, 100 * np.sqrt(3), (0, 600), "viridis"),
        (pressure, -250, (-600, 600), "coolwarm"),
    ):
        expected = colormaps[colours]((value - limits[0]) / (limits[1] - limits[0]))
        assert np.allclose(axes.collections[0].get_facecolor(), expected, atol=0.01)
    bars = [axes for axes in figure.axes if not axes.get_title()]
    assert [axes.get_ylim() for axes in bars[1:]] == [(0, 600), (-600, 600)]


def test_projectile_is_white_on_air_that_is_not_in_every_panel(snapshot):
    _, panels = draw(snapshot)
    for axes in panels:
        projectile = axes.collections[1]
        assert projectile.get_facecolor()[0, :3] == pytest.approx(1)
        assert projectile.get_linewidths() == [0]  # edges would blacken a lining of small points
        assert min(axes.get_facecolor()[:3]) < 0.95


def test_targets_are_told_apart_and_named(snapshot):
    snapshot["body"][: len(snapshot["body"]) // 2] = 2
    figure = slice_figure(snapshot, replace(SETUP, names=("slab", "cube", "film")), crater=None, title="two")
    bodies = figure.axes[0]
    assert len(np.unique(bodies.collections[0].get_facecolor(), axis=0)) == 2
    assert [text.get_text() for text in bodies.get_legend().get_texts()] == ["slab", "film"]


@pytest.mark.parametrize("stretch", [(1, 1, 0.2), (1, 1, 1), (0.2, 1, 1), (50, 50, 50)])
def test_the_panels_fill_the_figure(snapshot, stretch):
    snapshot["position"] = snapshot["position"] * stretch
    snapshot["volume"] = snapshot["volume"] * np.prod(stretch)
    figure = slice_figure(snapshot, replace(SETUP, spacing=50 * H), crater=None, title="a run")
    figure.draw_without_rendering()
    panels = [axes.get_position() for axes in figure.axes if axes.get_title()]
    blank = (1 - sum(p.height for p in panels)) * figure.get_size_inches()[1]
    print(figure.get_size_inches(), blank, panels[0].width)
    assert blank < 2.2  # inches: titles, labels and the ticks' numbers


def test_a_process_has_a_column_a_snapshot_read_one_at_a_time(snapshot):
    times = (20e-9, 40e-9)
    figure = process_figure((snapshot | {"time": np.array([time])} for time in times), SETUP)
    titles = [axes.get_title() for axes in figure.axes if axes.get_title()]
    assert titles == ["20 ns", "40 ns"]
    assert all(len(axes.collections[0].get_offsets()) == 20 * 10 for axes in figure.axes[:4])


def test_a_slice_without_points_is_drawn(snapshot):
    slice_figure(snapshot, replace(SETUP, centre=(0.0, 1.0)), crater=None, title="nothing there")


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
    crater = Crater(7.3 * UM, (UM, UM), 10 * UM, 1e-15, 0.0, 20 * UM, contour=None, pithead=None)
    _, panels = draw(snapshot, crater)
    # Above the panel, where it hides no wall; within it there is only the arrow.
    assert all("7.3" in axes.get_title(loc="right") for axes in panels)
    assert not any(text.get_text() for axes in panels for text in axes.texts)
    _, panels = draw(snapshot)
    assert not any(axes.get_title(loc="right") or axes.texts for axes in panels)


def test_a_slice_without_projectile_is_drawn(snapshot, tmp_path: Path):
    kept = snapshot["body"] == TARGET
    of_points = snapshot.keys() - {"time"}
    figure, _ = draw(snapshot | {name: snapshot[name][kept] for name in of_points})
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


def test_rings_are_drawn_on_both_sides_of_the_axis_as_wide_as_their_section():
    r = np.array([1.0, 3.0, 7.0]) * UM
    fields = {
        "position": np.column_stack([r, 0 * r, -r]),
        "volume": 2 * np.pi * r * H**2,
        "body": np.array([TARGET, TARGET, PROJECTILE]),
        "deviator": np.zeros((3, 6)),
        "pressure": np.zeros(3),
        "time": np.array([0.0]),
    }
    cut = Cut.of(fields, replace(SETUP, is_axisymmetric=True))
    assert sorted(cut.x) == pytest.approx([-7, -3, -1, 1, 3, 7])
    assert cut.z == pytest.approx(-np.abs(cut.x))
    assert cut.width == pytest.approx(2)
    assert list(cut.is_projectile) == [False, False, True] * 2
