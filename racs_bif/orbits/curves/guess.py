"""Where curves of special cycles begin: at cycles that a normal form of equilibria predicts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.orbits.collocation_start import collocated_from_samples
from racs_bif.orbits.curves.kinds import KINDS, CycleKind
from racs_bif.orbits.curves.one_of import OneOf
from racs_bif.orbits.curves.start import cycle_curve

if TYPE_CHECKING:
    from racs_bif.equilibria.orbit_guess import OrbitGuess
    from racs_bif.orbits.collocation import CollocationProblem
    from racs_bif.orbits.collocation_settings import CollocationSettings
    from racs_bif.orbits.curves.problem import CycleCurve, Span
    from racs_bif.symbolic.field import Array, VectorField
    from racs_bif.symbolic.paths import ParameterPath

_SAMPLES: Final = 201
_ITERATIONS: Final = 12
_FOUND: Final = 1e-8
_FAR: Final = 0.5


def predicted_cycle(
    guess: OrbitGuess,
    field: VectorField,
    path: ParameterPath,
    spans: tuple[Span, Span],
    settings: CollocationSettings | None = None,
) -> tuple[CycleCurve, Array]:
    """Start a curve at a cycle that is known nearly.

    Its amplitude is held while the cycle is solved for with one parameter free, which
    tells an orbit from the equilibrium it surrounds.

    Parameters
    ----------
    guess : OrbitGuess
        The cycle.
    field : VectorField
        The right-hand side.
    path : ParameterPath
        The two active parameters.
    spans : pair of (float, float)
        Their intervals.
    settings : CollocationSettings, optional
        How orbits are resolved.

    Raises
    ------
    ConvergenceError
        If there is no cycle close by.
    """
    kind: CycleKind = KINDS[guess.label]
    phases = np.linspace(0.0, 2.0 * np.pi, _SAMPLES)
    times, profile = phases / (2.0 * np.pi) * guess.period, guess.states(phases)
    one = OneOf(path, 0, float(guess.parameters[1]))
    start = collocated_from_samples(
        field, one, times, profile, float(guess.parameters[0]), settings=settings
    )
    z = held(start.problem, start.z)
    active = np.array((float(z[-1]), float(guess.parameters[1])))
    return cycle_curve(kind, (start.problem, z), path, spans, active, angle=guess.angle)


def held(problem: CollocationProblem, z: Array) -> Array:
    """Return the orbit of the guess's amplitude, by Newton's method with the parameter free.

    Raises
    ------
    ConvergenceError
        If it is not found close by.
    """
    magnitudes, first = problem.magnitudes(z), z
    curve = problem.curve(z)
    departures = curve.nodes - curve.mean()
    row = problem.join(departures, 0.0, 0.0) / magnitudes**2
    for _ in range(_ITERATIONS):
        step = problem.bordered(z, row)(np.append(problem.residual(z), 0.0))
        z = z - step
        if float(np.abs((z - first) / magnitudes).max()) > _FAR:
            break
        if float(np.abs(step / magnitudes).max()) < _FOUND:
            return z
    msg = "no cycle was found where the normal form predicts one; give a smaller size"
    raise ConvergenceError(msg)
