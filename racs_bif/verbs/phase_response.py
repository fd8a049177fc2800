"""The phase response curve of a stable orbit."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import racs_bif.orbits.phase_response as numerics
from racs_bif.errors import UsageError
from racs_bif.numerics.threads import single_threaded
from racs_bif.orbits.problem import OrbitProblem
from racs_bif.results.provenance import describe
from racs_bif.verbs.origin import Origin

if TYPE_CHECKING:
    from racs_bif.orbits.phase_response import PhaseResponse
    from racs_bif.results.special import SpecialPoint


@single_threaded
def phase_response(point: SpecialPoint, *, samples: int = 401) -> PhaseResponse:
    """Compute how far a small kick to each state shifts the phase of a stable orbit.

    Parameters
    ----------
    point : SpecialPoint
        An orbit of a branch made in this process: a value asked for by ``at`` (UZ), an end (EP).
    samples : int
        Number of times over one period.

    Returns
    -------
    PhaseResponse
        Of the model's own states. For a model with fractional elements it is that of its
        realisation, and `PhaseResponse.realised` says so.

    Raises
    ------
    UsageError
        If the point is no orbit, the orbit is not stable, or it was loaded from a file.
    ConvergenceError
        If the orbit is not found again, or the adjoint equation cannot be solved.

    Examples
    --------
    >>> import racs_bif as rb
    >>> model = rb.model_from_strings("clock", {"x": "m*x-y-x*(x**2+y**2)",
    ...     "y": "x+m*y-y*(x**2+y**2)"}, parameters={"m": -0.5}, guess={"x": 0.0, "y": 0.0})
    >>> hopf = rb.continue_equilibria(model, "m", (-0.5, 1))["H1"]
    >>> orbit = rb.continue_orbits(hopf, at=[0.25])["UZ1"]
    >>> found = rb.phase_response(orbit)
    >>> float(abs(found.radians).max().round(6))  # 1 / radius
    2.0
    """
    origin = point.origin
    if not isinstance(origin, Origin):
        msg = f"{point.name} was loaded from a file; continue from it to have its orbit again"
        raise UsageError(msg)
    problem, raw = origin.problem, origin.raw
    if not isinstance(problem, OrbitProblem) or problem.degenerate(raw.z):
        msg = f"{point.name} is no orbit; take a point of a branch of orbits"
        raise UsageError(msg)
    if not problem.stable(problem.floquet(raw.z).multipliers):
        msg = (
            f"the orbit at {point.name} is not stable and has no phase to shift; take a stable one"
        )
        raise UsageError(msg)
    found = numerics.phase_response(problem, raw.z, samples)
    own = len(origin.system.states)
    return replace(
        found,
        states=origin.system.states,
        profile=found.profile[:own],
        orbit=found.orbit[:own],
        realised=origin.system.fractional,
        units=describe(origin.system).units,
        time_unit=origin.system.time_unit,
    )
