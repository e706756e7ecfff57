"""Pictures of a run: what is drawn is what is in the data, in the units on the axes."""

import io
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib import colormaps
from numpy.typing import NDArray
from planes import PROJECTILE, SETUP, TARGET, UM, H, block, fields, only

from pockmark.metrology.crater import Crater
from pockmark.metrology.surface import target_filling
from pockmark.view.plots import fields_figure, history_figure, process_figure, slice_figure, top_figure
from pockmark.view.quantities import HEIGHT, PRESSURE, QUANTITIES, STRESS, TEMPERATURE

CRATER = Crater(7.3 * UM, (UM, UM), 10 * UM, 1e-15, 0.0, 20 * UM, contour=None, pithead=None)


@pytest.fixture
def snapshot() -> dict[str, NDArray[Any]]:
    """A slab of target 40 x 8 x 20 um (half model) under a cube of projectile, in uniform known stress."""
    slab, cube = block((-20, 0, -20), (20, 8, 0)), block((-4, 0, 0), (4, 4, 8))
    made = fields(np.concatenate([slab, cube]), np.repeat([TARGET, PROJECTILE], [len(slab), len(cube)]))
    made["deviator"][:, 3] = 100e6  # simple shear: effective stress sqrt(3) tau
    made["pressure"][:] = -250e6
    return made


