"""Branches of orbits from every kind of start, and how they end."""

from dataclasses import replace

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.continuation import StepSettings, Stopped, trace
from racs_bif.errors import ParameterError, UsageError
from racs_bif.orbits.endings import Endings
from racs_bif.orbits.methods import METHODS
from racs_bif.shelf.load import system_of
from racs_bif.verbs.orbit_ends import settle
from racs_bif.verbs.orbit_start import Beginning
from racs_bif.verbs.orbits import follow_orbits
from racs_bif.verbs.rebuild import rebuild

SPAN = (-1.0, 2.0)
W = 1.7


def joined(depth="1"):
    """Two Hopf points, at 0 and 1, joined by cycles of radius sqrt(lam (1 - lam))."""
    growth = f"(lam*(1 - lam) - {depth}*(x**2 + y**2))"
    return rb.model_from_strings(
        "joined",
        {"x": f"{growth}*x - w*y", "y": f"w*x + {growth}*y"},
        parameters={"lam": -0.5, "w": W},
        guess={"x": 0.0, "y": 0.0},
    )


@pytest.fixture(scope="module")
def model():
    return joined()


@pytest.fixture(scope="module")
def equilibria(model):
    return rb.continue_equilibria(model, "lam", SPAN)


@pytest.fixture(scope="module")
def cycles(equilibria):
    return rb.continue_orbits(
        equilibria["H1"], method="collocation", known=[equilibria], at={"lam": [0.5]}
    )


@pytest.mark.parametrize("method", list(METHODS))
def test_a_branch_that_arrives_at_another_hopf_point_says_which(equilibria, method):
    branch = rb.continue_orbits(equilibria["H1"], method=method, known=[equilibria])
    assert not branch.early
    assert "arrived at a Hopf point" in branch.stopped
    assert "It is H2, lam = 1, omega = 1.7." in branch.stopped
    assert branch.special == ()  # above all no LPC at either Hopf point
    assert branch.parameter[-1] == pytest.approx(1.0, abs=1e-10)
    assert branch.measures["max x"][-1] == pytest.approx(0.0, abs=1e-12)
    assert branch.measures["period"][-1] == pytest.approx(2 * np.pi / W)
    assert np.all(np.isfinite(branch.measures["max x"]))


def test_a_hopf_point_that_nobody_named_is_found_all_the_same(equilibria):
    branch = rb.continue_orbits(equilibria["H2"], method="collocation")
    assert "It is a Hopf point, lam = " in branch.stopped
    assert branch.parameter[-1] == pytest.approx(0.0, abs=1e-10)


def test_a_branch_that_runs_onto_a_known_one_ends_there(equilibria, cycles):
    again = rb.continue_orbits(equilibria["H2"], method="collocation", known=[equilibria, cycles])
    assert "It is PO1 from there on." in again.stopped
    assert again["EP1"].met == "PO1"
    assert len(again) < 8
    assert not again.early


def test_cycles_of_the_same_parameter_and_period_are_not_the_same(equilibria, cycles):
    other = rb.continue_equilibria(joined("1.05"), "lam", SPAN)
    branch = rb.continue_orbits(other["H1"], method="collocation", known=[other, cycles])
    assert "arrived at a Hopf point" in branch.stopped


def test_both_ends_are_told_of_a_branch_that_is_followed_both_ways(equilibria, cycles):
    branch = rb.continue_orbits(cycles["UZ1"], known=[equilibria])
    assert "At its beginning: It is H1" in branch.stopped
    assert "At its end: It is H2" in branch.stopped
    assert branch.parameter[[0, -1]] == pytest.approx([0.0, 1.0], abs=1e-10)
    assert np.all(np.diff(branch.arclength) > 0.0)
    assert not branch.early


