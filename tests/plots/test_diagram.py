from dataclasses import replace
from itertools import combinations, pairwise

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib import colors
from matplotlib import pyplot as plt
from matplotlib.figure import Figure
from matplotlib.text import Text

from racs_bif.errors import UsageError
from racs_bif.plots.diagram import draw, picture
from racs_bif.plots.style import BLACK, BLUE, COLUMN, save_picture
from racs_bif.results.diagram import Diagram


@pytest.fixture
def ax():
    return Figure().add_subplot()


def _curves(ax, colour):
    """The lines of one colour that are curves and not markers, as (x, y, solid)."""
    lines = [line for line in ax.get_lines() if line.get_linestyle() != "None"]
    return [
        (*line.get_data(), line.get_linestyle() == "-")
        for line in lines
        if line.get_color() == colour
    ]


def test_the_equilibrium_is_solid_where_stable_and_dashed_where_not(diagram, ax):
    draw(diagram, ax=ax)
    (x1, y1, solid1), (x2, y2, solid2) = _curves(ax, BLACK)
    assert (solid1, solid2) == (True, False)
    assert (x1[0], x1[-1], x2[-1]) == (5.0, 10.0, 30.0)
    assert (x2[0], y2[0]) == (x1[-1], y1[-1])  # no gap


def test_orbits_show_their_extremes_split_at_the_special_point(diagram, ax):
    draw(diagram, ax=ax)
    pieces = _curves(ax, BLUE)
    assert [solid for _, _, solid in pieces] == [True, False, True, False]
    upper, lower = pieces[:2], pieces[2:]
    orbit = diagram["PO1"]
    for (one, two), name in ((upper, "max delta_c"), (lower, "min delta_c")):
        assert one[0][-1] == two[0][0] == 21.0
        np.testing.assert_array_equal(np.append(one[1], two[1][1:]), orbit.column(name))


def test_every_point_of_every_branch_is_drawn_once(diagram, ax):
    draw(diagram, ax=ax)
    drawn = np.concatenate(
        [x if k % 2 == 0 else x[1:] for k, (x, _, _) in enumerate(_curves(ax, BLACK))]
    )
    np.testing.assert_array_equal(drawn, diagram["EQ1"].parameter)
    for one, two in pairwise(_curves(ax, BLACK)):
        assert one[0][-1] == two[0][0]


def test_special_points_are_marked_and_named(diagram, ax):
    draw(diagram, ax=ax)
    assert {text.get_text() for text in ax.texts} == {"H1", "NS1"}
    marks = [line for line in ax.get_lines() if line.get_linestyle() == "None"]
    places = {(line.get_xdata()[0], round(line.get_ydata()[0], 6)) for line in marks}
    assert (10.0, -0.01) in places
    assert len([x for x, _ in places if x == 21.0]) == 2  # on both extremes
    assert len([x for x, _ in places if x == 12.0]) == 3  # user points, unnamed


def test_axes_have_names_units_and_a_legend(diagram, ax):
    assert draw(diagram, ax=ax) is ax
    assert ax.get_xlabel() == "$u$ [m/s]"
    assert ax.get_ylabel() == r"$\delta_{c}$ [rad]"
    words = [text.get_text() for text in ax.get_legend().get_texts()]
    assert words == [
        "equilibrium, stable",
        "equilibrium, unstable",
        "orbit, max and min, stable",
        "orbit, max and min, unstable",
    ]


def test_another_quantity_can_be_chosen(diagram):
    on_v = Figure().add_subplot()
    draw(diagram, "v", ax=on_v)
    assert on_v.get_ylabel() == "$v$ [m/s]"
    assert not _curves(on_v, BLUE)  # these orbits do not know v
    on_period = Figure().add_subplot()
    diagram.plot("period", ax=on_period)
    assert on_period.get_ylabel() == r"$\mathrm{period}$ [s]"
    assert not _curves(on_period, BLACK)
    with pytest.raises(UsageError, match="did you mean 'delta_c'"):
        draw(diagram, "delta")


