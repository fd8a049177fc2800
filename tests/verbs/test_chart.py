"""The chart as a user asks for it, with what can be wrong."""

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.charts.settings import ChartSettings
from racs_bif.errors import ConvergenceError, ParameterError, UsageError
from racs_bif.results.chart_curve import ChartCurve, curve_of
from racs_bif.verbs.chart_map import SweepSettings

QUICK = ChartSettings(coarse=3, depth=4)
BOX = ((-2.0, 2.0), (-2.0, 2.1))


@pytest.fixture(scope="module")
def island():
    return rb.model_from_strings(
        "island",
        {"x": "v", "v": "-w**2*x - (a**2 + b**2 - r**2)*v"},
        parameters={"a": 0.0, "b": 0.0, "r": 1.0, "w": 1.0},
        guess={"x": 0.0, "v": 0.0},
    )


@pytest.fixture(scope="module")
def chart(island):
    return rb.stability_chart(island, "a", "b", BOX, at={"r": 1.3}, settings=QUICK)


def test_what_regions_hold(chart):
    assert {region.unstable for region in chart.regions} == {0, 2}
    assert chart.unstable_at(a=0.0, b=0.0) == 2
    assert chart.unstable_at(a=1.25, b=0.0) == 2
    assert chart.unstable_at(a=1.35, b=0.0) == 0
    assert chart.system.parameters["r"] == 1.3
    assert chart.nominal == pytest.approx([0.0, 0.0])
    assert sum(region.area for region in chart.regions) == pytest.approx(1.0)
    assert repr(chart).startswith("<stability chart of island over a, b: 1 boundaries")


def test_the_table_has_every_point(chart):
    table = chart.to_dataframe()
    assert list(table.columns) == ["boundary", "kind", "a", "b", "omega", "l1"]
    assert len(table) == len(chart.boundaries[0])
    assert np.hypot(table["a"], table["b"]).to_numpy() == pytest.approx(1.3, abs=1e-12)


def test_charts_are_saved_and_loaded_bit_for_bit(island, tmp_path):
    full = rb.stability_chart(
        island,
        "a",
        "b",
        BOX,
        marks={"a": (0.5,)},
        lyapunov=True,
        quantity="damping",
        shape=(12, 9),
        settings=QUICK,
    )
    assert full.map is not None
    assert full.map.unstable.shape == full.map.sigma.shape == (12, 9)
    again = rb.load(rb.save(full, tmp_path / "chart.nc"))
    assert again == full
    assert [p.label for p in again.boundaries[0].points] == ["UZ", "UZ"]
    counted = rb.stability_chart(
        island, "a", "b", BOX, quantity="count", shape=(3, 3), settings=QUICK
    )
    assert rb.load(rb.save(counted, tmp_path / "counted.nc")) == counted
    assert counted != full


def test_slices_are_charts_at_values_of_a_third_parameter(island, tmp_path):
    slices = rb.chart_slices(island, "a", "b", BOX, ("r", (0.5, 1.0)), settings=QUICK)
    assert slices.values == (0.5, 1.0)
    for radius, one in zip(slices.values, slices, strict=True):
        assert np.hypot(*one.boundaries[0].values.T) == pytest.approx(radius, abs=1e-12)
    assert rb.load(rb.save(slices, tmp_path / "slices.nc")) == slices


def test_a_map_in_a_folder_goes_on(island, chart, tmp_path):
    options = {"quantity": "count", "shape": (70, 70), "settings": QUICK, "at": {"r": 1.3}}
    told = []
    first = rb.stability_chart(island, "a", "b", BOX, tiles=tmp_path, **options)
    (tmp_path / "tile_000002.npz").unlink()
    again = rb.stability_chart(
        island,
        "a",
        "b",
        BOX,
        tiles=tmp_path,
        resume=True,
        progress=lambda *done: told.append(done),
        **options,
    )
    assert ("map", 3, 4) in told
    assert ("map", 1, 4) not in told
    assert again == first
    cells = (again.map.unstable == 2).mean()
    assert cells == pytest.approx(np.pi * 1.3**2 / 16.4, abs=0.01)


