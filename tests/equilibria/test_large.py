"""Systems of hundreds and thousands of equations: discretised partial differential equations.

The 1-D Brusselator: M. Holodniok, M. Kubicek, J. Comput. Phys. 55 (1984) 254; an example of MatCont
and of BifurcationKit. Its uniform equilibrium u = A, v = B / A is exact on any mesh, and sines are
eigenvectors of the discrete Laplacian: every special point is one of 2 by 2 matrices.
"""

import math

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.continuation.settings import StepSettings
from racs_bif.equilibria.problem import EquilibriumProblem
from racs_bif.numerics import sparse
from racs_bif.shelf.load import system_of
from racs_bif.verbs.equilibria import equilibrium_problem, follow, starting_point

FEW = StepSettings(initial=0.1, maximum=0.2)
HOPF = {"A": 2.0, "B": 5.45, "D": 0.008, "E": 0.004, "L": 0.4}
TURING = {"A": 2.0, "B": 3.5, "D": 0.002, "E": 0.02, "L": 0.09}


def brusselator(cells, values):
    """Return the model on a mesh of so many inner points."""

    def laplacian(name, k, edge):
        left = f"{name}{k - 1}" if k > 1 else edge
        right = f"{name}{k + 1}" if k < cells else edge
        return f"{(cells + 1) ** 2}/L**2*({left} - 2*{name}{k} + {right})"

    equations = {
        f"u{k}": f"D*{laplacian('u', k, 'A')} + A - (B + 1)*u{k} + u{k}**2*v{k}"
        for k in range(1, cells + 1)
    } | {
        f"v{k}": f"E*{laplacian('v', k, '(B/A)')} + B*u{k} - u{k}**2*v{k}"
        for k in range(1, cells + 1)
    }
    A, B = values["A"], values["B"]
    guess = {name: A if name.startswith("u") else B / A for name in equations}
    return rb.model_from_strings("brusselator", equations, parameters=values, guess=guess)


def wave_number(cells, mode):
    """Return minus the eigenvalue of the discrete Laplacian."""
    return (2.0 * (cells + 1) * math.sin(0.5 * mode * math.pi / (cells + 1))) ** 2


def exact_hopf(cells, mode):
    """Return L, omega and the speed d Re(lambda) / dL of the Hopf point of a mode."""
    A, B, D, E = (HOPF[name] for name in "ABDE")
    mu = wave_number(cells, mode)
    L = math.sqrt((D + E) * mu / (B - 1.0 - A * A))
    matrix = np.array([[B - 1.0 - D * mu / L**2, A * A], [-B, -A * A - E * mu / L**2]])
    assert abs(np.trace(matrix)) < 1e-12
    return L, math.sqrt(np.linalg.det(matrix)), (D + E) * mu / L**3


@pytest.fixture(scope="module")
def thousands():
    """The branch of the system of 2000 equations."""
    return rb.continue_equilibria(brusselator(1000, HOPF), "L", (0.4, 1.2), settings=FEW)


@pytest.fixture(scope="module")
def dense():
    """Return a function that computes as if no system were large."""

    def run(function, *arguments, **options):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(sparse, "LARGE", 10**9)
            return function(*arguments, **options)

    return run


def test_hopf_points_of_two_thousand_equations(thousands):
    hopf = [point for point in thousands.special if point.label != "EP"]
    assert [point.name for point in hopf] == ["H1", "H2"]
    for mode, point in enumerate(hopf, 1):
        L, omega, speed = exact_hopf(1000, mode)
        assert point.parameters["L"] == pytest.approx(L, abs=1e-8)
        assert point.data["omega"] == pytest.approx(omega, abs=1e-8)
        assert point.data["crossing_speed"] == pytest.approx(speed, rel=1e-7)
        # The partial differential equation is not far.
        continuous = mode * math.pi * math.sqrt(0.012 / 0.45)
        assert point.parameters["L"] == pytest.approx(continuous, rel=1e-5)


def test_counts_of_unstable_eigenvalues(thousands):
    places = [exact_hopf(1000, mode)[0] for mode in (1, 2)]
    for L, unstable, label in zip(
        thousands.parameter, thousands.unstable, thousands.labels, strict=True
    ):
        if label != "H":
            assert unstable == 2 * sum(place < L for place in places)
    assert "looked for" not in thousands.stopped


def test_the_lyapunov_coefficient_converges(thousands):
    """With |q| = 1 it falls as one over the number of cells; times that number, as h^2."""
    scaled = {1000: thousands["H1"].data["l1"] * 1001}
    for cells in (30, 61):
        branch = rb.continue_equilibria(brusselator(cells, HOPF), "L", (0.4, 0.6), settings=FEW)
        scaled[cells] = branch["H1"].data["l1"] * (cells + 1)
        assert branch["H1"].criticality == "supercritical"
    assert thousands["H1"].criticality == "supercritical"
    limit = scaled[61] + (scaled[61] - scaled[30]) / 3.0
    assert scaled[61] != pytest.approx(limit, rel=1e-6)
    assert scaled[1000] == pytest.approx(limit, rel=1e-6)


def test_sparse_and_dense_agree(dense):
    system = system_of(brusselator(200, HOPF))
    span = (0.48, 0.54)
    one = rb.continue_equilibria(system, "L", span, settings=FEW)
    other = dense(rb.continue_equilibria, system, "L", span, settings=FEW)
    assert one.spectrum.shape[1] < other.spectrum.shape[1] == 400
    assert one.labels == other.labels
    np.testing.assert_allclose(one.states, other.states, rtol=1e-9)
    np.testing.assert_allclose(one.parameter, other.parameter, rtol=1e-9)
    ordinary = [label != "H" for label in one.labels]
    np.testing.assert_array_equal(one.unstable[ordinary], other.unstable[ordinary])
    for few, every in zip(one.spectrum, other.spectrum, strict=True):
        np.testing.assert_allclose(few[:6], every[:6], rtol=1e-9, atol=1e-9)
    assert one["H1"].parameters["L"] == pytest.approx(other["H1"].parameters["L"], rel=1e-9)
    for key in ("omega", "l1", "c1", "crossing_speed"):
        assert one["H1"].data[key] == pytest.approx(other["H1"].data[key], rel=1e-9)


