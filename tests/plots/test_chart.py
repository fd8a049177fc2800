from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from matplotlib import colors
from matplotlib.collections import LineCollection
from matplotlib.image import AxesImage
from matplotlib.patches import PathPatch

import racs_bif as rb
from racs_bif.charts.settings import ChartSettings
from racs_bif.plots.chart import COLOURS, SHADES, draw, picture, picture_slices
from racs_bif.plots.style import save_picture
from racs_bif.results.chart_curve import ChartCurve
from racs_bif.results.chart_map import ChartMap, SweepMap

QUICK = ChartSettings(coarse=3, depth=4)
BOX = ((-1.0, 1.0), (-1.0, 1.1))


@pytest.fixture(scope="module")
def bautin():
    """Return the model with Hopf points at a = 0, subcritical for b > 0."""
    return rb.model_from_strings(
        "bautin",
        {
            "x": "a*x - y + b*x*(x**2 + y**2) - x*(x**2 + y**2)**2",
            "y": "x + a*y + b*y*(x**2 + y**2) - y*(x**2 + y**2)**2",
        },
        parameters={"a": -0.5, "b": 0.2},
        guess={"x": 0.0, "y": 0.0},
    )


@pytest.fixture(scope="module")
def chart(bautin):
    return rb.stability_chart(bautin, "a", "b", BOX, lyapunov=True, settings=QUICK)


@pytest.fixture(scope="module")
def fold():
    model = rb.model_from_strings(
        "fold",
        {"x": "a - b*y - x**2", "y": "-y + x"},
        parameters={"a": 1.0, "b": 0.5},
        guess={"x": 1.0, "y": 1.0},
    )
    return rb.stability_chart(model, "a", "b", ((-1.0, 1.03), (-0.5, 1.5)))


def texts(ax):
    return {text.get_text(): text for text in ax.texts}


def test_regions_are_filled_and_say_what_they_hold(chart):
    (ax, _) = picture(chart).axes
    fills = [p for p in ax.patches if isinstance(p, PathPatch)]
    assert {colors.to_hex(p.get_facecolor()) for p in fills} == {SHADES[0], SHADES[2]}
    assert {"stable", "2 unstable", "nominal", "GH"} <= texts(ax).keys()
    stable = texts(ax)["stable"].get_position()
    assert chart.unstable_at(a=stable[0], b=stable[1]) == 0


def test_texts_cover_neither_each_other_nor_the_star(chart, fold):
    for one in (chart, fold):
        figure = picture(one)
        figure.draw_without_rendering()
        ax = figure.axes[0]
        boxes = [text.get_window_extent() for text in ax.texts]
        boxes.append(ax.get_legend().get_window_extent())
        for first, second in combinations(boxes, 2):
            assert not first.overlaps(second)
        star = ax.transData.transform(one.nominal)
        assert not any(box.contains(*star) for box in boxes)


def test_the_boundary_is_coloured_by_its_frequency(chart):
    figure = picture(chart)
    (lines,) = [c for c in figure.axes[0].collections if isinstance(c, LineCollection)]
    assert np.asarray(lines.get_array()) == pytest.approx(1.0, abs=1e-9)
    assert lines.get_cmap().name == COLOURS
    assert "omega" in figure.axes[1].get_ylabel()
    assert "rad/s" in figure.axes[1].get_ylabel()


def test_subcritical_stretches_are_marked(chart):
    ax = picture(chart).axes[0]
    (marked,) = [line for line in ax.get_lines() if line.get_label() == "subcritical"]
    y = marked.get_ydata()
    assert np.nanmin(y) >= -1e-9
    assert np.isnan(y).any()


def test_colours_are_uniform_in_lightness_and_shades_differ_in_grey():
    from matplotlib import colormaps

    rgb = colormaps[COLOURS](np.linspace(0, 1, 64))[:, :3]
    grey = rgb @ [0.2126, 0.7152, 0.0722]
    assert np.all(np.diff(grey) > 0)
    levels = [colors.to_rgb(shade)[0] for shade in SHADES]
    assert np.all(np.diff(levels) < -0.09)


def test_where_there_is_no_equilibrium_it_is_hatched(fold):
    ax = picture(fold).axes[0]
    hatched = [p for p in ax.patches if p.get_hatch()]
    assert len(hatched) == 1
    assert "no equilibrium" in texts(ax)
    legend = {text.get_text() for text in ax.get_legend().get_texts()}
    assert legend == {"fold: the equilibrium ends"}


def test_axes_have_names_and_units():
    chart = rb.stability_chart(
        rb.load_model("racs", parameters={"u": 20}),
        "c",
        "m_c",
        ((0.02, 0.6), (5, 400)),
        quantity="damping",
        shape=(8, 6),
        settings=QUICK,
    )
    figure = picture(chart)
    ax = figure.axes[0]
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("$c$ [m]", "$m_{c}$ [kg]")
    assert (ax.get_xlim(), ax.get_ylim()) == ((0.02, 0.6), (5.0, 400.0))
    (image,) = [c for c in ax.get_children() if isinstance(c, AxesImage)]
    assert image.get_array().shape == (6, 8)
    assert "Re" in figure.axes[1].get_ylabel()


