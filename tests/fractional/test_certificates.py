"""Interval proofs, exact folds and counts, on the vehicle and on models known in closed form."""

import math
import sys

import numpy as np
import pytest
import sympy as sp
from flint import acb, arb, ctx

from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.fractional.certificates import (
    Place,
    at_fold,
    beside,
    changes,
    exact_count,
    near,
    resolve,
)
from racs_bif.fractional.diffusive import Diffusive
from racs_bif.fractional.enclosed import EnclosedModel, EnclosedSum, _Term
from racs_bif.fractional.exact_fold import _magnitudes, solve_fold
from racs_bif.fractional.exact_hopf import solve_hopf
from racs_bif.fractional.intervals import BALLS, Ball, BallFunctions, UnboundedError, finite
from racs_bif.fractional.krawczyk import Box, NoneThereError, _above
from racs_bif.fractional.proofs import _Fold, _Hopf, prove_fold, prove_hopf
from racs_bif.fractional.system import System
from racs_bif.symbolic.compiled import compile_model
from racs_bif.symbolic.model import DerivedParameter, Model, Parameter

U_H, OMEGA_H = 10.2, 9.5200832  # model.md, section 4


@pytest.fixture(scope="module")
def hopf(vehicle):
    path = vehicle.path("u")
    p = path.vector(U_H)
    X = vehicle.exact_point(vehicle.equilibrium(p), p)
    return solve_hopf(vehicle.exact, path, X, U_H, OMEGA_H)


@pytest.fixture(scope="module")
def brusselator(system_of):
    """D^q x = A - (B+1) x + x^2 y, D^q y = B x - x^2 y: the integrals of order q are elements."""
    elements = [("x", "A-(B+1)*x+x**2*y", "s**(-q)"), ("y", "B*x-x**2*y", "s**(-q)")]
    numbers = {"A": 1.0, "B": 2.0, "q": 0.9}
    return system_of({}, elements=elements, parameters=numbers, guess={"x": 1.0, "y": 2.0})


@pytest.fixture(scope="module")
def parabola(system_of):
    """x' = mu - 1 - (x - 2)^2: a fold at mu = 1, x = 2."""
    return system_of({"x": "mu-1-(x-2)**2"}, parameters={"mu": 2.0}, guess={"x": 3.0})


@pytest.fixture(scope="module")
def gained(system_of):
    """Two elements whose static gains are set by parameters, which the equations have too."""
    return system_of(
        {"x": "b - w - v", "y": "x - v"},
        elements=[("w", "b*x**2", "n*d + s**q"), ("v", "y", "(b + s**q)/(d*b + s**(q/2))")],
        parameters={"b": 3.0, "n": 2.0, "d": 5.0, "q": 0.6},
        guess={"x": 0.2, "y": 0.5},
    )


# ------------------------------------------------------------------------------------- proofs


def test_the_papers_hopf_point_is_proved(vehicle, hopf):
    box = prove_hopf(vehicle.exact, vehicle.path("u"), hopf.X, hopf.value, hopf.omega)
    assert box.contains("u", U_H)
    assert box.contains("omega", OMEGA_H)
    k, j = box.names.index("u"), box.names.index("omega")
    # Uniqueness in a box that people care for, existence between neighbouring doubles or so.
    assert box.radii[k] > 5e-3
    assert box.radii[j] > 5e-3
    assert box.width("u") < 1e-13
    assert box.width("omega") < 1e-13
    assert box.lower[k] <= hopf.value + 1e-12
    assert hopf.value - 1e-12 <= box.upper[k]
    # The stiffness of model.md has eight digits.
    assert abs(box.lower[k] - U_H) < 1e-6
    assert abs(box.lower[j] - OMEGA_H) < 1e-6
    assert np.all(box.centre - box.radii < box.lower)
    assert np.all(box.upper < box.centre + box.radii)


@pytest.mark.parametrize(("u", "omega"), [(10.3, 9.52), (10.2, 9.6), (12.0, 8.9)])
def test_a_wrong_point_is_proved_to_be_none(vehicle, hopf, u, omega):
    with pytest.raises(NoneThereError, match="proved that no Hopf point lies in the box"):
        prove_hopf(vehicle.exact, vehicle.path("u"), hopf.X, u, omega)


