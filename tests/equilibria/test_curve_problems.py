"""Curves: their Jacobians, where they end, and where they go."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import ConvergenceError, ParameterError, UsageError
from racs_bif.fractional.static import StaticField
from racs_bif.shelf.load import system_of
from racs_bif.verbs import curves
from racs_bif.verbs.curves import continue_curve
from racs_bif.verbs.predictions import predict_orbits

PARAMETERS = [("u", "C_s"), ("c", "alpha"), ("C_s", "delta_f"), ("gamma", "E_0")]


@pytest.fixture(scope="module")
def vehicle():
    return rb.load_model("racs")


@pytest.fixture(scope="module")
def shimmy(vehicle):
    return rb.continue_equilibria(vehicle, "u", (5.0, 30.0))["H1"]


@pytest.fixture(scope="module")
def ring():
    # Hopf points on the unit circle, in the middle of the plane.
    return rb.model_from_strings(
        "ring",
        {"x": "(1-p**2-k**2)*x - y - x*(x**2+y**2)", "y": "x + (1-p**2-k**2)*y - y*(x**2+y**2)"},
        parameters={"p": -1.5, "k": 0.1},
        guess={"x": 0.0, "y": 0.0},
    )


def assert_jacobian(problem, z, rtol=2e-5):
    """Compare with central differences, at a z that is no solution."""
    problem.residual(z)
    exact = problem.jacobian(z)
    sizes = np.append(problem.scales(z), max(abs(z[-1]), 1e-3))
    for j, size in enumerate(sizes):
        step = np.zeros(len(z))
        step[j] = 1e-6 * size
        ahead, behind = problem.residual(z + step).copy(), problem.residual(z - step).copy()
        column = (ahead - behind) / (2e-6 * size)
        scale = np.abs(exact).max(axis=1) + np.abs(problem.residual(z)) / size
        np.testing.assert_allclose(exact[:, j] / scale, column / scale, atol=rtol)


@pytest.mark.parametrize("names", PARAMETERS)
@pytest.mark.parametrize("kind", ["hopf", "fold", "bp"])
@pytest.mark.parametrize("operator", ["realised", "exact"])
def test_jacobians(shimmy, names, kind, operator):
    origin = shimmy.origin
    system = replace(origin.system, values=origin.parameters)
    start = curves.CurveStart(system, origin.equilibrium, names, (1.0, 2.0), shimmy.omega)
    problem, z = start.problem(kind, operator)
    if kind == "bp":
        if names[0] == "gamma":
            pytest.skip("gamma does not move equilibria: every point is a branch point")
        z[problem.n] = 0.3
    # Away from the start, where the equations hold by chance or symmetry; G stays small.
    z = z * (1.0 + 1e-9 * np.random.default_rng(3).standard_normal(len(z)))
    assert_jacobian(problem, z, 1e-4 if kind == "hopf" else 2e-5)


def test_second_parameter_derivatives(vehicle):
    field = StaticField(vehicle.exact)
    p = vehicle.values
    rng = np.random.default_rng(1)
    x = rng.standard_normal(len(field.states)) * 0.01
    dp, dq = (p * rng.standard_normal(len(p)) * 0.1 for _ in range(2))
    step = 1e-5
    moved = (field.f_p(x, p + step * dq, dp) - field.f_p(x, p - step * dq, dp)) / (2.0 * step)
    np.testing.assert_allclose(field.f_pp(x, p, dp, dq), moved, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(field.f_pp(x, p, dq, dp), field.f_pp(x, p, dp, dq), rtol=1e-12)


def test_paths_along_derived_parameters_bend(vehicle):
    path = vehicle.path("C_s", "d")
    at = np.array([vehicle.parameters["C_s"], vehicle.parameters["d"]])
    steps = np.diag(1e-5 * at)
    for i in range(2):
        for k in range(2):
            ahead, behind = path.direction(at + steps[k], i), path.direction(at - steps[k], i)
            numeric = (ahead - behind) / (2.0 * steps[k, k])
            np.testing.assert_allclose(path.bend(at, i, k), numeric, rtol=1e-7, atol=1e-12)


def test_closed_curves_are_recognised(ring):
    branch = rb.continue_equilibria(ring, "p", (-2.0, 0.0))
    curve = continue_curve(branch["H1"], ("p", "k"), ((-2.0, 2.0), (-2.0, 2.0)))
    p, k = curve.values.T
    np.testing.assert_allclose(p**2 + k**2, 1.0, rtol=1e-10)
    assert "closed" in curve.stopped
    np.testing.assert_allclose(curve.values[0], curve.values[-1], atol=1e-9)
    angles = np.unwrap(np.arctan2(k, p))
    assert abs(angles[-1] - angles[0]) == pytest.approx(2.0 * np.pi, rel=1e-6)
    assert not curve.special


@pytest.mark.parametrize(
    ("spans", "ends"),
    [
        (((-2.0, 0.5), (-2.0, 2.0)), {0.5}),
        (((-2.0, 2.0), (-0.6, 0.7)), set()),
        (((-2.0, 0.3), (-2.0, 0.4)), {0.3}),
    ],
)
def test_curves_end_exactly_on_either_span(ring, spans, ends):
    branch = rb.continue_equilibria(ring, "p", (-2.0, 0.0))
    curve = continue_curve(branch["H1"], ("p", "k"), spans)
    for p, k in (curve.values[0], curve.values[-1]):
        assert p in spans[0] or k in spans[1]
    (low, high), (lowest, highest) = spans
    p, k = curve.values.T
    assert ((p >= low) & (p <= high) & (k >= lowest) & (k <= highest)).all()
    assert ends <= set(p[[0, -1]])
    assert not curve.early


def test_spans_are_guessed_and_checked(ring, shimmy):
    branch = rb.continue_equilibria(ring, "p", (-2.0, 0.0))
    curve = continue_curve(branch["H1"], ("p", "k"))
    p, k = curve.values.T
    assert p.min() >= -2.0
    assert p.max() <= 0.0
    assert k.max() == pytest.approx(1.0, abs=1e-9)
    assert k.min() == pytest.approx(0.01, rel=1e-12)
    with pytest.raises(UsageError, match="leaves out the start"):
        continue_curve(branch["H1"], ("p", "k"), {"k": (0.5, 1.0)})
    with pytest.raises(ParameterError, match="validity"):
        continue_curve(shimmy, ("u", "C_s"), {"u": (-5.0, 30.0)})
    with pytest.raises(UsageError, match="unknown operator"):
        continue_curve(shimmy, ("u", "C_s"), operator="approximate")


def test_branch_points_that_persist():
    model = rb.model_from_strings(
        "Lorenz",
        {"x": "s*(y-x)", "y": "r*x-y-x*z", "z": "x*y-b*z"},
        parameters={"s": 10.0, "r": 0.5, "b": 8.0 / 3.0},
        guess={"x": 0.0, "y": 0.0, "z": 0.0},
    )
    point = rb.continue_equilibria(model, "r", (0.5, 3.0))["BP1"]
    curve = continue_curve(point, ("r", "s"), ((0.2, 3.0), (1.0, 50.0)))
    np.testing.assert_allclose(curve.column("r"), 1.0, rtol=1e-10)
    np.testing.assert_allclose(curve.column("beta"), 0.0, atol=1e-10)
    assert curve.column("s")[[0, -1]].tolist() == [1.0, 50.0]
    assert not curve.early


def test_branch_points_that_do_not_persist_end_with_the_reason():
    model = rb.model_from_strings(
        "imperfect",
        {"x": "r*x-x**3+e*(1+r)"},
        parameters={"r": -1.0, "e": 0.0},
        guess={"x": 0.0},
    )
    point = rb.continue_equilibria(model, "r", (-1.0, 1.0))["BP1"]
    curve = continue_curve(point, ("r", "e"), ((-1.0, 1.0), (-1.0, 1.0)))
    assert curve.early
    assert "do not persist" in curve.stopped


@pytest.mark.parametrize(
    ("equation", "kind", "other"),
    [
        ("r*x - x**3", "pitchfork", (1.0, 0.0)),
        ("r*x - 0.5*x**2", "transcritical", (2.0, 1.0)),
        ("r*x + 4*x**2 + x**3", "transcritical", (-0.25, 1.0)),
    ],
)
def test_the_other_branch_at_a_branch_point(equation, kind, other):
    model = rb.model_from_strings(
        "crossing", {"x": equation, "y": "-y"}, parameters={"r": -1.0}, guess={"x": 0.0, "y": 0.0}
    )
    point = rb.continue_equilibria(model, "r", (-1.0, 1.0))["BP1"]
    assert point.kind == kind
    expected = np.array([other[0], 0.0, other[1]])
    cosine = point.other_tangent @ expected / np.linalg.norm(expected)
    assert abs(cosine) == pytest.approx(1.0, rel=1e-6)


def test_the_trivial_branch_leaves_a_pitchfork_branch():
    model = rb.model_from_strings(
        "fork",
        {"x": "x*(r + y - x**2)", "y": "r - y"},
        parameters={"r": 1.0},
        guess={"x": 1.4, "y": 1.0},
    )
    point = rb.continue_equilibria(model, "r", (-0.5, 1.0))["BP1"]
    assert point.parameters["r"] == pytest.approx(0.0, abs=1e-8)
    assert point.kind == "pitchfork"
    expected = np.array([0.0, 1.0, 1.0]) / 2.0**0.5
    assert abs(point.other_tangent @ expected) == pytest.approx(1.0, rel=1e-6)


@pytest.mark.parametrize("operator", ["realised", "exact"])
def test_folds_of_a_fractional_model(operator):
    # At rest w = x: 0 = h + (m - 1) x - x^3, folds at h^2 = 4 ((m - 1) / 3)^3, a cusp at (0, 1).
    model = rb.model_from_strings(
        "creeping",
        {"x": "h + (m - 2)*x - x**3 + w"},
        parameters={"h": -1.0, "m": 1.8},
        guess={"x": -1.2},
        elements=[("w", "x", "1/(1 + s**0.5)")],
    )
    branch = rb.continue_equilibria(model, "h", (-1.0, 1.0))
    curve = continue_curve(branch["LP1"], ("h", "m"), ((-1.0, 1.0), (0.5, 2.5)), operator=operator)
    h, m = curve.values.T
    np.testing.assert_allclose(h**2, 4.0 * ((m - 1.0) / 3.0) ** 3, atol=1e-9)
    cusps = [point for point in curve.special if point.label == "CP"]
    assert len(cusps) == 1
    assert cusps[0].parameters["m"] == pytest.approx(1.0, abs=1e-8)
    assert cusps[0].c < 0.0
    assert m[[0, -1]].tolist() == [2.5, 2.5] or abs(h[[0, -1]]).tolist() == [1.0, 1.0]
    assert ("exact" in curve.method) == (operator == "exact")


def bautin(**values):
    r2 = "(x**2+y**2)"
    return rb.model_from_strings(
        "Bautin",
        {
            "x": f"b1*x - y*(1+.3*b2) + x*(b2*{r2} - {r2}**2)",
            "y": f"x*(1+.3*b2) + b1*y + y*(b2*{r2} - {r2}**2)",
        },
        parameters={"b1": -0.5, "b2": 0.3} | values,
        guess={"x": 0.0, "y": 0.0},
    )


def test_predicted_fold_of_cycles():
    branch = rb.continue_equilibria(bautin(), "b1", (-1.0, 1.0))
    curve = continue_curve(branch["H1"], ("b1", "b2"), ((-1.0, 1.0), (-1.0, 1.0)))
    (guess,) = predict_orbits(curve["GH1"], "lpc", 0.1)
    b1, b2 = guess.parameters
    # Exact: r^2 = b2 / 2 at b1 = -b2^2 / 4, and |w|^2 = r^2 / 2.
    assert b1 == pytest.approx(-(b2**2) / 4.0, rel=1e-6)
    assert b2 == pytest.approx(4.0 * 0.1**2, rel=2e-3)
    assert guess.period == pytest.approx(2.0 * np.pi / (1.0 + 0.3 * b2), rel=1e-6)
    radius = np.linalg.norm(guess.states(np.linspace(0.0, 6.0, 7)), axis=0)
    np.testing.assert_allclose(radius, (b2 / 2.0) ** 0.5, rtol=2e-3)


def test_predicted_torus_at_a_zero_hopf_point():
    s, t = -1.0, 0.8
    model = rb.model_from_strings(
        "zero-Hopf",
        {
            "z": "m1 + z**2 + s*(x**2+y**2)",
            "x": "(m2 + t*z - z**2)*x - 2*y",
            "y": "(m2 + t*z - z**2)*y + 2*x",
        },
        parameters={"m1": -0.5, "m2": 0.2, "s": s, "t": t},
        guess={"z": -0.7, "x": 0.0, "y": 0.0},
    )
    branch = rb.continue_equilibria(model, "m1", (-0.6, 0.3))
    curve = continue_curve(branch["LP1"], ("m1", "m2"), ((-0.6, 0.3), (-1.0, 1.0)))
    (guess,) = predict_orbits(curve["ZH1"], "ns", 0.05)
    # Trace 2 z = 0 at the cycle: m2 = 0, m1 = -s r^2 with r^2 = 2 |w|^2; angle T sqrt(-2 s t r^2).
    square = 2.0 * 0.05**2
    np.testing.assert_allclose(guess.parameters, [-s * square, 0.0], atol=1e-9)
    assert guess.period == pytest.approx(np.pi, rel=1e-9)
    assert guess.angle == pytest.approx(np.pi * (-2.0 * s * t * square) ** 0.5, rel=1e-6)


def test_predicted_tori_at_a_double_hopf_point():
    pair = "(m1 - (x**2+y**2) - 2*(z**2+w**2))"
    other = "(m2 - 3*(x**2+y**2) - 1.5*(z**2+w**2))"
    model = rb.model_from_strings(
        "double Hopf",
        {
            "x": f"{pair}*x - y",
            "y": f"{pair}*y + x",
            "z": f"{other}*z - g*w",
            "w": f"{other}*w + g*z",
        },
        parameters={"m1": -0.5, "m2": -0.3, "g": 2.0**0.5},
        guess=dict.fromkeys("xyzw", 0.0),
    )
    branch = rb.continue_equilibria(model, "m1", (-0.6, 0.6))
    curve = continue_curve(branch["H1"], ("m1", "m2"), ((-0.6, 0.6), (-1.0, 1.0)))
    first, second = predict_orbits(curve["HH1"], "ns", 0.05)
    square = 2.0 * 0.05**2
    np.testing.assert_allclose(first.parameters, [square, 3.0 * square], rtol=1e-6)
    np.testing.assert_allclose(second.parameters, [2.0 * square, 1.5 * square], rtol=1e-6)
    assert first.angle == pytest.approx(2.0 * np.pi * 2.0**0.5, rel=1e-6)
    assert second.angle == pytest.approx(2.0 * np.pi / 2.0**0.5, rel=1e-6)


@pytest.mark.parametrize("on", ["fold", "hopf"])
def test_predicted_homoclinic_orbit(on):
    model = rb.model_from_strings(
        "takens",
        {"x": "y", "y": "b1 + b2*y + a*x**2 + b*x*y"},
        parameters={"b1": -0.5, "b2": 0.4, "a": 1.0, "b": 1.0},
        guess={"x": 0.7, "y": 0.0},
    )
    spans = ((-0.6, 0.3), (-1.0, 1.0))
    branch = rb.continue_equilibria(model, "b1", (-0.6, 0.3))
    curve = continue_curve(branch["LP1"], ("b1", "b2"), spans)
    if on == "hopf":
        curve = continue_curve(curve["BT1"], ("b1", "b2"), spans)
    epsilon = 0.2
    (guess,) = predict_orbits(curve["BT1"], "homoclinic", epsilon)
    b1, b2 = guess.parameters
    assert b1 == pytest.approx(-4.0 * epsilon**4, rel=1e-6)
    assert b2 == pytest.approx(10.0 / 7.0 * epsilon**2, rel=1e-3)
    # It leaves the saddle and returns to it, and follows the flow to leading order.
    far = guess.states(np.array([-60.0, 60.0]))
    np.testing.assert_allclose(far, np.column_stack([guess.saddle] * 2), atol=1e-8)
    system = system_of(model)
    assert (
        np.abs(system.field.f(guess.saddle, system.path("b1", "b2").vector([b1, b2]))).max() < 1e-9
    )
    times = np.linspace(-8.0, 8.0, 33)
    states = guess.states(times)
    slope = np.gradient(states[0], times)
    np.testing.assert_allclose(states[1][1:-1], slope[1:-1], atol=0.1 * epsilon**3)


def test_orbits_that_a_point_cannot_predict_are_refused(shimmy):
    with pytest.raises(UsageError, match="these can: GH"):
        predict_orbits(shimmy, "lpc")
    with pytest.raises(UsageError, match="unknown kind of orbit"):
        predict_orbits(shimmy, "pd")


def test_no_torus_starts_at_a_zero_hopf_point_of_the_other_sign():
    model = rb.model_from_strings(
        "zero-Hopf",
        {
            "z": "m1 + z**2 + s*(x**2+y**2)",
            "x": "(m2 + t*z - z**2)*x - 2*y",
            "y": "(m2 + t*z - z**2)*y + 2*x",
        },
        parameters={"m1": -0.5, "m2": 0.2, "s": 1.0, "t": 0.8},
        guess={"z": -0.7, "x": 0.0, "y": 0.0},
    )
    branch = rb.continue_equilibria(model, "m1", (-0.6, 0.3))
    curve = continue_curve(branch["LP1"], ("m1", "m2"), ((-0.6, 0.3), (-1.0, 1.0)))
    with pytest.raises(ConvergenceError, match="no Neimark-Sacker curve starts at this zero-Hopf"):
        predict_orbits(curve["ZH1"], "ns", 0.05)


def test_what_a_point_predicts_is_in_its_own_plane():
    model = rb.model_from_strings(
        "takens",
        {"x": "y", "y": "b1 + b2*y + a*x**2 + b*x*y"},
        parameters={"b1": -0.5, "b2": 0.4, "a": 1.0, "b": 1.0},
        guess={"x": 0.7, "y": 0.0},
    )
    spans = ((-0.6, 0.3), (-1.0, 1.0))
    branch = rb.continue_equilibria(model, "b1", (-0.6, 0.3))
    point = continue_curve(branch["LP1"], ("b1", "b2"), spans)["BT1"]
    with pytest.raises(UsageError, match="homoclinic orbits in the plane of b1 and b2 only"):
        continue_curve(point, ("b1", "a"), ((-0.6, 0.3), (0.5, 2.0)), kind="homoclinic")
    normal = rb.continue_equilibria(bautin(), "b1", (-1.0, 1.0))
    curve = continue_curve(normal["H1"], ("b1", "b2"), ((-1.0, 1.0), (-1.0, 1.0)))
    words = "GH1 predicts cycles in the plane of b1 and b2, in which it was found"
    with pytest.raises(UsageError, match=words):
        continue_curve(curve["GH1"], ("b2", "b1"), ((-1.0, 1.0), (-1.0, 1.0)), kind="lpc")