@pytest.mark.parametrize("method", list(METHODS))
def test_a_closed_branch_of_orbits_closes(method):
    # the square of the radius runs on a circle about 2 as lam comes and goes
    growth = "(1 - lam**2 - (x**2 + y**2 - 2)**2)"
    turn = "(w + lam/3)"
    isola = rb.model_from_strings(
        "isola",
        {"x": f"{growth}*x - {turn}*y", "y": f"{turn}*x + {growth}*y"},
        parameters={"lam": 0.0, "w": W},
        guess={"x": 0.0, "y": 0.0},
    )
    system = system_of(isola)
    angle = np.linspace(0.0, 2.0 * np.pi, 101)
    ring = np.sqrt(3.0) * np.array([np.cos(angle), np.sin(angle)])
    begun = METHODS[method].from_samples(
        system.field, system.path("lam"), angle / W, ring, 0.0, settings=None
    )
    branch = follow_orbits(Beginning(system, begun, method, None, None), (-2.0, 2.0))
    assert branch.stopped.startswith(Stopped.CLOSED.value)
    assert not branch.early
    assert [point.label for point in branch.special] == ["LPC", "LPC"]
    assert sorted(point.parameters["lam"] for point in branch.special) == pytest.approx([-1, 1])
    assert branch.parameter[-1] == branch.parameter[0]
    np.testing.assert_allclose(branch.measures["max x"][[0, -1]], np.sqrt(3.0), rtol=1e-6)
    # once round, not twice: the least radius is passed once
    assert np.count_nonzero(np.diff(np.sign(np.diff(branch.measures["max x"])))) == 1


def test_an_orbit_that_falls_onto_an_equilibrium_that_is_no_hopf_point(equilibria):
    origin = equilibria["H1"].origin
    form = origin.raw.data["form"]
    path, z = origin.problem.path, origin.raw.z
    start = METHODS["collocation"].from_hopf(
        origin.system.field, path, z, form.omega, form.q, form=form, settings=None
    )
    found = trace(start.problem, start.z, SPAN, [], tangent=start.tangent, direction=1)
    assert found.stopped is Stopped.VANISHED
    middle = len(found.points) // 2  # as if Newton's method had fallen down from here
    found.points = [*found.points[:middle], found.points[-1]]
    watched = Endings(start.problem, origin.system.states, 3.0)
    ended, end = settle(found, origin.system, watched, [equilibria])
    assert ended.stopped is Stopped.COLLAPSED
    assert not ended.stopped.complete
    assert len(ended.points) == middle  # what it fell onto is not shown
    assert "The last orbit is at lam" in end.told


def test_an_orbit_with_poor_multipliers_is_neither_stable_nor_unstable(cycles):
    problem = cycles["UZ1"].origin.problem
    assert problem.stable(np.array([1.0 + 1e-9, 0.5], dtype=complex)) is True
    assert problem.stable(np.array([1.0 + 1e-9, 1.5], dtype=complex)) is False
    assert problem.stable(np.array([1.1, 0.5], dtype=complex)) is None
    assert problem.stable(np.array([0.9, np.inf], dtype=complex)) is None
    # near a fold two multipliers split by the root of the error, which is no loss
    assert problem.stable(np.array([1.01, 0.99], dtype=complex)) is True


# -------------------------------------------------------------------------------------- starts


def test_an_orbit_is_continued_in_another_parameter_and_by_another_method(cycles):
    branch = rb.continue_orbits(cycles["UZ1"], (1.0, 5.0), parameter="w", method="shooting")
    assert branch.parameters == ("w",)
    assert branch.method == "shooting"
    np.testing.assert_allclose(branch.measures["period"], 2.0 * np.pi / branch.parameter, rtol=1e-6)
    np.testing.assert_allclose(branch.measures["max x"], 0.5, rtol=1e-6)


def test_orbits_are_born_at_a_hopf_point_in_another_parameter():
    hopf = rb.all_equilibria(rb.load_model("lorenz"), "r", (0.5, 30), probes=0)["H1"]
    steps = StepSettings(points=6, maximum=0.05)
    branch = rb.continue_orbits(
        hopf, (2.0, 4.0), parameter="b", method="collocation", settings=steps
    )
    assert branch.parameters == ("b",)
    assert branch.parameter[0] == pytest.approx(8.0 / 3.0)
    assert branch.measures["max x"][-1] - branch.measures["min x"][-1] > 1.0


def test_an_orbit_is_continued_from_a_file(cycles, model, tmp_path):
    loaded = rb.load(rb.save(cycles, tmp_path / "po.nc"))
    assert loaded == cycles
    branch = rb.continue_orbits(loaded["UZ1"], (0.2, 0.8), model=model)
    assert branch.method == "collocation"
    np.testing.assert_allclose(
        branch.measures["max x"], np.sqrt(branch.parameter * (1 - branch.parameter)), rtol=1e-6
    )
    with pytest.raises(UsageError, match="made in Python"):
        rb.continue_orbits(loaded["UZ1"], (0.2, 0.8))
    with pytest.raises(UsageError, match="give the span of 'w'"):
        rb.continue_orbits(loaded["UZ1"], parameter="w", model=model)


