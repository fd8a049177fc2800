"""Drawings that make a figure of their own, and what they say of special cases."""

from dataclasses import replace

import control
import matplotlib.pyplot as plt
import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import UsageError
from racs_bif.fractional.roots import Roots
from racs_bif.orbits.phase_response import PhaseResponse
from racs_bif.plots import (
    bode,
    curve,
    history,
    multipliers,
    nyquist,
    orbit_multipliers,
    orbit_profiles,
    phase,
    phase_response,
    realisations,
    root_locus,
    spectrum,
    sweep,
)
from racs_bif.plots.style import COLUMN
from racs_bif.results.branch import Profile
from racs_bif.results.provenance import SystemInfo
from racs_bif.verbs.realisations import RealisationTable
from racs_bif.verbs.spectrum import Spectrum
from racs_bif.verbs.sweep import Sweep

INFO = SystemInfo(
    model="m", units={"x": "m", "y": "m", "a": "N"}, states=("x", "y"), parameters={"a": 1.0}
)
TIMES = np.linspace(0.0, 2.0, 101)


@pytest.fixture(autouse=True)
def _closed():
    yield
    plt.close("all")


@pytest.fixture
def orbit_branch(diagram):
    return diagram.branches[1]


@pytest.fixture
def motion():
    return rb.TimeHistory(
        times=TIMES,
        state_names=("x", "y"),
        states=np.column_stack([np.cos(TIMES), np.sin(TIMES)]),
        outputs={"F": TIMES},
        system=INFO,
        operator="exact",
        method="bdf2",
        history="rest",
        step=0.02,
        order=2.0,
    )


@pytest.fixture
def loop():
    omega = np.geomspace(0.1, 10.0, 40)
    return control.frd(2.0 / (1.0 + 1j * omega), omega)


@pytest.fixture
def curves(diagram):
    """Return a curve in two parameters, with a point on it and one that is not."""
    along = diagram.branches[0]
    special = (along.special[0], replace(along.special[1], label="BT", name="BT1", index=-1))
    return [
        replace(
            along,
            name="HC1",
            kind="curve",
            parameters=("u", "m"),
            values=np.column_stack([along.parameter, 2.0 * along.parameter]),
            special=special,
        )
    ]


@pytest.fixture
def swept():
    values = np.linspace(1.0, 10.0, 10)
    return Sweep(
        parameter="a",
        values=values,
        quantity="x",
        low=-values,
        high=values,
        turns=tuple(np.array([-v, v]) for v in values),
        ways=("rest", "oscillating") * 5,
        duration=30.0,
        kept=10.0,
        system=INFO,
    )


@pytest.fixture
def roots():
    found = np.array([-0.1 + 2j, -0.1 - 2j])
    exact = Roots(found, np.zeros(2), np.ones(2, int), -1.0, 0, 2, (), 0.0, np.array([-0.4]))
    return Spectrum(exact, found * 1.01, {"x": 0.0}, INFO)


@pytest.fixture
def table():
    omega = np.geomspace(0.1, 10.0, 30)
    return RealisationTable((), omega, {"fitted": np.full(30, 1e-3)}, {}, INFO)


@pytest.fixture
def advance():
    wave = np.stack((np.cos(np.pi * TIMES), np.sin(np.pi * TIMES)))
    return PhaseResponse(("x", "y"), TIMES, wave, 3.0 * wave[::-1], 2.0, 1e-9, {"x": "m", "y": "m"})


def lines_of(ax):
    return [tuple(np.asarray(row, float) for row in line.get_data()) for line in ax.get_lines()]


def holds(ax, x, y):
    """Say whether one of the lines has these points."""
    return any(
        a.shape == np.shape(x) and np.array_equal(a, x) and np.array_equal(b, y)
        for a, b in lines_of(ax)
    )


def test_curves_in_two_parameters(curves):
    ax = curve.draw(curves)
    assert holds(ax, curves[0].values[:, 0], curves[0].values[:, 1])
    assert ax.get_xlabel() == "$u$ [m/s]"
    assert ax.get_ylabel() == "$m$ [kg]"
    # A point that is not on the curve, as one taken over from elsewhere, has no mark.
    assert [text.get_text() for text in ax.texts] == ["H1"]
    assert ax.figure.get_figwidth() == pytest.approx(COLUMN)


def test_curves_of_several_planes_are_refused(curves, diagram):
    other = replace(curves[0], parameters=("u", "C_s"))
    with pytest.raises(UsageError, match="not u-C_s and u-m; draw a plane at a time"):
        curve.draw([*curves, other])
    with pytest.raises(UsageError, match="not u; draw"):
        curve.picture([diagram.branches[0]])
    with pytest.raises(UsageError, match="not none; draw"):
        curve.draw([])


def test_realisations_without_a_hopf_point(table):
    ax = realisations.draw(table)
    assert holds(ax, table.omega, table.errors["fitted"])
    assert ax.get_xscale() == ax.get_yscale() == "log"
    assert not ax.texts
    marked = realisations.draw(replace(table, hopf={"omega": 3.0}))
    assert marked is not ax
    assert [text.get_text() for text in marked.texts] == ["Hopf"]


def test_a_table_of_realisations_on_given_axes(table):
    _, ax = plt.subplots()
    assert realisations.draw(table, ax=ax) is ax
    assert len(ax.get_lines()) == 1