def test_a_point_a_little_off_is_proved_all_the_same(vehicle, hopf):
    box = prove_hopf(vehicle.exact, vehicle.path("u"), hopf.X, hopf.value + 1e-4, hopf.omega)
    k = box.names.index("u")
    assert box.lower[k] - 1e-12 <= hopf.value <= box.upper[k] + 1e-12


@pytest.mark.parametrize(("q", "B", "omega"), [(0.9, 2.3128689301, 1.0), (0.8, None, 1.0)])
def test_the_fractional_brusselator_is_proved_where_theory_has_it(brusselator, q, B, omega):
    """B_H = 1 + A^2 + 2 A cos(q pi / 2), omega = A^(1/q); acceptance.md."""
    exact = 2.0 + 2.0 * math.cos(0.5 * q * math.pi)
    assert B is None or exact == pytest.approx(B, abs=1e-10)
    system = brusselator.with_parameters({"q": q})
    box = prove_hopf(system.exact, system.path("B"), np.array([1.0, exact]), exact, omega)
    k = box.names.index("B")
    assert box.lower[k] - 1e-15 <= exact <= box.upper[k] + 1e-15
    assert box.width("B") < 1e-12


def test_an_order_may_be_the_active_parameter(brusselator):
    system = brusselator.with_parameters({"B": 2.5})
    order = 2.0 / math.pi * math.acos(0.25)
    box = prove_hopf(system.exact, system.path("q"), np.array([1.0, 2.5]), order, 1.0)
    k = box.names.index("q")
    assert box.lower[k] - 1e-15 <= order <= box.upper[k] + 1e-15


def test_an_integer_order_model_is_proved(system_of):
    equations = {"x": "A-(B+1)*x+x**2*y", "y": "B*x-x**2*y"}
    system = system_of(equations, parameters={"A": 1.0, "B": 1.5}, guess={"x": 1.0, "y": 1.5})
    X = np.array([1.0, 2.0])
    box = prove_hopf(system.exact, system.path("B"), X, 2.0, 1.0)
    np.testing.assert_allclose(box.lower, [1.0, 2.0, 2.0, 1.0], atol=1e-14)
    np.testing.assert_allclose(box.upper, [1.0, 2.0, 2.0, 1.0], atol=1e-14)


def test_folds_are_solved_and_proved(parabola):
    path = parabola.path("mu")
    fold = solve_fold(parabola.exact, path, np.array([2.2]), 1.1)
    assert (fold.value, fold.X[0]) == pytest.approx((1.0, 2.0), abs=1e-13)
    box = prove_fold(parabola.exact, path, fold.X, fold.value)
    assert box.names == ("x", "mu")
    assert box.contains("mu", 1.0)
    assert np.all(box.lower <= [2.0, 1.0])
    assert np.all(box.upper >= [2.0, 1.0])
    with pytest.raises(NoneThereError, match="no fold"):
        prove_fold(parabola.exact, path, np.array([2.3]), 1.3)


def test_a_fold_where_the_parameter_is_zero_is_proved(system_of):
    system = system_of({"x": "mu-(x-2)**2"}, parameters={"mu": 1.0}, guess={"x": 3.0})
    box = prove_fold(system.exact, system.path("mu"), np.array([2.0]), 0.0)
    assert box.lower[1] <= 0.0 <= box.upper[1]
    assert 0.0 < box.radii[1] < 0.01


def test_a_degenerate_point_is_not_proved(system_of):
    """x' = mu - (x - 1)^3 has no fold at mu = 0, although the Jacobian vanishes."""
    system = system_of({"x": "mu-(x-1)**3"}, parameters={"mu": 1.0}, guess={"x": 2.0})
    with pytest.raises(ConvergenceError, match=r"no proof of a fold|no box around the fold"):
        prove_fold(system.exact, system.path("mu"), np.array([1.0]), 0.0)
    with pytest.raises(ConvergenceError, match="no exact fold found near mu = 1"):
        solve_fold(system.exact, system.path("mu"), np.array([1.9]), 1.0)


def slopes_agree(equations, differences):
    """Compare the derivatives of the equations of a proof with differences."""
    centre = equations.centre

    def values(z):
        return np.array([float(x) for x in equations.values([arb(v) for v in z.tolist()])])

    slopes = equations.slopes([arb(v) for v in centre.tolist()])
    for k in range(len(centre)):
        unit = np.eye(len(centre))[k]

        def along(t, unit=unit):
            return values(centre + t * unit)

        column = np.array([float(row[k].mid()) for row in slopes])
        expected = differences(along, 0.0, 1e-3 * equations.scales[k])
        allowed = 1e-7 * np.abs(column).max() + 1e-11
        np.testing.assert_allclose(column, expected, rtol=1e-6, atol=allowed)


