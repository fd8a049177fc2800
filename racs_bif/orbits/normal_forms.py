"""Normal-form coefficients of bifurcations of cycles, from orbits of any discretisation."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.fractional.realised import RealisedField
from racs_bif.orbits.critical_orbit import GaussOrbits, critical_orbit, finer, orbit_mesh, sampled
from racs_bif.orbits.cycles_fold_form import FoldForm
from racs_bif.orbits.doubling_form import DoublingForm
from racs_bif.orbits.torus_form import TorusForm

if TYPE_CHECKING:
    from racs_bif.continuation.points import Point, SpecialPoint
    from racs_bif.orbits.critical_mode import Coefficient, CriticalForm
    from racs_bif.orbits.problem import OrbitProblem
    from racs_bif.symbolic.field import VectorField

_ROUNDING: Final = 1e-10
"""Error of a coefficient by rounding, relative to the sum of its terms' magnitudes."""
_MESHES: Final = 5
"""Most meshes, each of half as many intervals more than the one before."""
_SURE: Final = 1e-4
"""Error relative to a coefficient at which no finer mesh is taken."""
_UNSURE: Final = 0.1
"""Error relative to a coefficient from which on its sign is not taken to be known."""
_ZERO: Final = 1e-6
"""Size, relative to the sum of its terms' magnitudes, at which one of unknown sign is zero."""


def cycle_normal_form(
    problem: OrbitProblem, point: Point | SpecialPoint, label: str, angle: float = 0.0
) -> dict[str, Any]:
    """Return the normal-form coefficient of a fold, period doubling or Neimark-Sacker point.

    The orbit is solved for again by collocation of degree 6, on a mesh made for it and on finer
    ones, until the coefficient no longer changes, each time with the parameter at which the
    critical multiplier is on the unit circle. For orbits of the exact fractional operator (harmonic
    balance) that is the orbit, and the bifurcation, of the realisation, as the multipliers are.

    The coefficients are those of Yu. A. Kuznetsov, W. Govaerts, E. J. Doedel and A. Dhooge (SIAM J.
    Numer. Anal. 43, 2005): `FoldForm`, `DoublingForm`, `TorusForm`. MatCont prints the same b; its
    c and Re d (nf_PD.m and nf_NS.m of version 7) are these times a positive number that depends on
    its mesh, for it multiplies by the product <v*, v> that the formulas divide by.

    Parameters
    ----------
    problem : OrbitProblem
        Any discretisation.
    point : Point
        The bifurcation.
    label : str
        ``LPC``, ``PD`` or ``NS``.
    angle : float
        Angle of the critical multipliers of NS.

    Returns
    -------
    dict
        ``b``, ``c`` or ``d`` and its error, ``b_error`` and so on; for PD and NS ``criticality``.
        Where the coefficient cannot be computed to accuracy: ``normal_form`` alone, a sentence that
        says why.
    """
    form = _form(label, own_states(problem.field), angle)
    try:
        coefficient, error = _coefficient(problem, point, form)
    except (ConvergenceError, np.linalg.LinAlgError) as reason:
        return {"normal_form": f"{form.name} was not computed: {reason}"}
    value, size = coefficient.value, coefficient.size
    leading = abs(value.real)
    resolved = error <= _UNSURE * leading
    if not resolved and leading + error > _ZERO * size:
        return {
            "normal_form": f"{form.name} = {value:.3g} is off by {error:.1g}: it is not resolved"
        }
    number = value if label == "NS" else value.real
    found: dict[str, Any] = {form.name: number, f"{form.name}_error": error}
    if label == "LPC":
        return found
    sign = "supercritical" if value.real < 0.0 else "subcritical"
    return found | {"criticality": sign if resolved else "degenerate"}


def _coefficient(
    problem: OrbitProblem, point: Point | SpecialPoint, form: CriticalForm
) -> tuple[Coefficient, float]:
    """Return the coefficient on the finest mesh, and its error."""
    field, path, z = problem.field, problem.path, point.z
    curve = sampled(problem, z, orbit_mesh(problem, z))
    period, parameter = problem.period(z), float(z[-1])
    before: Coefficient | None = None
    slope = 0.0
    for _ in range(_MESHES):
        orbit = critical_orbit(GaussOrbits(field, path, curve, period, parameter), form, slope)
        found = form.coefficient(orbit.along, orbit.mode)
        if before is not None:
            error = abs(found.value - before.value) + _ROUNDING * found.size
            if error <= _SURE * abs(found.value.real):
                break
        before, curve = found, finer(orbit.along.curve)
        period, parameter, slope = orbit.along.period, orbit.parameter, orbit.slope
    return found, float(error)


def _form(label: str, own: int, angle: float) -> CriticalForm:
    if label == "LPC":
        return FoldForm()
    return DoublingForm(own) if label == "PD" else TorusForm(own, angle)


def own_states(field: VectorField) -> int:
    """Return the number of states that are the model's own, not the memory of a realisation.

    All of them where a model is made of elements only.
    """
    own = len(field.compiled.states) if isinstance(field, RealisedField) else 0
    return own or len(field.states)