def test_without_a_suggestion_the_first_state_is_shown(diagram, ax):
    branch = diagram["EQ1"]
    draw(Diagram(replace(branch, system=replace(branch.system, shown=""))), ax=ax)
    assert ax.get_ylabel() == "$v$ [m/s]"


def test_unknown_stability_is_dotted(diagram, ax):
    branch = diagram["EQ1"]
    draw(Diagram(replace(branch, unstable=np.full(len(branch), -1))), ax=ax)
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["equilibrium, unknown"]


def _parts(figure):
    """The axes, the boxes of its labels, and the box of the legend, in pixels."""
    figure.draw_without_rendering()
    (ax,) = figure.axes
    (legend,) = [*figure.legends, *([ax.get_legend()] if ax.get_legend() else [])]
    # Without the lines that lead to the points.
    texts = [Text.get_window_extent(note) for note in ax.texts]
    return ax, texts, legend.get_window_extent()


CASES = pytest.mark.parametrize(("which", "count"), [("diagram", 2), ("crowded", 5), ("steep", 6)])


@CASES
def test_labels_cover_neither_each_other_nor_the_legend_nor_the_frame(which, count, request):
    ax, boxes, legend = _parts(picture(request.getfixturevalue(which)))
    assert len(boxes) == count
    assert not any(one.overlaps(two) for one, two in combinations(boxes, 2))
    assert not any(box.overlaps(legend) for box in boxes)
    assert all(ax.bbox.x0 < box.x0 and box.x1 < ax.bbox.x1 for box in boxes)
    assert all(ax.bbox.y0 < box.y0 and box.y1 < ax.bbox.y1 for box in boxes)


@CASES
def test_labels_cover_no_special_point(which, count, request):
    ax, boxes, _ = _parts(picture(request.getfixturevalue(which)))
    points = [ax.transData.transform(note.xy) for note in ax.texts]
    assert len(points) == count
    assert not any(box.contains(*point) for box in boxes for point in points)


@CASES
def test_the_legend_covers_no_curve_and_is_on_the_page(which, count, request):
    del count
    figure = picture(request.getfixturevalue(which))
    ax, _, legend = _parts(figure)
    for line in ax.get_lines():
        pixels = line.get_transform().transform(line.get_xydata())
        assert not any(legend.contains(*pixel) for pixel in pixels)
    assert figure.bbox.x0 <= legend.x0
    assert legend.x1 <= figure.bbox.x1
    assert ax.bbox.width > 0.6 * figure.bbox.width  # the legend has not pushed the axes aside


def test_a_picture_has_the_width_of_a_column_and_300_dots_per_inch(diagram, tmp_path):
    figure = picture(diagram)
    save_picture(figure, tmp_path / "diagram.png")
    height, width = plt.imread(tmp_path / "diagram.png").shape[:2]
    assert width == int(COLUMN * 300)
    assert 0.5 * width < height < width
    assert pytest.approx(88) == COLUMN * 25.4


def test_the_same_diagram_gives_the_same_files(diagram, tmp_path):
    for name in ("a", "b"):
        save_picture(picture(diagram), tmp_path / f"{name}.svg")
        save_picture(picture(diagram), tmp_path / f"{name}.png")
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_no_setting_of_matplotlib_is_changed(diagram, tmp_path):
    before = dict(mpl.rcParams)
    save_picture(picture(diagram), tmp_path / "a.svg")
    axes = draw(diagram)
    plt.close(axes.figure)
    assert dict(mpl.rcParams) == before


def test_colours_are_distinct_in_grey():
    grey = [np.dot(colors.to_rgb(colour), [0.299, 0.587, 0.114]) for colour in (BLACK, BLUE, "w")]
    assert np.all(np.diff(grey) > 0.3)


def test_a_new_figure_is_made_where_none_is_given(diagram):
    axes = diagram.plot()
    assert axes.figure.get_size_inches()[0] == pytest.approx(COLUMN)
    plt.close(axes.figure)