@pytest.mark.parametrize("parameter", ["u", "C_s", "alpha", "gamma", "tau_eps", "m_c"])
@pytest.mark.parametrize("kind", ["hopf", "fold"])
def test_slopes_agree_with_differences(vehicle, hopf, differences, parameter, kind):
    value = 1.01 * vehicle.with_parameters({"u": U_H}).parameters[parameter]
    path = vehicle.with_parameters({"u": U_H}).path(parameter)
    if kind == "hopf":
        equations = _Hopf(vehicle.exact, path, hopf.X, value, 1.01 * hopf.omega)
    else:
        equations = _Fold(vehicle.exact, path, hopf.X, value)
    slopes_agree(equations, differences)


@pytest.mark.parametrize("name", ["b", "n", "d", "q"])
def test_slopes_where_gains_are_parameters(gained, differences, name):
    X, path, value = np.array([0.7, 1.3, -0.4, 0.9]), gained.path(name), gained.parameters[name]
    slopes_agree(_Fold(gained.exact, path, X, value), differences)
    slopes_agree(_Hopf(gained.exact, path, X, value, 1.3), differences)


@pytest.mark.parametrize("name", ["b", "q", "r"])
def test_slopes_where_the_least_order_of_a_law_is_a_parameter(system_of, differences, name):
    law = "(s**r + s**q)/(b*s**r + s**2)"
    numbers = {"b": 3.0, "q": 0.6, "r": 0.4}
    system = system_of({"x": "b - w"}, elements=[("w", "b*x**2", law)], parameters=numbers)
    equations = _Hopf(system.exact, system.path(name), np.array([0.7, -0.4]), numbers[name], 1.3)
    slopes_agree(equations, differences)


def test_the_precision_is_put_back(vehicle, hopf):
    before = ctx.prec
    prove_hopf(vehicle.exact, vehicle.path("u"), hopf.X, hopf.value, hopf.omega)
    assert ctx.prec == before


def test_without_python_flint_the_extra_is_named(vehicle, hopf, monkeypatch):
    monkeypatch.setitem(sys.modules, "flint", None)
    with pytest.raises(UsageError, match=r"pip install 'racs-bif\[proof\]'"):
        prove_hopf(vehicle.exact, vehicle.path("u"), hopf.X, hopf.value, hopf.omega)


# ---------------------------------------------------------------------------------- intervals


def inside(ball, value):
    """Say whether a ball holds a double up to the rounding of computing it in doubles."""
    room = arb(0, 1e-12 * (abs(value) + 1e-3))
    if isinstance(value, complex):
        ball = acb(ball)
        return (ball.real + room).contains(value.real) and (ball.imag + room).contains(value.imag)
    return (arb(ball) + room).contains(value)


@pytest.mark.parametrize("size", [0.0, 1e-6, 1e-3, 1e-2])
def test_enclosures_hold_every_value_in_the_box(vehicle, hopf, size):
    compiled, rng = vehicle.compiled, np.random.default_rng(7)
    functions = BallFunctions(compiled.sources.main, compiled.sources.forms)
    p = compiled.padded(vehicle.path("u").vector(U_H))
    dp = compiled.padded(vehicle.path("u").direction(U_H))
    v = hopf.q
    centres = {"p": p, "x": hopf.X}
    radii = {key: size * np.abs(c) for key, c in centres.items()}
    box = {
        key: [arb(c, r) for c, r in zip(centres[key].tolist(), radii[key].tolist(), strict=True)]
        for key in centres
    }
    direction, ddp = [acb(x) for x in v.tolist()], [arb(x) for x in dp.tolist()]
    balls = {
        "core": functions("core", box["p"], box["x"]),
        "jacobian_varying": functions("jacobian_varying", box["p"], box["x"]),
        "core_p": functions("core_p", box["p"], box["x"], ddp),
        "core_xx": functions("core_xx", box["p"], box["x"], direction, direction),
        "core_xp": functions("core_xp", box["p"], box["x"], direction, ddp),
        "laws": functions("laws", box["p"]),
    }
    more = {"core_p": (dp,), "core_xx": (v, v), "core_xp": (v, dp)}
    for _ in range(20):
        q = centres["p"] + rng.uniform(-1, 1, len(p)) * radii["p"]
        x = centres["x"] + rng.uniform(-1, 1, len(hopf.X)) * radii["x"]
        for name, found in balls.items():
            groups = () if name == "laws" else (x, *more.get(name, ()))
            values = compiled.kernel(name)(q, *groups)
            assert all(inside(b, y) for b, y in zip(found, values.tolist(), strict=True)), name