@pytest.mark.parametrize(
    ("names", "spans", "options", "message"),
    [
        (("a", "a"), BOX, {}, "two different parameters, not 'a' twice"),
        (("a", "b"), ((1.0, 1.0), (0.0, 1.0)), {}, "the span 1 to 1 is empty"),
        (("a", "b"), ((2.0, 1.0), (0.0, 1.0)), {}, "the span 2 to 1 is empty"),
        (("a", "b"), BOX, {"at": {"a": 1.0}}, "'a' is varied"),
        (("a", "b"), BOX, {"quantity": "colour"}, "unknown map 'colour'"),
        (("a", "b"), BOX, {"operator": "other"}, "unknown operator 'other'"),
        (
            ("a", "b"),
            BOX,
            {"quantity": "amplitude", "sweep": SweepSettings(watch="y")},
            "unknown state 'y'",
        ),
        (("a", "b"), BOX, {"marks": {"r": (1.0,)}}, "at values of a or b, not of 'r'"),
        (("a", "b"), BOX, {"marks": {"a": (3.0,)}}, "a = 3 is outside its span -2 to 2"),
    ],
)
def test_what_cannot_be_asked_for(island, names, spans, options, message):
    with pytest.raises(UsageError, match=message):
        rb.stability_chart(island, *names, spans, **options)


def test_unknown_parameters_are_named(island):
    with pytest.raises(ParameterError, match="aa"):
        rb.stability_chart(island, "aa", "b", BOX)


def test_a_plane_without_equilibria_is_told_with_what_to_do():
    nowhere = rb.model_from_strings(
        "nowhere", {"x": "1 + a**2 + b**2 + x**2"}, parameters={"a": 0.0, "b": 0.0}
    )
    with pytest.raises(ConvergenceError, match="better guess, or other spans"):
        rb.stability_chart(nowhere, "a", "b", BOX)


def test_slices_side_by_side_are_the_same(island, tmp_path):
    alone = rb.chart_slices(island, "a", "b", BOX, ("r", (0.5, 1.0)), settings=QUICK)
    told = []
    shared = rb.chart_slices(
        island,
        "a",
        "b",
        BOX,
        ("r", (0.5, 1.0)),
        settings=QUICK,
        workers=2,
        progress=lambda *done: told.append(done),
    )
    assert shared == alone
    assert told == [("slices", 1, 2), ("slices", 2, 2)]


def test_the_smallest_island_and_how_finely_was_searched(chart):
    assert chart.smallest_island == pytest.approx(2.6 / 4.0, abs=1e-3)
    assert chart.depth == 4
    (remark,) = chart.remarks
    assert "1/16 of a span" in remark
    assert "0.65 of a span" in remark


def test_a_map_by_simulation(tmp_path):
    # x**2 + y**2 goes to m = 1 - a**2 - b**2, or to zero.
    model = rb.model_from_strings(
        "normal",
        {
            "x": "(1 - a**2 - b**2)*x - y - x*(x**2 + y**2)",
            "y": "x + (1 - a**2 - b**2)*y - y*(x**2 + y**2)",
        },
        parameters={"a": 0.0, "b": 0.0},
        guess={"x": 0.0, "y": 0.0},
    )
    made = rb.stability_chart(
        model,
        "a",
        "b",
        BOX,
        quantity="amplitude",
        shape=(9, 6),
        settings=QUICK,
        sweep=SweepSettings(watch="y", start={"x": 0.5}),
    )
    sweep = made.map.sweep
    assert sweep.duration == pytest.approx(60.0 * 2.0 * np.pi, rel=1e-3)
    a = -2.0 + 4.0 * (np.arange(9) + 0.5) / 9
    b = -2.0 + 4.1 * (np.arange(6) + 0.5) / 6
    m = 1.0 - a[:, None] ** 2 - b[None, :] ** 2
    known = sweep.status == 0
    assert known.sum() >= 50
    assert np.isnan(sweep.value[~known]).all()
    truth = np.sqrt(np.maximum(m, 0.0))
    assert sweep.value[known] == pytest.approx(truth[known], abs=2e-4)
    assert sum(sweep.tally.values()) == 54
    assert np.array_equal(made.map.unstable, np.where(m > 0.0, 2, 0))
    assert rb.load(rb.save(made, tmp_path / "chart.nc")) == made