def test_branch_points(dense):
    """Where patterns grow: the second mode is odd, so that its branch is a pitchfork."""
    system = system_of(brusselator(200, TURING))
    span = (0.09, 0.22)
    A, B, D, E = (TURING[name] for name in "ABDE")
    # det of the 2 by 2 matrix, for kappa = mu / L^2
    roots = np.roots([D * E, D * A * A - E * (B - 1.0), A * A])
    places = [math.sqrt(wave_number(200, mode) / roots.max()) for mode in (1, 2)]
    one = rb.continue_equilibria(system, "L", span, settings=FEW)
    points = [point for point in one.special if point.label == "BP"]
    assert [point.parameters["L"] for point in points] == pytest.approx(places, abs=1e-8)
    assert [point.data["kind"] for point in points] == ["transcritical", "pitchfork"]
    problem = EquilibriumProblem(system.field, system.path("L"))
    z = np.append(one.states[0], one.parameter[0])
    row = np.append(np.zeros(400), 1.0)
    full = dense(problem.jacobian, z)
    np.testing.assert_allclose(problem.jacobian(z).toarray(), full, rtol=1e-12)
    right = np.cos(np.arange(401.0))
    expected = np.linalg.solve(np.vstack([full, row]), right)
    np.testing.assert_allclose(problem.bordered(z, row)(right), expected, rtol=1e-9)
    mode = np.sin(np.pi * np.arange(1, 201) / 201)
    other = points[0].data["other_tangent"]
    assert abs(other[:200] @ mode) == pytest.approx(
        np.sqrt((other[:200] @ other[:200]) * (mode @ mode)), rel=1e-6
    )


def bratu(cells):
    """Return u'' + la exp(u) = 0 between zeros, on a mesh."""
    scale = (cells + 1) ** 2
    name = {0: "0", cells + 1: "0"}
    equations = {
        f"u{k}": f"{scale}*({name.get(k - 1, f'u{k - 1}')} - 2*u{k} + "
        f"{name.get(k + 1, f'u{k + 1}')}) + la*exp(u{k})"
        for k in range(1, cells + 1)
    }
    return rb.model_from_strings("bratu", equations, parameters={"la": 2.0})


def test_the_fold_of_the_bratu_problem():
    """It converges with h^2 to that of the differential equation."""
    folds, coefficients = {}, {}
    for cells in (99, 499, 999):
        branch = rb.continue_equilibria(bratu(cells), "la", (2.0, 4.0), settings=FEW)
        assert [p.name for p in branch.special if p.label != "EP"] == ["LP1"]
        assert [branch.unstable[0], branch.unstable[-1]] == [0, 1]
        folds[cells] = branch["LP1"].parameters["la"]
        coefficients[cells] = abs(branch["LP1"].data["a"]) * math.sqrt(cells + 1)
    exact = 3.513830719125161
    assert abs(folds[999] - exact) < 1e-5 < abs(folds[99] - exact)
    assert folds[999] + (folds[999] - folds[499]) / 3.0 == pytest.approx(exact, abs=1e-9)
    # a belongs to a vector of length one; at 99 cells it is computed from full matrices.
    assert coefficients[999] == pytest.approx(coefficients[99], rel=1e-3)


def test_a_fractional_element_among_many_states(dense):
    """The Jacobian of a realised model, and its equilibrium, from sparse matrices."""
    count = 320
    before = {1: "q"}
    equations = {
        f"x{k}": f"-x{k}**3 + {before.get(k, f'x{k - 1}')} - w*x{k}" for k in range(1, count + 1)
    }
    model = rb.model_from_strings(
        "chain",
        equations,
        parameters={"q": 1.0},
        guess=dict.fromkeys(equations, 0.8),
        elements=[("w", "x1 + x320", "1/(1 + s**0.5)")],
    )
    system = system_of(model)
    x, p = system.equilibrium(), system.values
    assert np.abs(system.field.f(x, p)).max() < 1e-9
    np.testing.assert_allclose(x, dense(system_of(model).equilibrium), rtol=1e-9)
    full = system.field.f_x(x, p)
    found = system.field.f_x_sparse(x, p)
    assert found.nnz < 0.05 * full.size
    np.testing.assert_allclose(found.toarray(), full, rtol=1e-13, atol=1e-12)


def test_a_search_that_was_not_complete_is_reported():
    """Four hundred oscillators with hardly any damping: too many eigenvalues near the axis."""
    k = range(1, 401)
    equations = {f"x{i}": f"v{i}" for i in k}
    equations |= {f"v{i}": f"q - {i}**2*x{i} - v{i}/10" for i in k}
    system = system_of(rb.model_from_strings("rods", equations, parameters={"q": 0.0}))
    problem = equilibrium_problem(system, "q")
    assert problem.unstable(problem.spectrum(np.zeros(801))) == 0
    assert 20.0 < problem.height < 400.0
    # What follows has few states, but the problem remembers.
    problem.field, problem.path = (one := system_of(brusselator(2, HOPF))).field, one.path("L")
    start = starting_point(one, "L", (0.4, 0.6))
    found = follow(problem, start, (0.4, 0.6), FEW)
    assert f"up to an imaginary part of {problem.height:.4g} only" in found.message