def test_profiles_and_multipliers_of_orbits(orbit_branch):
    ax = orbit_profiles.draw_profile(orbit_branch)
    assert ax.figure.get_figwidth() == pytest.approx(COLUMN)
    kept = orbit_branch.profiles["NS1"]
    np.testing.assert_array_equal(ax.lines[0].get_xdata(), kept.times / kept.times[-1])
    plane = orbit_profiles.draw_phase(orbit_branch)
    # No rate is kept, so the other axis is the next state.
    assert (plane.get_xlabel(), plane.get_ylabel()) == (r"$\delta_{c}$ [rad]", "$v$ [m/s]")
    assert holds(plane, kept.states[:, 1], kept.states[:, 0])


def test_the_plane_of_a_state_is_that_of_its_rate(orbit_branch):
    kept = orbit_branch.profiles["NS1"]
    rated = Profile(
        times=kept.times,
        names=("v", "delta_c", "ddelta_c"),
        states=np.column_stack([kept.states, kept.states[:, 0]]),
    )
    branch = replace(orbit_branch, profiles={"NS1": rated})
    assert orbit_profiles.plane_of(branch) == ("delta_c", "ddelta_c")
    assert orbit_profiles.plane_of(branch, "ddelta_c") == ("ddelta_c", "v")
    assert orbit_profiles.plane_of(branch, "v") == ("v", "delta_c")


def test_orbits_that_keep_no_profile_or_multiplier_say_so(orbit_branch):
    with pytest.raises(UsageError, match=r"PO1 keeps no orbit; ask for some with at="):
        orbit_profiles.draw_profile(replace(orbit_branch, profiles={}))
    nothing = replace(orbit_branch, spectrum=np.full_like(orbit_branch.spectrum, np.nan))
    with pytest.raises(UsageError, match="NS1 of PO1 has no multipliers; take a point that is"):
        orbit_multipliers.draw_circle(nothing, "NS1")
    with pytest.raises(UsageError, match="PO1 has no multipliers; take a branch of shooting"):
        orbit_multipliers.draw_multipliers(nothing)


def test_moduli_that_are_unknown_everywhere_have_no_line(orbit_branch):
    ax = orbit_multipliers.draw_multipliers(orbit_branch)
    drawn = [y for x, y in lines_of(ax) if len(x) == len(orbit_branch)]
    assert len(drawn) == 1  # of the two multipliers beside the trivial one, one is NaN
    np.testing.assert_allclose(drawn[0], np.abs(orbit_branch.spectrum[:, 1]))


def test_roots_on_the_branch_cut_have_a_mark_of_their_own(roots):
    ax = spectrum.draw(roots)
    assert holds(ax, [-0.4], [0.0])
    titles = [text.get_text() for text in ax.get_legend().get_texts()]
    assert titles == ["exact roots", "on the branch cut", "realisation"]


def test_a_phase_response_of_the_first_state(advance):
    ax = phase_response.draw(advance)
    assert holds(ax, TIMES, advance.profile[0])
    assert "$x$" in ax.get_ylabel()


def test_a_loop_that_stands_still_has_no_arrow(loop):
    ax = nyquist.draw(loop)
    assert holds(ax, loop.frdata[0, 0].real, loop.frdata[0, 0].imag)
    assert len(ax.texts) == 1
    gain = control.frd(np.full(5, 0.5 + 0j), np.geomspace(1.0, 10.0, 5))
    assert not nyquist.draw(gain).texts


def test_a_bode_diagram_on_given_axes(loop):
    _, axes = plt.subplots(2)
    assert list(bode.draw(loop, axes=list(axes))) == list(axes)
    assert holds(axes[0], loop.omega, 20.0 * np.log10(np.abs(loop.frdata[0, 0])))


def test_a_trajectory_in_a_plane(motion):
    ax = phase.draw(motion, ("x", "y"))
    assert holds(ax, np.cos(TIMES), np.sin(TIMES))
    assert len(ax.get_lines()) == 1
    late = phase.draw(motion, ("x", "y"), late=1.0)
    assert [line.get_label() for line in late.get_lines()] == ["simulated", "the same, after 1 s"]


def test_columns_of_one_unit_share_it(motion):
    assert history.draw(motion, "x", "y").get_ylabel() == "[m]"
    assert not history.draw(motion, "x", "F").get_ylabel()


def test_a_root_locus_and_multipliers(diagram):
    ax = root_locus.draw(rb.root_locus(diagram.branches[0]))
    assert ax.get_xlabel() == "Re s [1/s]"
    circle = multipliers.draw({"PO1": np.array([1.0, 0.5j, np.nan])})
    assert circle is not ax
    assert any(line.get_label() == "PO1" for line in circle.get_lines())


def test_a_sweep_without_branches(swept):
    ax = sweep.draw(swept)
    x, y = lines_of(ax)[0]
    np.testing.assert_array_equal(x, np.repeat(swept.values, 2))
    np.testing.assert_array_equal(y, np.concatenate(swept.turns))
    assert len(ax.get_lines()) == 1


def test_many_changes_of_a_sweep_are_counted(swept, diagram):
    said = sweep.describe(sweep.Case("a sweep", replace(swept, parameter="u"), diagram))
    assert "oscillating 6 to 6" in said
    assert "7 to 7" not in said
    assert said.endswith("and 4 more changes.")
