"""What a notebook shows of results: the numbers and units that they hold."""

import re
import runpy
from dataclasses import replace
from html import unescape
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.results.chart_map import ChartMap, SweepMap
from racs_bif.results.special import SpecialPoint


class Balance(HTMLParser):
    """Checks that what is opened is closed."""

    def __init__(self, text):
        super().__init__()
        self.open = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def shown(thing):
    text = thing._repr_html_()
    assert not Balance(text).open
    return " ".join(unescape(re.sub(r"<[^>]+>", " ", text)).split())


@pytest.fixture(scope="module")
def model():
    return rb.model_from_strings(
        "hopf",
        {"x": "m*x - w*y - x*(x**2 + y**2)", "y": "w*x + m*y - y*(x**2 + y**2)"},
        parameters={"m": -0.5, "w": 2.0},
    )


@pytest.fixture(scope="module")
def equilibria(model):
    return rb.continue_equilibria(model, "m", (-0.5, 1))


@pytest.fixture(scope="module")
def orbits(equilibria):
    return rb.continue_orbits(equilibria["H1"], at=[0.25], method="harmonic-balance")


@pytest.fixture(scope="module")
def chart(model):
    return rb.stability_chart(model, "m", "w", spans=((-1, 1), (1, 3)))


def test_a_model(model):
    text = shown(model)
    assert text.startswith("hopf Equations x' = m*x")
    assert "w 2" in text
    loaded = shown(rb.load_model("racs"))
    assert "delta_z = Z(s) (delta_c)" in loaded
    assert "u 10 m/s forward speed" in loaded
    assert "Note: " in loaded


def test_a_branch(equilibria, orbits):
    text = shown(equilibria)
    assert f"branch of equilibria, {len(equilibria)} points" in text
    assert "H1 Hopf point" in text
    assert equilibria.stopped in text
    assert "period [s] 3.14159 3.14159" in shown(orbits)
    assert "max x" in shown(orbits)


def test_a_special_point(equilibria):
    text = shown(equilibria["H1"])
    assert text.startswith("H1: Hopf point on EQ1")
    assert "omega [rad/s] 2" in text
    assert "exact" not in text
    vehicle = rb.continue_equilibria(rb.load_model("racs"), "u", (9, 11))["H1"]
    assert re.search(r"u \[m/s\] 10\.20\d+ 10\.2 ", shown(vehicle))
    assert "on the exact operator" in shown(vehicle)


def test_a_diagram(equilibria, orbits):
    text = shown(rb.Diagram(equilibria, orbits))
    assert "diagram of 2 branches" in text
    assert "PO1 UZ1 user value 0.25" in text


def test_a_chart(chart):
    text = shown(chart)
    assert "stability chart over m and w, exact operator" in text
    assert re.search(r"2 unstable 50 % ", text)


def test_a_time_history(model):
    history = rb.simulate(model, 2.0, initial={"x": 0.1})
    assert "time history to 2 s" in shown(history)
    data = history.to_xarray()
    assert data["time"].attrs["units"] == "s"
    assert np.array_equal(data["x"], history.column("x"))


def test_a_branch_as_a_data_set(orbits):
    data = orbits.to_xarray()
    assert data["max x"].dims == ("point",)
    assert np.array_equal(data["spectrum"], orbits.spectrum, equal_nan=True)
    assert data["period"].attrs["units"] == "s"
    where = data["label"].values == "UZ"
    assert float(data["max x"].values[where][0]) == pytest.approx(0.5, rel=1e-8)
    assert data.attrs["kind"] == "orbit"


def test_a_diagram_as_a_table(equilibria, orbits):
    diagram = rb.Diagram(equilibria, orbits)
    table = diagram.to_dataframe()
    assert len(table) == len(equilibria) + len(orbits)
    assert list(table["branch"].unique()) == ["EQ1", "PO1"]
    special = diagram.special_table()
    assert list(special["name"]) == [point.name for point in diagram.special_points]


def test_a_chart_as_a_data_set(chart, model):
    data = chart.to_xarray((8, 4))
    assert data["unstable"].shape == (8, 4)
    assert data.sel(m=0.3, w=1.2, method="nearest")["unstable"] == 2
    assert data.sel(m=-0.3, w=1.2, method="nearest")["unstable"] == 0
    mapped = rb.stability_chart(
        model, "m", "w", spans=((-1, 1), (1, 3)), quantity="damping", shape=(6, 5)
    ).to_xarray()
    expected = np.broadcast_to(mapped["m"].values[:, None], (6, 5))
    assert mapped["sigma"].values == pytest.approx(expected)
    assert mapped["sigma"].attrs["units"] == "1/s"


def test_slices_as_a_data_set():
    model = rb.model_from_strings(
        "three", {"x": "v", "v": "-x - (a + b + c)*v"}, parameters={"a": 0.0, "b": 0.0, "c": 0.0}
    )
    slices = rb.chart_slices(model, "a", "b", ((-2, 2), (-2, 2)), ("c", [-1.0, 1.0]))
    data = slices.to_xarray((9, 9))
    assert data["unstable"].dims == ("a", "b", "c")
    total = data["a"] + data["b"] + data["c"]
    assert bool((data["unstable"] == 2 * (total < 0)).where(abs(total) > 1e-9, other=True).all())
    assert set(slices.to_dataframe()["c"]) == {-1.0, 1.0}