def test_enclosures_at_a_point_are_narrow(vehicle, hopf):
    point = EnclosedModel(vehicle.exact, vehicle.path("u")).at(
        [arb(x) for x in hopf.X.tolist()], arb(hopf.value)
    )
    found = point.equilibrium()
    assert max(float(ball.rad()) for ball in found) < 1e-11
    assert all(abs(float(ball.mid())) < 1e-9 for ball in found)


def test_a_derived_parameter_moves_what_it_sets(vehicle, hopf):
    path = vehicle.path("C_s")
    value = vehicle.parameters["C_s"]
    point = EnclosedModel(vehicle.exact, path).at([arb(x) for x in hopf.X.tolist()], arb(value))
    vector, direction = path.vector(value), path.direction(value)
    assert all(inside(b, x) for b, x in zip(point.p, vector.tolist(), strict=False))
    assert all(inside(b, x) for b, x in zip(point.dp, direction.tolist(), strict=False))


def test_gains_that_are_parameters_move_the_enclosed_equilibrium(gained):
    """Balls and doubles have the same derivatives by every parameter."""
    exact, p, X = gained.exact, gained.values, np.array([0.7, 1.3, -0.4, 0.9])
    for name in ("b", "n", "d", "q"):
        path = gained.path(name)
        value = gained.parameters[name]
        point = EnclosedModel(exact, path).at([arb(x) for x in X.tolist()], arb(value))
        expected = exact.residual_p(X, p, path.direction(value))
        found = [float(ball.mid()) for ball in point.equilibrium_p()]
        np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-14)


def test_what_is_undecided_is_an_error():
    wide, right = Ball(arb(0, 1)), Ball(arb(3))
    assert wide < right
    assert right >= 3.0
    assert right == 3.0
    assert wide != right
    assert right > wide
    assert not right > 3.0
    assert BALLS.both(wide < right, right > wide)
    assert not BALLS.both(wide < right, wide > right)
    assert BALLS.either(wide > right, wide < right)
    assert not BALLS.either(wide > right, right < wide)
    assert BALLS.negated(wide > right)
    assert not BALLS.negated(wide < right)
    for undecided in (
        lambda: wide < 0.5,
        lambda: wide >= 0.5,
        lambda: wide > 0.5,
        lambda: wide == wide + 0.0,
    ):
        with pytest.raises(UnboundedError, match="in one part of the box only"):
            undecided()
    with pytest.raises(UnboundedError):
        BALLS.sign(wide)
    assert BALLS.sign(Ball(arb(-2))) == -1.0
    assert BALLS.sign(Ball(arb(2))) == 1.0
    assert BALLS.sign(Ball(arb(0))) == 0.0
    assert BALLS.sign(Ball(arb(0.5))) == -BALLS.sign(Ball(arb(-0.5))) == 1.0
    assert BALLS.where(True, right, wide) is right
    assert BALLS.absorb(Ball(arb(1)) / 0.0, 0.0) == 0.0


def test_sums_of_powers_are_enclosed():
    def term(c, e, radius=0.0):
        return _Term(arb(c), arb(e, radius), arb(0), arb(0))

    s, log_s = 1.3j, acb(arb(1.3).log(), arb.pi() / 2)
    total = EnclosedSum((term(2, 0), term(3, 1), term(5, 0.5)))
    assert inside(total(log_s), 2.0 + 3.0 * s + 5.0 * s**0.5)
    assert inside(total.slope(log_s), 3.0 + 2.5 * s**-0.5)
    assert total.at_zero == 2
    with pytest.raises(UnboundedError, match="an order of a law passes zero in the box"):
        _ = EnclosedSum((term(2, 0, 0.1),)).at_zero


