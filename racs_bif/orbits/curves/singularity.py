"""How singular the equations of the eigenfunctions are: test functions along a curve of cycles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from racs_bif.orbits.curves.problem import CycleCurve
    from racs_bif.symbolic.field import Array


def pairing(problem: CycleCurve, z: Array) -> float:
    """Return the product of left and right null vectors, its sign kept along the curve.

    It vanishes where the critical multiplier has a longer Jordan chain: R1 on a curve of folds, R2
    on one of period doublings.
    """
    solver = problem.twisted(z)
    starts = problem.layout.functions(z)[:, 0, 0] / problem.reference(z).scales
    right = float(np.sign(np.sum(solver.null * starts)))
    return solver.pairing * _sense(problem, z) * right


def quadratic(problem: CycleCurve, z: Array) -> float:
    """Return the quadratic coefficient of a fold of cycles up to a positive factor.

    It is the product of the left null vector with the second derivative of the orbit's equations
    along the right one, period included.
    """
    function, further = problem.layout.functions(z)[0].ravel(), problem.layout.further_of(z)
    main = np.concatenate((function, further, (0.0, 0.0)))
    found = problem.twisted(z).solve(-problem.turned(z, main[None]), np.zeros((2, 1)))
    return float(found.test[0]) * _sense(problem, z)


def _sense(problem: CycleCurve, z: Array) -> float:
    """Return the sign of the left null vector against that of the reference."""
    known = problem.references[z[-3]].dual
    return 1.0 if known is None else float(np.sign(np.sum(problem.twisted(z).dual * known)))