def test_slices_share_one_figure(tmp_path):
    turning = rb.model_from_strings(
        "turning", {"x": "a*x - w*y", "y": "w*x + a*y + b"}, parameters={"a": -1.0, "b": 0, "w": 1}
    )
    slices = rb.chart_slices(turning, "a", "b", BOX, ("w", (1.0, 2.0, 3.0)), settings=QUICK)
    figure = picture_slices(slices)
    panels = [ax for ax in figure.axes if ax.get_title()]
    assert [ax.get_title() for ax in panels] == ["$w$ = 1", "$w$ = 2", "$w$ = 3"]
    every = [c for ax in panels for c in ax.collections if isinstance(c, LineCollection)]
    assert len({c.get_clim() for c in every}) == 1
    save_picture(figure, tmp_path / "slices.png")
    assert (tmp_path / "slices.png").read_bytes().startswith(b"\x89PNG")


def test_axes_of_ones_own(chart):
    from matplotlib.figure import Figure

    ax = Figure().add_subplot()
    assert draw(chart, ax=ax) is ax


def of_map(chart, quantity, value, status=None):
    """Return the chart with a map of simulations as if it had been made."""
    cells = np.shape(value)
    status = np.where(np.isnan(value), 1, 0) if status is None else status
    sweep = SweepMap(
        value=np.array(value, dtype=float),
        error=np.zeros(cells),
        status=np.array(status, dtype=np.int8),
        watch="x",
        duration=10.0,
        tolerance=1e-5,
    )
    nothing = np.full(cells, np.nan)
    made = ChartMap(
        quantity=quantity,
        unstable=np.zeros(cells, dtype=np.int8),
        sigma=nothing,
        omega=nothing,
        evaluations=1,
        sweep=sweep,
    )
    return replace(chart, map=made)


def test_a_map_of_amplitudes_has_its_unit_and_shows_what_is_unknown(chart):
    value = [[0.0, 0.1, np.nan], [0.2, 0.3, 0.4]]
    figure = picture(of_map(chart, "amplitude", value))
    ax, bar = figure.axes
    (image,) = [c for c in ax.get_children() if isinstance(c, AxesImage)]
    assert image.get_array().shape == (3, 2)
    assert image.get_clim() == (0.0, 0.4)
    assert image.get_cmap().name == COLOURS
    assert bar.get_ylabel() == "amplitude of $x$"
    legend = {text.get_text() for text in ax.get_legend().get_texts()}
    assert "unknown" in legend
    hatched = [c for c in ax.collections if c.get_hatch()]
    assert [len(c.get_paths()) for c in hatched] == [1]
    # Boundaries are drawn over it.
    assert any(line.get_zorder() > image.get_zorder() for line in ax.get_lines())


def test_a_map_of_exponents_has_its_unit(chart):
    figure = picture(of_map(chart, "lyapunov", [[-0.1, 0.0], [0.0, 0.2]]))
    assert figure.axes[1].get_ylabel() == "largest Lyapunov exponent [1/s]"
    assert figure.axes[0].get_legend() is None or "unknown" not in {
        text.get_text() for text in figure.axes[0].get_legend().get_texts()
    }


@pytest.mark.parametrize(
    ("value", "ticks"),
    [
        ([[0.0, 1.0], [2.0, np.inf]], ["rest", "1", "2", "many"]),
        ([[0.0, 0.0], [0.0, np.nan]], ["rest"]),
        ([[1.0, 1.0], [2.0, 1.0]], ["rest", "1", "2"]),
    ],
)
def test_numbers_of_crossings_have_a_colour_each(chart, value, ticks):
    figure = picture(of_map(chart, "periods", value))
    figure.draw_without_rendering()
    assert [text.get_text() for text in figure.axes[1].get_yticklabels()] == ticks
    assert "repeats" in figure.axes[1].get_ylabel()


def test_nothing_known_is_drawn_all_the_same(chart):
    for quantity in ("amplitude", "periods", "lyapunov"):
        figure = picture(of_map(chart, quantity, np.full((2, 3), np.nan)))
        (hatched,) = [c for c in figure.axes[0].collections if c.get_hatch()]
        assert len(hatched.get_paths()) == 6


def test_curves_of_other_points_are_drawn_and_named(chart):
    line = np.array([[-0.5, -0.5], [0.0, 0.2], [0.4, 1.0]])
    curve = ChartCurve(kind="lpc", name="LPC1", values=line)
    other = ChartCurve(kind="curve", name="HC1", values=line[::-1] * 0.5)
    ax = picture(replace(chart, curves=(curve, other))).axes[0]
    drawn = {line.get_label(): line for line in ax.get_lines()}
    assert drawn["fold of cycles (LPC)"].get_xdata().tolist() == [-0.5, 0.0, 0.4]
    legend = {text.get_text() for text in ax.get_legend().get_texts()}
    assert {"fold of cycles (LPC)", "HC1", "subcritical"} <= legend


def stars(ax):
    return [line for line in ax.get_lines() if line.get_marker() == "*"]


def test_a_chart_beside_the_models_own_values_has_no_star(fold):
    import matplotlib.pyplot as plt

    ax = draw(fold)
    assert len(stars(ax)) == 1
    away = replace(fold, system=replace(fold.system, parameters={"a": 9.0, "b": 0.5}))
    beside = draw(away)
    assert beside is not ax
    assert not stars(beside)
    assert "nominal" not in texts(beside)
    assert "stable" in texts(beside)
    plt.close("all")


def test_slices_without_frequencies_have_a_legend_and_no_bar(fold):
    folds = tuple(b for b in fold.boundaries if b.kind == "fold")
    slices = rb.ChartSlices(parameter="b", charts=(replace(fold, boundaries=folds),))
    figure = picture_slices(slices)
    assert len(figure.axes) == 1
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["fold: the equilibrium ends"]