def test_constants_that_were_rounded_are_balls():
    one = Ball(arb(1))
    assert (one * 0.5).ball.is_exact()
    tenth = (one * 0.1).ball
    assert tenth.contains(arb(1) / 10)
    assert tenth.rad() < 1e-15
    assert not tenth.is_exact()


def test_equations_with_a_kink_in_the_box_are_refused(system_of):
    """x' = y, y' = -x + mu y - |x| / 2: what might be a Hopf point lies on the kink."""
    equations = {"x": "y", "y": "-x+mu*y-abs(x)/2"}
    system = system_of(equations, parameters={"mu": 0.1}, guess={"x": 0.0, "y": 0.0})
    with pytest.raises(ConvergenceError, match="in one part of the box only"):
        prove_hopf(system.exact, system.path("mu"), np.zeros(2), 0.0, 1.0)


# ------------------------------------------------------------------ solving again and counting


def test_a_point_is_solved_again_and_its_shift_told(vehicle, hopf):
    place = Place(X=hopf.X, value=hopf.value * 1.001)
    found = resolve(vehicle.exact, vehicle.path("u"), place, hopf.omega)
    assert found.value == pytest.approx(hopf.value, rel=1e-12)
    assert found.shift == pytest.approx(1e-3, rel=1e-3)
    assert found.correction < 1e-10
    with pytest.raises(ConvergenceError, match=r"is elsewhere, at u = 10\.2\d*, omega = 9\.52"):
        resolve(vehicle.exact, vehicle.path("u"), place, hopf.omega, tolerance=1e-4)


def test_the_shift_of_the_frequency_is_relative_to_it(vehicle, hopf):
    place = Place(X=hopf.X, value=hopf.value)
    found = resolve(vehicle.exact, vehicle.path("u"), place, 1.002 * hopf.omega)
    assert found.omega == pytest.approx(hopf.omega, rel=1e-12)
    assert found.shift == pytest.approx(2e-3, rel=1e-3)


def test_the_shift_of_a_state_is_relative_to_its_size(parabola):
    place = Place(X=np.array([2.01]), value=1.0)
    found = resolve(parabola.exact, parabola.path("mu"), place)
    assert pytest.approx([2.0]) == found.X
    assert found.shift == pytest.approx(0.01 / 2.01, rel=1e-6)
    assert found.omega == 0.0


@pytest.mark.parametrize(
    ("value", "options", "size"),
    [(0.02, {}, 0.02), (0.02, {"width": 1.0}, 0.1), (0.0, {}, 1e-3)],
    ids=["itself", "width of the branch", "zero"],
)
def test_the_shift_of_the_parameter_is_relative_to_its_size(system_of, value, options, size):
    system = system_of({"x": "mu-m-(x-2)**2"}, parameters={"mu": 1.0, "m": value}, guess={"x": 3.0})
    path, X = system.path("mu"), np.array([2.0])
    found = resolve(system.exact, path, Place(X=X, value=value + 5e-3 * size), **options)
    assert found.shift == pytest.approx(5e-3, rel=1e-6)
    with pytest.raises(ConvergenceError, match=r"relative shift 2\.0e-02, accepted 0\.01"):
        resolve(system.exact, path, Place(X=X, value=value + 0.02 * size), **options)


def test_states_are_near_by_their_size():
    one = np.array([1.0, -2.0])
    for scale in (1e-3, 1.0, 1e3):
        assert near(scale * one, scale * (one + 0.09))
        assert not near(scale * one, scale * (one + 0.12))
    assert near(np.zeros(2), np.full(2, 4e-8))
    assert not near(np.zeros(2), np.full(2, 6e-8))


def test_counts_on_both_sides_of_a_fold(parabola):
    path, exact = parabola.path("mu"), parabola.exact
    fold = Place(X=np.array([2.0]), value=1.0)
    upper, lower = (Place(X=np.array([x]), value=2.0) for x in (3.0, 1.0))
    above, below = (beside(exact, path, fold, end) for end in (upper, lower))
    assert above.X[0] > 2.0 > below.X[0]
    for place, unstable in ((above, 0), (below, 1), (upper, 0), (lower, 1)):
        assert place.value == pytest.approx(1.0 + (place.X[0] - 2.0) ** 2, abs=1e-10)
        assert exact_count(exact, path, place).unstable == unstable