def test_roots_and_loci_as_tables(model, equilibria):
    locus = rb.root_locus(equilibria)
    table = locus.to_dataframe()
    assert table.index.name == "m"
    assert np.array_equal(table.to_numpy(), locus.eigenvalues)
    roots = rb.spectrum(model).to_dataframe()
    assert roots["real"].to_numpy() == pytest.approx([-0.5, -0.5])
    assert sorted(roots["imag"]) == pytest.approx([-2.0, 2.0])


def test_a_batch_as_a_data_set(model):
    batch = rb.simulate_batch(model, 1.0, values={"m": [-1.0, -0.5]}, initial={"x": 0.1})
    data = batch.to_xarray()
    assert data["x"].dims == ("member", "time")
    assert np.array_equal(data["x"], batch.column("x"))
    assert list(data["m"].values) == [-1.0, -0.5]


def test_a_phase_response_as_a_table(equilibria):
    point = rb.continue_orbits(equilibria["H1"], at=[0.25])["UZ1"]
    response = rb.phase_response(point, samples=51)
    table = response.to_dataframe()
    assert list(table) == ["advance by x", "advance by y", "x", "y"]
    assert np.array_equal(table["advance by y"], response.profile[1])
    assert table.index[-1] == response.period


def test_a_cascade_as_a_table(equilibria):
    doublings = [
        SpecialPoint(
            label="PD", name="PD1", branch=f"PO{k}", parameters={"m": m}, data={"period": 2.0**k}
        )
        for k, m in enumerate((0.0, 4.0, 5.0))
    ]
    table = rb.Cascade((equilibria,), tuple(doublings), "Deep enough.").to_dataframe()
    assert list(table["m"]) == [0.0, 4.0, 5.0]
    assert list(table["period"]) == [1.0, 2.0, 4.0]
    assert table["ratio"].iloc[2] == 4.0
    assert bool(table["ratio"].iloc[:2].isna().all())


def test_pictures_of_results_are_drawn_on_axes_that_are_given(model, equilibria):
    from matplotlib import pyplot as plt

    ax = plt.subplots()[1]
    curve = rb.continue_curve(equilibria["H1"], ("m", "w"), ((-1, 1), (1, 3)))
    for draw in (equilibria.plot, curve.plot, rb.root_locus(equilibria).plot):
        assert draw(ax=ax) is ax
    assert rb.spectrum(model).plot(ax=ax) is ax
    assert equilibria.plot("y").get_ylabel() == "$y$"
    plt.close("all")


def known(name):
    path = Path(__file__).with_name("conftest.py")
    return runpy.run_path(str(path))[name]()


def test_a_realised_variant_is_told():
    text = shown(known("equilibria"))
    assert "Hopf's normal form, déplacé, variant paper" in text
    assert "realised by oustaloup with 1 states (error 0.01)" in text


def test_a_special_point_that_does_not_know_its_system_has_no_units():
    branch = known("equilibria")
    text = shown(branch["H1"])
    assert re.search(r"\bu 10 10\.001\b", text)
    assert "[m/s]" not in text
    assert "eigenvector 1+0j, -0-1j, nan+0j" in text
    large = replace(branch["H1"], data={"wave": np.zeros(400), "flags": np.array([True])})
    assert "wave array (400,)" in shown(large)
    assert "flags array (1,)" in shown(large)


def test_a_curve_has_no_count_of_unstable_roots():
    branch = known("equilibria")
    assert "unstable" in shown(branch)
    values = np.column_stack([branch.parameter, branch.parameter])
    curve = replace(branch, kind="curve", parameters=("u", "m"), values=values)
    assert "unstable" not in shown(curve)
    assert "greatest" in shown(curve)


def test_a_branch_without_a_spectrum_as_a_data_set():
    branch = known("orbits")
    data = replace(branch, spectrum=np.empty((len(branch), 0), dtype=complex)).to_xarray()
    assert "spectrum" not in data
    assert np.array_equal(data["period"], branch.measures["period"])


def test_a_map_of_simulations_as_a_data_set(chart):
    value = np.array([[0.0, 0.5], [np.nan, 0.25]])
    status = np.array([[0, 0], [1, 0]], dtype=np.int8)
    sweep = SweepMap(
        value=value, error=0.1 * value, status=status, watch="x", duration=10.0, tolerance=1e-5
    )
    nothing = np.full((2, 2), np.nan)
    made = ChartMap(
        quantity="amplitude",
        unstable=np.zeros((2, 2), dtype=np.int8),
        sigma=nothing,
        omega=nothing,
        evaluations=1,
        sweep=sweep,
    )
    data = replace(chart, map=made).to_xarray()
    np.testing.assert_array_equal(data["amplitude"], value)
    np.testing.assert_array_equal(data["error"], 0.1 * value)
    np.testing.assert_array_equal(data["status"], status)
    assert "sigma" not in data
