"""Normal-form coefficients along a curve of cycles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.orbits.critical_mode import Coefficient, Mode, unit
from racs_bif.orbits.doubling_form import DoublingForm
from racs_bif.orbits.normal_forms import own_states
from racs_bif.orbits.torus_form import TorusForm
from racs_bif.orbits.variational import Variational

if TYPE_CHECKING:
    from racs_bif.orbits.curves.problem import CycleCurve
    from racs_bif.symbolic.field import Array


_NONE: Final = Coefficient(complex("nan"), float("nan"))


def coefficient(problem: CycleCurve, z: Array) -> Coefficient:
    """Return c of a period doubling or d of a Neimark-Sacker point; NaN where there is none.

    On the curve's own mesh, with the eigenfunctions that the curve has anyway; see `DoublingForm`
    and `TorusForm` for what the coefficients are.
    """
    field = problem.field
    own = own_states(field)
    functions = problem.variation(z).stages(problem.layout.functions(z))
    starts = problem.layout.functions(z)[:, :, 0]
    try:
        p = problem.path.vector(problem.active(z))
        along = Variational(field, p, problem.curve(z), problem.period(z))
        if problem.kind.name == "pd":
            found, length = unit(along, functions[0], own)
            mode = Mode(found, starts[0] / length, 0.0, -1.0)
            return DoublingForm(own).coefficient(along, mode)
        kappa = float(problem.layout.further_of(z)[0])
        if abs(kappa) >= 1.0:
            return _NONE
        angle = float(np.arccos(kappa))
        back = np.exp(-1j * angle)
        # (M - mu)(M - conj mu) = 0 on the plane of V1 and V2 = M V1
        found, length = unit(along, functions[1] - back * functions[0], own)
        mode = Mode(found, (starts[1] - back * starts[0]) / length, 0.0, complex(np.conj(back)))
        return TorusForm(own, angle).coefficient(along, mode)
    except (ConvergenceError, np.linalg.LinAlgError):
        return _NONE