def test_beside_a_fold_of_two_states(system_of):
    equations = {"x": "mu-1-(x-2)**2", "y": "x+3-y"}
    system = system_of(equations, parameters={"mu": 2.0}, guess={"x": 3.0, "y": 6.0})
    path, exact = system.path("mu"), system.exact
    fold = Place(X=np.array([2.0, 5.0]), value=1.0)
    for end in (np.array([3.0, 6.0]), np.array([1.0, 4.0])):
        place = beside(exact, path, fold, Place(X=end, value=2.0))
        assert place.value == pytest.approx(1.0 + (place.X[0] - 2.0) ** 2, abs=1e-10)
        assert place.X[1] == pytest.approx(place.X[0] + 3.0, abs=1e-10)
        assert (place.X[0] - 2.0) * (end[0] - 2.0) > 0.0


@pytest.mark.parametrize(("a", "b"), [(1e3, 1.0), (1e6, 1e6), (1e-3, 1e-3)])
def test_a_place_beside_a_fold_knows_no_units(system_of, a, b):
    """The parabola in units a of the state and b of the parameter."""

    def place(a, b, x):
        numbers = {"mu": 2.0 * b, "a": a, "b": b}
        system = system_of({"x": "mu/b-1-(x/a-2)**2"}, parameters=numbers, guess={"x": 3.0 * a})
        fold, end = (Place(X=np.array([y * a]), value=m * b) for y, m in ((2.0, 1.0), (x, 2.0)))
        found = beside(system.exact, system.path("mu"), fold, end)
        return found.X[0] / a, found.value / b

    for x in (3.0, 1.0):
        assert place(a, b, x) == pytest.approx(place(1.0, 1.0, x), rel=1e-7)


def test_a_state_that_is_zero_but_for_rounding_does_not_count_beside_a_fold(system_of):
    equations = {"x": "mu-1-(x/1e4-2)**2", "y": "-y"}
    system = system_of(equations, parameters={"mu": 2.0}, guess={"x": 3e4, "y": 0.0})
    fold = Place(X=np.array([2e4, 1e-10]), value=1.0)
    place = beside(system.exact, system.path("mu"), fold, Place(X=np.array([3e4, 0.0]), value=2.0))
    assert 2e4 < place.X[0] < 3e4
    assert place.value == pytest.approx(1.0 + (place.X[0] / 1e4 - 2.0) ** 2, abs=1e-10)


def test_beside_a_fold_along_a_derived_parameter():
    x, y, m = sp.symbols("x y m")
    model = Model(
        "derived",
        {"x": m - 1 - (x - 2) ** 2, "y": x + 300 - y},
        (Parameter("m", 4.0, valid=(0.0, math.inf)),),
        derived=(DerivedParameter("k", sp.sqrt(m), sets="m", valid=(0.0, math.inf)),),
        guess={"x": 3.0, "y": 303.0},
    )
    system = System(compile_model(model), np.array([4.0]), Diffusive(band=(0.1, 100.0)))
    fold, end = Place(X=np.array([2.0, 302.0]), value=1.0), Place(X=np.array([3.0, 303.0]), value=2)
    place = beside(system.exact, system.path("k"), fold, end)
    assert place.value**2 == pytest.approx(1.0 + (place.X[0] - 2.0) ** 2, abs=1e-10)
    assert 2.0 < place.X[0] < 3.0


def test_how_far_an_equilibrium_beside_a_fold_may_be_off(system_of):
    """By what a realisation is off by, or by the chord; the states are those of mu = 1 + x^2."""
    equations = {"x": "mu-1-x**2", "y": "x+5-y"}
    system = system_of(equations, parameters={"mu": 2.0}, guess={"x": 1.0, "y": 6.0})

    def found(start, end):
        places = (Place(X=np.array(z[:2]), value=z[2]) for z in (start, end))
        return beside(system.exact, system.path("mu"), *places)

    with pytest.raises(ConvergenceError, match=r"its states differ by 7\.\de\+00"):
        found((0.5, 12.6, 1.25), (0.6, 12.7, 1.36))
    near_by = found((0.5, 5.6, 1.25), (0.54, 5.64, 1.2916))
    assert near_by.X[1] == pytest.approx(near_by.X[0] + 5.0)
    within_the_chord = found((0.5, 4.5, 1.25), (0.54, 6.5, 1.2916))
    assert within_the_chord.X[1] == pytest.approx(within_the_chord.X[0] + 5.0)