def test_what_cannot_be_started_from_says_so(equilibria, cycles):
    with pytest.raises(UsageError, match="unknown method 'colocation'; did you mean"):
        rb.continue_orbits(equilibria["H1"], method="colocation")
    with pytest.raises(UsageError, match="shooting needs OrbitSettings"):
        rb.continue_orbits(equilibria["H1"], orbit_settings=METHODS["collocation"].settings())
    with pytest.raises(ParameterError, match="unknown parameter 'ww'"):
        rb.continue_orbits(cycles["UZ1"], (0.0, 1.0), parameter="ww")
    with pytest.raises(UsageError, match="outside the span"):
        rb.continue_orbits(cycles["UZ1"], (0.6, 0.9))
    with pytest.raises(UsageError, match="no 'perod' to want values of"):
        rb.continue_orbits(cycles["UZ1"], (0.4, 0.6), at={"perod": [1.0]})
    with pytest.raises(UsageError, match="start from a Hopf point"):
        rb.continue_orbits(rb.continue_equilibria(joined(), "lam", SPAN, at=[0.3])["UZ1"])


def test_the_vehicle_from_a_file_finds_its_memory_again(tmp_path):
    orbit = rb.find_orbit(rb.load_model("racs"), "u", 12.0)
    loaded = rb.load(rb.save(orbit, tmp_path / "orbit.nc"))
    assert loaded.profiles["UZ1"].names == ("v", "w", "delta_c", "ddelta_c")
    branch = rb.continue_orbits(loaded["UZ1"], (11.9, 12.1), at=[12.0])
    assert branch.at(u=12).period == pytest.approx(orbit["UZ1"].period, rel=1e-7)
    exact = rb.continue_orbits(loaded["UZ1"], (11.9, 12.1), method="harmonic-balance", at=[12.0])
    assert exact.at(u=12).period == pytest.approx(0.7393668, abs=1e-7)


# ------------------------------------------------------------------------------ secondary branches


def test_the_branch_that_breaks_the_symmetry_of_freires_circuit():
    equilibria = rb.continue_equilibria(rb.load_model("freire"), "nu", (-0.75, -0.5))
    branch = rb.continue_orbits(equilibria["H1"], (-0.62, -0.5), method="collocation")
    assert [p.label for p in branch.special] == ["LPC", "BPC", "EP"]
    other = rb.continue_orbits(branch["BPC1"], known=[equilibria, branch])
    assert [p.label for p in other.special] == ["NS", "PD", "EP"]
    assert other["NS1"].parameters["nu"] == pytest.approx(-0.591650195032, rel=1e-6)
    assert other["PD1"].parameters["nu"] == pytest.approx(-0.614955221138, rel=1e-6)
    with pytest.raises(UsageError, match="left by the method that found it"):
        rb.continue_orbits(branch["BPC1"], method="shooting")


def bubble():
    """A cycle of radius 1 whose neighbours are turned by half a turn: doubled between mu = 0 and 1.

    In the frame that turns with half the angle, a' = (mu (1 - mu) - a^2) a and b' = -b.
    """
    r, radius = "sqrt(x**2 + y**2)", "(sqrt(x**2 + y**2) - 1)"
    cc, ss, cs = f"(1 + x/{r})/2", f"(1 - x/{r})/2", f"(y/{r})/2"
    square = f"({radius}**2*{cc} + 2*{radius}*z*{cs} + z**2*{ss})"
    growth = f"(mu*(1 - mu) - {square})"
    a_c, b_s = f"({radius}*{cc} + z*{cs})", f"(z*{cs} - {radius}*{ss})"
    a_s, b_c = f"({radius}*{cs} + z*{ss})", f"(z*{cc} - {radius}*{cs})"
    outwards = f"({growth}*{a_c} + {b_s} - w/2*z)"
    return rb.model_from_strings(
        "bubble",
        {
            "x": f"{outwards}*x/{r} - w*y",
            "y": f"{outwards}*y/{r} + w*x",
            "z": f"{growth}*{a_s} - {b_c} + w/2*{radius}",
        },
        parameters={"mu": -0.5, "w": W},
        guess={"x": 1.0, "y": 0.0, "z": 0.0},
    )


