"""A bifurcation of cycles on a Gauss mesh of its own, from whichever discretisation found it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.orbits.collocation import CollocationProblem
from racs_bif.orbits.collocation_settings import CollocationSettings
from racs_bif.orbits.critical_mode import along_starts
from racs_bif.orbits.cycles_fold_form import FoldForm
from racs_bif.orbits.history import reference_of
from racs_bif.orbits.mesh import Mesh, equidistributed
from racs_bif.orbits.piecewise import Piecewise, equidistant
from racs_bif.orbits.polishing import direction, polished
from racs_bif.orbits.variational import Variational, typical_scales

if TYPE_CHECKING:
    from collections.abc import Callable

    from racs_bif.orbits.critical_mode import CriticalForm, Mode
    from racs_bif.orbits.problem import OrbitProblem
    from racs_bif.symbolic.field import Array, VectorField
    from racs_bif.symbolic.paths import ParameterPath

DEGREE: Final = 6
"""Even, so that the mesh points converge with the power 12 and fast decay stays decay."""
_FEWEST: Final = 20
_MOST: Final = 160
_TOLERANCE: Final = 1e-7
"""Error of the polynomials, relative to the range of each state, that the mesh is chosen for."""
_FINER: Final = 1.5
_ADAPTATIONS: Final = 3
_STEP: Final = 1e-4
"""First step along the branch, in ranges of the states, to see how the critical exponent moves."""
_FARTHEST: Final = 0.1
"""Farthest that the bifurcation may lie from where the other discretisation found it."""
_STEPS: Final = 8
_FOUND: Final = 1e-10
_CLOSE: Final = 1e-7
"""Critical exponents times the period that count as zero: reached, and still accepted."""


@dataclass(frozen=True, eq=False)
class CriticalOrbit:
    """A bifurcation on a mesh of its own.

    Attributes
    ----------
    along : Variational
        The orbit, and the linear equations along it.
    mode : Mode
        The critical function.
    parameter : float
        The active parameter.
    slope : float
        How the critical exponent times the period changes along the branch.
    """

    along: Variational
    mode: Mode
    parameter: float
    slope: float


def finer(curve: Piecewise) -> Piecewise:
    """Return an orbit on a mesh of half as many intervals more."""
    count = curve.mesh.steps
    places = np.linspace(0.0, count, int(np.ceil(_FINER * count)) + 1)
    mesh = Mesh(np.interp(places, np.arange(count + 1), curve.mesh.nodes), 1)
    return Piecewise(mesh, curve(equidistant(mesh, DEGREE)))


def orbit_mesh(problem: OrbitProblem, z: Array) -> Mesh:
    """Return a mesh that suits an orbit of any discretisation, from its profile alone."""
    mesh = Mesh.uniform(4 * _FEWEST, 1)
    for _ in range(_ADAPTATIONS):
        curve = sampled(problem, z, mesh)
        errors = curve.errors(typical_scales(curve))
        needed = float(np.sum((errors / _TOLERANCE) ** (1.0 / (DEGREE + 1))))
        count = min(max(int(np.ceil(needed)), _FEWEST), _MOST)
        mesh = equidistributed(mesh, errors, DEGREE + 1, count, 1)
    return mesh


def sampled(problem: OrbitProblem, z: Array, mesh: Mesh) -> Piecewise:
    """Return an orbit of any discretisation as polynomials on a mesh; they solve no equation."""
    times = equidistant(mesh, DEGREE)
    return Piecewise(mesh, problem.sample(z, times.ravel()).T.reshape(*times.shape, -1))


class GaussOrbits:
    """Orbits near one that is known, on a mesh.

    Parameters
    ----------
    field : VectorField
        The right-hand side.
    path : ParameterPath
        Where the active parameter leads.
    guess : Piecewise
        The orbit, nearly, on the mesh.
    period, parameter : float
        Its period and parameter, nearly.
    """

    def __init__(
        self,
        field: VectorField,
        path: ParameterPath,
        guess: Piecewise,
        period: float,
        parameter: float,
    ) -> None:
        steps = guess.mesh.steps
        settings = CollocationSettings(intervals=steps, degree=DEGREE, most_intervals=steps)
        reference = reference_of(guess, typical_scales(guess))
        self.problem = CollocationProblem(field, path, reference, guess, settings)
        self.guess = self.problem.join(guess.nodes, period, parameter)

    def along(self, z: Array) -> Variational:
        """Return the linear equations along an orbit."""
        problem = self.problem
        p = problem.path.vector(float(z[-1]))
        return Variational(problem.field, p, problem.curve(z), problem.period(z))

    def held(self) -> Array:
        """Return the direction of the parameter."""
        held = np.zeros(len(self.guess))
        held[-1] = 1.0
        return held

    def across(self) -> Array:
        """Return the direction of the branch where it turns round in the parameter."""
        along = self.along(self.guess)
        mode = FoldForm().mode(along)
        nodes = along_starts(along, np.real(mode.starts), np.real(mode.function))
        return self.problem.join(nodes, self.problem.period(self.guess), 0.0)


def critical_orbit(orbits: GaussOrbits, form: CriticalForm, slope: float = 0.0) -> CriticalOrbit:
    """Solve for the orbit at which the critical exponent of a normal form vanishes.

    Parameters
    ----------
    orbits : GaussOrbits
        The orbits around.
    form : CriticalForm
        The normal form.
    slope : float
        `CriticalOrbit.slope` where it is known from another mesh.

    Raises
    ------
    ConvergenceError
        If none is found close by.
    """
    problem = orbits.problem
    towards = orbits.across() if isinstance(form, FoldForm) else orbits.held()
    first = polished(problem, orbits.guess, towards)
    tangent = direction(problem, first, towards)
    tangent = tangent / np.abs(tangent / problem.magnitudes(first)).max()

    near: Mode | None = None

    def at(distance: float) -> tuple[Array, Variational, Mode]:
        nonlocal near
        z = polished(problem, first + distance * tangent, tangent) if distance else first
        along = orbits.along(z)
        near = form.mode(along, near)
        return z, along, near

    (z, along, mode), slope = _root(at, slope)
    return CriticalOrbit(along, mode, float(z[-1]), slope)


def _root(
    at: Callable[[float], tuple[Array, Variational, Mode]], slope: float
) -> tuple[tuple[Array, Variational, Mode], float]:
    """Find where the critical exponent vanishes by the secant method; return the best, the slope.

    Without a slope the first step is a short one.
    """
    before, found = 0.0, at(0.0)
    best, size = found, _growth(found)
    known = slope and abs(size) < _FARTHEST * abs(slope)
    here = -size / slope if known else _STEP
    last = size
    for _ in range(_STEPS):
        if abs(size) < _FOUND:
            break
        found = at(here)
        value = _growth(found)
        if abs(value) < abs(size):
            best, size = found, value
        elif here != _STEP and abs(size) < _CLOSE:
            break
        if value == last:
            break
        slope = (value - last) / (here - before)
        before, here, last = here, here - value / slope, value
        if not abs(here) < _FARTHEST:
            raise ConvergenceError("the bifurcation is not found again close by on the Gauss mesh")
    if not abs(size) < _CLOSE:
        raise ConvergenceError(f"the critical exponent stays at {size:.1e} over the period")
    return best, slope


def _growth(found: tuple[Array, Variational, Mode]) -> float:
    """Return the critical exponent times the period, real part."""
    _, along, mode = found
    return float(np.real(mode.exponent)) * along.period