def test_a_singular_matrix_beside_a_fold_is_no_convergence(system_of):
    """Nothing depends on y."""
    equations = {"x": "mu-1-(x-2)**2", "y": "mu-x"}
    system = system_of(equations, parameters={"mu": 2.0}, guess={"x": 3.0, "y": 1.0})
    start, end = (Place(X=np.array([x, 1.0]), value=2.0) for x in (3.0, 3.1))
    with pytest.raises(ConvergenceError, match="no exact equilibrium found beside mu = 2"):
        beside(system.exact, system.path("mu"), start, end)


def test_a_fold_is_told_to_rounding():
    for fold in (2.0, -2.0, 1e6, 1e-6):
        close, apart = fold * (1.0 + 1e-11), fold * (1.0 + 1e-9)
        assert at_fold([5.0, fold], close, fold)
        assert not at_fold([5.0, fold], apart)
        assert not at_fold([5.0, fold], close, apart)
    assert not at_fold([], 2.0)


def test_a_count_where_no_equilibrium_is_refused(parabola):
    with pytest.raises(ConvergenceError, match=r"elsewhere, its states differ by 1\.0e\+00"):
        exact_count(parabola.exact, parabola.path("mu"), Place(X=np.array([4.0]), value=2.0))


def test_what_special_points_allow():
    assert changes([]) == {0}
    assert changes(["H"]) == {-2, 2}
    assert changes(["LP"]) == {-1, 1}
    assert changes(["BP"]) == {-1, 0, 1}
    assert changes(["H", "H"]) == {-4, 0, 4}


def test_a_ball_is_no_text_and_infinite_ones_bound_nothing():
    assert Ball(arb(1)) != "1"
    assert finite(arb(1)) == 1
    with pytest.raises(UnboundedError, match="the equations are not finite everywhere in the box"):
        finite(arb(1) / arb(0, 1))


def test_nothing_is_proved_of_a_function_that_is_called():
    import racs_bif as rb
    from racs_bif.shelf.load import system_of

    def rates(x, p):
        return [float(x[1]), -x[0] + p.mu * x[1]]

    model = rb.model_from_function("called", rates, states="x y", parameters={"mu": 0.1})
    system = system_of(model)
    with pytest.raises(UsageError, match="nothing can be proved of equations that call a Python"):
        prove_hopf(system.exact, system.path("mu"), np.zeros(2), 0.0, 1.0)


def test_a_box_holds_its_faces():
    box = Box(("a", "b"), np.array([1.0, 5.0]), np.array([0.5, 1.0]), np.zeros(2), np.ones(2))
    assert box.contains("a", 1.5)
    assert box.contains("a", 0.5)
    assert not box.contains("a", 1.6)
    assert box.width("b") == 1.0


def test_bounds_are_rounded_outwards():
    assert _above(arb(0.5)) == 0.5
    with ctx.workprec(200):
        for k in range(1, 50):
            exact = (arb(k) / 51).upper()
            assert exact <= arb(_above(exact)) < exact * (1.0 + 1e-15)


@pytest.mark.parametrize("unit", [1.0, 1e9])
def test_the_unit_of_a_fold_does_not_matter(system_of, unit):
    """x' = q/c - exp(x/c) + 3 x/c: a fold at x = c log 3."""
    system = system_of(
        {"x": "q/c - exp(x/c) + 3*x/c", "y": "x - y"}, parameters={"q": 1.0, "c": unit}
    )
    system = system.with_parameters({"c": unit})
    guess = unit * np.array([1.2, 1.0])
    fold = solve_fold(system.exact, system.path("q"), guess, -0.2 * unit)
    assert fold.X / unit == pytest.approx([math.log(3.0)] * 2, rel=1e-13)
    assert fold.value / unit == pytest.approx(3.0 - 3.0 * math.log(3.0), rel=1e-13)
    assert fold.v == pytest.approx(fold.v[0] * np.ones(2), rel=1e-13)
    assert fold.residual < 1e-12


def test_corrections_of_a_fold_are_compared_with_what_they_correct():
    size = _magnitudes(np.array([3.0, 1e-9, -5.0, 0.1, -0.7]), 2)
    assert size == pytest.approx([3.0, 3e-3, 5.0, 0.7, 0.7])