def test_a_map_by_simulation_needs_to_know_how_long():
    model = rb.model_from_strings("still", {"x": "-x + a*b"}, parameters={"a": 0.0, "b": 0.0})
    with pytest.raises(UsageError, match="give their duration"):
        rb.stability_chart(model, "a", "b", BOX, quantity="amplitude", settings=QUICK)


@pytest.fixture
def curve(island):
    """Return a curve of Hopf points in the plane of b and a, in this order."""
    eq = rb.continue_equilibria(island, "a", (0.2, 3.0))
    return rb.continue_curve(eq["H1"], ("b", "a"), ((-0.5, 0.5), (0.2, 3.0)))


def test_curves_of_other_points_are_carried_and_saved(island, curve, tmp_path):
    made = rb.stability_chart(island, "a", "b", BOX, settings=QUICK, curves=(curve,))
    (over,) = made.curves
    assert np.array_equal(over.values, curve.values[:, ::-1])
    assert rb.load(rb.save(made, tmp_path / "chart.nc")) == made
    again = rb.stability_chart(island, "a", "b", BOX, settings=QUICK, curves=made.curves)
    assert again == made
    known = curve_of(curve, ("a", "b"), {}, "lpc")
    assert (known.kind, len(known)) == ("lpc", len(curve))
    assert known == ChartCurve(
        kind="lpc", name=known.name, values=known.values, stopped=known.stopped
    )


def test_curves_that_do_not_belong(island, curve):
    with pytest.raises(UsageError, match=r"computed at r = 1, the chart at 1\.3"):
        rb.stability_chart(island, "a", "b", BOX, at={"r": 1.3}, curves=(curve,))
    with pytest.raises(UsageError, match="a curve in b and a, the chart's plane is that of a"):
        rb.stability_chart(island, "a", "r", ((0.1, 1.0), (0.1, 1.0)), curves=(curve,))
    with pytest.raises(UsageError, match="unknown kind of curve 'line'"):
        curve_of(curve, ("a", "b"), {}, "line")
    with pytest.raises(UsageError, match="leave them out of slices"):
        rb.chart_slices(island, "a", "b", BOX, ("r", (0.5, 1.0)), curves=(curve,))


@pytest.mark.parametrize(
    ("slices", "message"),
    [
        (("a", (1.0,)), "slice along another parameter"),
        (("r", ()), "values that differ"),
        (("r", (1.0, 1.0)), "values that differ"),
    ],
)
def test_slices_that_cannot_be(island, slices, message):
    with pytest.raises(UsageError, match=message):
        rb.chart_slices(island, "a", "b", BOX, slices)


@pytest.mark.parametrize(
    ("place", "message"), [({"a": 0.0}, "both parameters"), ({"a": 9.0, "b": 0.0}, "outside")]
)
def test_places_that_are_not_in_the_chart(chart, place, message):
    with pytest.raises(UsageError, match=message):
        chart.unstable_at(**place)


def test_slices_have_maps_of_their_own():
    model = rb.model_from_strings(
        "turning", {"x": "a*x - w*y", "y": "w*x + a*y + b"}, parameters={"a": -1.0, "b": 0, "w": 1}
    )
    slices = rb.chart_slices(
        model,
        "a",
        "b",
        ((-1.0, 1.0), (-1.0, 1.0)),
        ("w", (1.0, 2.0)),
        quantity="damping",
        shape=(4, 3),
        settings=ChartSettings(coarse=3, depth=3),
    )
    assert slices.values == (1.0, 2.0)
    expected = np.broadcast_to(np.linspace(-0.75, 0.75, 4)[:, None], (4, 3))
    for chart, omega in zip(slices, slices.values, strict=True):
        np.testing.assert_allclose(chart.map.sigma, expected, atol=1e-9)
        np.testing.assert_allclose(chart.map.omega, omega, rtol=1e-9)