def draw(snapshot, crater=None, setup=SETUP, drawing=slice_figure):
    """The figure and its panels, where a warning is a fault."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        figure = drawing(snapshot, setup, crater=crater, title="a run")
        figure.savefig(io.BytesIO(), dpi=40)
    return figure, [axes for axes in figure.axes if axes.get_title()]


def pixels(axes):
    """The drawn array (z, x) and the centres of its pixels, um."""
    image = axes.images[0]
    array, (left, right, low, high) = image.get_array(), image.get_extent()
    nz, nx = array.shape
    dx, dz = (right - left) / nx, (high - low) / nz
    return array, left + dx * (np.arange(nx) + 0.5), low + dz * (np.arange(nz) + 0.5)


def texts(axes):
    return [text.get_text() for text in axes.texts if text.get_text()]


def test_slice_shows_stress_and_pressure_in_mpa_and_the_extremes_of_the_points(snapshot):
    snapshot["pressure"][0] = 90e6  # at the plane, at the slab's edge
    figure, (_, stress, pressure) = draw(snapshot)
    for axes, value, told in (
        (stress, 100 * np.sqrt(3), "points: 173.2 MPa"),
        (pressure, -250, "points: -250 to 90 MPa"),
    ):
        array, x, z = pixels(axes)
        inside = np.ix_((z > -12) & (z < -2), np.abs(x) < 12)
        assert np.allclose(array[inside], value)
        assert texts(axes) == [told]
    assert [axes.get_ylabel() for axes in figure.axes if "colours" in axes.get_ylabel()] == [
        "MPa (colours: 0.2 to 99.8 % of the area)"
    ] * 2


def test_a_process_has_the_range_of_the_paper_and_a_column_a_snapshot_read_one_at_a_time(snapshot):
    times = (20e-9, 40e-9)
    figure = process_figure((snapshot | {"time": np.array([time])} for time in times), SETUP)
    panels, bars = figure.axes[:4], figure.axes[4:]
    assert [axes.get_title() for axes in panels] == ["20 ns", "40 ns", "", ""]
    assert [axes.images[0].get_clim() for axes in panels] == [(0, 600)] * 2 + [(-600, 600)] * 2
    assert all("the paper's range" in axes.get_ylabel() for axes in bars)
    assert all(pixels(axes)[0].count() > 1000 for axes in panels)


def test_a_few_odd_pixels_do_not_decide_about_the_colours():
    drawn = np.append(np.linspace(-80, 100, 10_000), [5e4, -3e6])
    assert PRESSURE.span(drawn).vmax == pytest.approx(100, rel=0.01)
    assert PRESSURE.span(drawn).vmin == -PRESSURE.span(drawn).vmax
    assert STRESS.span(drawn).vmin == 0
    assert TEMPERATURE.span(drawn).vmin == pytest.approx(-80, rel=0.01)


@pytest.mark.parametrize("quantity", QUANTITIES.values(), ids=lambda q: q.name)
@pytest.mark.parametrize("value", [[], [0.0], [293.0], [-5.0, -5.0 + 1e-12], [np.nan]], ids=str)
def test_a_field_that_is_the_same_everywhere_has_a_range(quantity, value):
    span = quantity.span(np.array(value))
    assert span.vmax > span.vmin


@pytest.mark.parametrize("quantity", [*QUANTITIES.values(), HEIGHT], ids=lambda q: q.name)
def test_the_maps_are_told_apart_by_their_lightness_alone(quantity):
    """What the colour-blind, and a black and white print, see: it rises all the way, or falls to both sides of 0."""
    colour = colormaps[quantity.colours](np.linspace(0, 1, 256))[:, :3]
    linear = np.where(colour <= 0.04045, colour / 12.92, ((colour + 0.055) / 1.055) ** 2.4)
    luminance = linear @ (0.2126, 0.7152, 0.0722)
    lightness = np.where(luminance > 0.008856, 116 * np.cbrt(luminance) - 16, 903.3 * luminance)
    step = np.diff(lightness)
    if quantity.kind != "both":
        assert (step > 0).all()
        assert step.max() < 3 * step.mean()  # even: no band that is not in the data
    else:
        assert (step[:126] > 0).all()
        assert (step[130:] < 0).all()
        # The two signs by what all of the colour-blind but a few see: yellow against blue.
        yellow = linear[:, :2].mean(axis=1) - linear[:, 2]
        assert (yellow[:96] < -0.05).all()
        assert (yellow[160:] > yellow[:96].max() + 0.1).all()


def rgb_of(figure):
    figure.canvas.draw()
    return np.asarray(figure.canvas.buffer_rgba())[:, :, :3].astype(float)


@pytest.mark.parametrize("value", np.linspace(-600, 600, 7))
def test_the_projectiles_outline_differs_from_any_ground(snapshot, value):
    """Along the edge of the ball there are pixels far darker and pixels far lighter than its ground, or one of them."""
    snapshot["pressure"][:] = value * 1e6
    snapshot["pressure"][snapshot["position"][:, 0] < -16e-6] = 600e6  # the range
    figure, panels = draw(snapshot)
    image = rgb_of(figure)
    axes = panels[2]
    row = image[image.shape[0] - 1 - round(axes.transData.transform((0, 5))[1])]
    left, middle = (round(axes.transData.transform((x, 5))[0]) for x in (-6, 0))
    ground = row[middle]
    contrast = np.abs(row[left:middle] - ground).max(axis=1)
    print(value, ground, contrast.max())
    assert contrast.max() > 100


def test_bodies_are_told_apart_and_named(snapshot):
    snapshot["body"][: len(snapshot["body"]) // 2] = 2
    _, (bodies, *_) = draw(snapshot, setup=replace(SETUP, names=("slab", "ball", "film")))
    array, _, _ = pixels(bodies)
    image = bodies.images[0]
    assert len({tuple(image.cmap(image.norm(one))) for one in np.unique(array.compressed())}) == 3
    assert [text.get_text() for text in bodies.get_legend().get_texts()] == ["slab", "film", "projectile"]


@pytest.mark.parametrize("stretch", [(1, 1, 0.2), (1, 1, 1), (0.2, 1, 1), (50, 50, 50)])
def test_the_panels_fill_the_figure(snapshot, stretch):
    snapshot["position"] = snapshot["position"] * stretch
    snapshot["volume"] = snapshot["volume"] * np.prod(stretch)
    figure, panels = draw(snapshot, setup=replace(SETUP, spacing=50 * H * UM))
    figure.draw_without_rendering()  # at the dots per inch that it has
    boxes = [axes.get_position() for axes in panels]
    blank = (1 - sum(box.height for box in boxes)) * figure.get_size_inches()[1]
    print(figure.get_size_inches(), blank, boxes[0].width)
    assert blank < 2.2  # inches: titles, labels and the ticks' numbers


def test_original_surface_is_dotted(snapshot):
    _, panels = draw(snapshot)
    for axes in panels:
        (line,) = axes.lines
        assert line.get_linestyle() == ":"
        assert list(line.get_ydata()) == [0, 0]


@pytest.mark.parametrize("drawing", [slice_figure, fields_figure])
def test_crater_depth_is_marked_where_there_is_a_crater(snapshot, drawing):
    _, panels = draw(snapshot, CRATER, drawing=drawing)
    # Above the panel, where it hides no wall; within it there is only the arrow.
    assert all("7.3" in axes.get_title(loc="right") for axes in panels)
    _, panels = draw(snapshot, drawing=drawing)
    assert not any(axes.get_title(loc="right") for axes in panels)


def test_a_field_that_the_snapshot_lacks_is_a_sentence_in_its_panel(snapshot):
    del snapshot["temperature"]
    _, panels = draw(snapshot, drawing=fields_figure)
    assert texts(panels[0]) == ["the snapshot lacks the field temperature"]
    assert all(axes.images for axes in panels[1:])


def test_damage_is_clipped_to_its_meaning(snapshot):
    snapshot["damage"][:] = np.where(snapshot["position"][:, 0] > 0, 1.7, -0.1)
    _, panels = draw(snapshot, drawing=fields_figure)
    damage = panels[2].images[0]
    assert damage.get_clim() == (0, 1)
    assert (damage.get_array().min(), damage.get_array().max()) == (0, 1)


HALVES = {
    "nothing": lambda s: only(s, np.zeros(len(s["mass"]), dtype=bool)),
    "one point": lambda s: only(s, np.arange(len(s["mass"])) == 0),
    "no projectile": lambda s: only(s, s["body"] == TARGET),
    "no target": lambda s: only(s, s["body"] == PROJECTILE),
    "a pierced plate": lambda s: only(s, np.hypot(*s["position"][:, :2].T) > 5e-6),
    "no place": lambda s: s | {"position": s["position"] * np.nan},
    "no number": lambda s: s | {"pressure": s["pressure"] * np.nan, "temperature": s["temperature"] * np.nan},
    "one without a number": lambda s: s | {"pressure": np.where(np.arange(len(s["mass"])) == 5, np.nan, 1.0)},
    "far away": lambda s: (
        s | {"position": np.where(np.arange(len(s["mass"]))[:, None] == 5, 1.0, s["position"])}
    ),
}


@pytest.mark.parametrize("what", HALVES)
def test_what_is_degenerate_is_drawn_without_a_warning(snapshot, what, tmp_path: Path):
    """A warning is a fault; so is a pixel that is no number."""
    changed = HALVES[what](snapshot)
    for drawing in (slice_figure, fields_figure):
        _, panels = draw(changed, drawing=drawing)
        for axes in (a for a in panels if a.images):
            assert np.isfinite(axes.images[0].get_array().compressed()).all()
    process_figure([changed], SETUP).savefig(tmp_path / "process.png", dpi=50)
    top_figure(None, changed, SETUP, crater=None, title="").savefig(tmp_path / "top.png", dpi=50)


def test_one_point_is_seen(snapshot):
    _, panels = draw(HALVES["one point"](snapshot))
    array, x, z = pixels(panels[1])
    size = array.count() * (x[1] - x[0]) * (z[1] - z[0])
    assert size == pytest.approx(np.pi / 4 * H**2, rel=0.3)  # a disc as wide as the point


def test_the_top_view_has_the_depths_of_a_pit_and_the_hole_of_a_plate():
    """A pit 5 um deep, with a hole of 4 um radius in the middle of the plate."""
    setup = replace(SETUP, mirrors=())
    slab = block((-30, -30, -20), (30, 30, 0))
    radius = np.hypot(slab[:, 0], slab[:, 1])
    points = slab[(radius > 12) | ((slab[:, 2] < -6) & (radius > 6))]
    snapshot = fields(points, TARGET)
    surface = target_filling(snapshot["position"], snapshot["volume"], setup).surface()
    figure = top_figure(surface, snapshot, setup, crater=None, title="")
    array, x, y = pixels(figure.axes[0])
    r = np.hypot(x[None, :], y[:, None])
    assert array.mask[r < 4].all()
    assert np.allclose(array[(r > 8) & (r < 10)], -6, atol=0.6)
    assert np.allclose(array[(r > 15) & (r < 19)], 0, atol=0.3)


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