@pytest.mark.parametrize("method", list(METHODS))
def test_a_doubled_branch_that_comes_back_says_at_which_doubling(method):
    system = system_of(bubble())
    angle = np.linspace(0.0, 2.0 * np.pi, 101)
    ring = np.array([np.cos(angle), np.sin(angle), 0.0 * angle])
    begun = METHODS[method].from_samples(
        system.field, system.path("mu"), angle / W, ring, -0.5, settings=None
    )
    branch = follow_orbits(Beginning(system, begun, method, 1, None), (-0.5, 1.5))
    assert [point.name for point in branch.special] == ["PD1", "PD2", "EP1"]
    assert branch["PD1"].parameters["mu"] == pytest.approx(0.0, abs=1e-7)
    assert branch["PD2"].parameters["mu"] == pytest.approx(1.0, abs=1e-7)
    doubled = rb.continue_orbits(branch["PD1"], (-0.5, 1.5), known=[branch])
    assert doubled.stopped.startswith(Stopped.HALVED.value)
    assert "It is PD2 of PO1, mu = " in doubled.stopped
    assert not doubled.early
    assert [point.label for point in doubled.special] == ["EP"]
    widest = np.max(doubled.measures["max z"])
    assert widest == pytest.approx(0.5, abs=0.01)
    assert np.all(doubled.measures["period"] == pytest.approx(4.0 * np.pi / W, rel=1e-6))
    again = rb.continue_orbits(branch["PD2"], (-0.5, 1.5), known=[branch, doubled])
    assert "runs onto one that is known" in again.stopped


def test_folds_and_doublings_of_the_axon_however_near():
    equilibria = rb.continue_equilibria(rb.load_model("hodgkin_huxley"), "I", (5, 12))
    branch = rb.continue_orbits(equilibria["H1"], (5, 12), method="collocation")
    doublings = [p for p in branch.special if p.label == "PD"]
    assert [round(p.parameters["I"], 4) for p in doublings] == [7.8495, 7.922]
    folds = [p.parameters["I"] for p in branch.special if p.label == "LPC"]
    assert folds == pytest.approx([7.84654712003, 7.9219855, 6.26452127451], rel=1e-6)


def test_the_homoclinic_limit_of_lorenz():
    equilibria = rb.all_equilibria(rb.load_model("lorenz"), "r", (0.5, 30), probes=0)
    branch = rb.continue_orbits(equilibria["H1"], (13, 30), method="collocation")
    assert branch.stopped.startswith(Stopped.CONNECTION.value)
    assert "homoclinic to the saddle at x = 0, y = 0, z = 0: r -> 13.9265" in branch.stopped
    assert not branch.early
    assert [point.label for point in branch.special] == ["EP"]  # no PD that overflows fake
    end = branch["EP1"]
    assert end.connection == "homoclinic"
    assert end.limit == pytest.approx(13.926557407520, abs=1e-6)
    assert abs(end.limit - 13.926557407520) < end.limit_error < 1e-6
    assert end.saddle_quantity == pytest.approx(7.12995 - 8.0 / 3.0, abs=1e-3)
    assert end.growth_ratio == pytest.approx(1.0, abs=0.01)
    np.testing.assert_allclose(end.saddles, 0.0, atol=1e-9)


def test_orbits_of_a_file_are_not_left_at_a_branch_point(cycles, model, tmp_path):
    labels = ["BPC" if label == "UZ" else label for label in cycles.labels]
    crossing = replace(cycles["UZ1"], label="BPC", name="BPC1")
    branch = replace(
        cycles,
        labels=labels,
        special=(crossing,),
        profiles={"BPC1": cycles.profiles["UZ1"]},
    )
    loaded = rb.load(rb.save(branch, tmp_path / "po.nc"))
    with pytest.raises(UsageError, match="BPC1 was loaded from a file and is a branch point"):
        rb.continue_orbits(loaded["BPC1"], (0.2, 0.8), model=model)


def test_a_branch_is_rebuilt_from_what_made_it(equilibria, cycles):
    assert rebuild(equilibria).settings == equilibria["H1"].origin.system.settings
    parted = replace(equilibria, origin=None)
    assert rebuild(parted).name == "joined"
    renamed = replace(equilibria, state_names=("x", "z"))
    with pytest.raises(UsageError, match=r"the states of EQ1 are not those of realisation 'none'"):
        rebuild(renamed)


def test_an_unknown_realisation_is_named(tmp_path):
    branch = rb.continue_equilibria(rb.load_model("racs"), "u", (5.0, 6.0))
    how = replace(branch.system.realisation, name="diffusiv")
    with pytest.raises(
        UsageError, match="unknown realisation 'diffusiv'; did you mean 'diffusive'"
    ):
        rebuild(replace(branch, origin=None, system=replace(branch.system, realisation=how)))
