"""Linear equations along a collocated orbit: v' = A(t) v + r(t), closed by v(T) = c v(0).

The collocation equations of v on the orbit's own mesh and Gauss points: orbit, v and whatever else
is solved for in turn make one collocation method for one larger system, so that numbers found this
way converge as those of the orbit do, with the power 2 m of the width. Values at the Gauss points
are eliminated interval by interval; the mesh points remain, bordered, as one sparse system.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from racs_bif.errors import ConvergenceError
from racs_bif.orbits.stages import FactoredStages, InvertedStages, interval_matrices

if TYPE_CHECKING:
    from collections.abc import Callable

    from racs_bif.orbits.piecewise import Piecewise
    from racs_bif.orbits.stages import DenseStages
    from racs_bif.symbolic.field import Array, VectorField

Function = NDArray[np.inexact[Any]]
"""Values of a function of time at the Gauss points of all intervals, (N, m, n), real or complex."""
_STILL: Final = 1e-7
"""Range over the largest at which a state stands still, but for errors."""
_INVERTED: Final = 28
"""Unknowns of an interval up to which an explicit inverse is faster than factors (measured)."""


class Variational:
    """An orbit and the linear equations along it.

    Parameters
    ----------
    field : VectorField
        The right-hand side.
    p : array (np,)
        Base parameters.
    curve : Piecewise
        The orbit, a solution of the collocation equations.
    period : float
        Its period.
    adjoint : bool
        Whether A is -f_x^T, for the adjoint equation, instead of f_x.

    Attributes
    ----------
    shape : tuple of int
        (N, m, n).
    tau : array (N,)
        Lengths of the intervals in time.
    scales : array (n,)
        Units in which the equations are solved: the ranges of the states, or their inverses.
    weights : array (N, m, 1)
        Weights of the quadrature over one period.

    Raises
    ------
    ConvergenceError
        If the Jacobian is not finite along the orbit, or an interval's equations are singular.
    """

    def __init__(
        self,
        field: VectorField,
        p: Array,
        curve: Piecewise,
        period: float,
        *,
        adjoint: bool = False,
    ) -> None:
        self.field, self.p, self.curve, self.period = field, p, curve, period
        self.gauss = curve.gauss
        stages = curve.stages()
        self.shape: tuple[int, ...] = stages.shape
        self.points = np.ascontiguousarray(stages.reshape(-1, self.shape[-1]).T)
        self.tau = period * curve.mesh.widths
        self.weights = (self.tau[:, None] * self.gauss.weights)[:, :, None]
        scales = typical_scales(curve)
        self.scales = 1.0 / scales if adjoint else scales
        self.jacobians: Array = field.f_x(self.points, p).reshape(*self.shape, self.shape[-1])
        self._rate = -np.swapaxes(self.jacobians, -1, -2) if adjoint else self.jacobians
        if not np.isfinite(self.jacobians).all():
            raise ConvergenceError("the Jacobian is not finite along the orbit")
        self._stages = self._eliminated()
        self.transitions = self._stages.transitions()

    def _eliminated(self) -> DenseStages:
        balanced = self._rate * (self.scales / self.scales[:, None])
        matrices = interval_matrices(self.gauss, balanced, self.tau)
        few = matrices.shape[-1] <= _INVERTED
        try:
            return (InvertedStages if few else FactoredStages)(self.gauss, matrices)
        except np.linalg.LinAlgError as error:
            raise ConvergenceError(
                "the equations of a mesh interval are singular: take more intervals"
            ) from error

    @cached_property
    def rates(self) -> Array:
        """The right-hand side f along the orbit, (N, m, n)."""
        return np.ascontiguousarray(self.field.f(self.points, self.p).T).reshape(self.shape)

    def function(self, columns: Function) -> Function:
        """Return columns (n, N m), as a vector field gives them, as a function (N, m, n)."""
        return np.ascontiguousarray(columns.T).reshape(self.shape)

    def columns(self, function: Function) -> Function:
        """Return a function (N, m, n) as columns (n, N m)."""
        return np.ascontiguousarray(function.reshape(-1, self.shape[-1]).T)

    def times(self, function: Function) -> Function:
        """Return A(t) v(t)."""
        return np.asarray((self._rate @ function[..., None])[..., 0])

    def second(self, u: Function, v: Function) -> Function:
        """Return B(u, v) along the orbit."""
        columns = self.columns(u), self.columns(v)
        return self.function(self.field.f_xx_along(self.points, self.p, *columns))

    def third(self, u: Function, v: Function, w: Function) -> Function:
        """Return C(u, v, w) along the orbit."""
        columns = self.columns(u), self.columns(v), self.columns(w)
        return self.function(self.field.f_xxx_along(self.points, self.p, *columns))

    def size(self, v: Function) -> float:
        """Return the root of the integral of |v|^2 over one period, states over their scales."""
        return float(np.sqrt(np.sum(self.weights * np.abs(v / self.scales) ** 2)))

    def noise(self, seed: int) -> Array:
        """Return a function that is orthogonal to nothing, the same on every call."""
        smooth = np.random.default_rng(seed).standard_normal((3, self.shape[-1]))
        phase = 2.0 * np.pi * self.curve.mesh.times(self.gauss.abscissae)[:, :, None]
        waves = smooth[0] + smooth[1] * np.cos(phase) + smooth[2] * np.sin(phase)
        return np.asarray(self.scales * waves)

    # ------------------------------------------------------------------ elimination, in units

    def at_ends(self, rhs: Function) -> Function:
        """Return what right-hand sides (c, N, m, n) add at the ends of the intervals."""
        return _by_parts(self._stages.at_ends, rhs) if len(rhs) else rhs[:, :, 0]

    def adjoint(self, rows: Function) -> Function:
        """Return B^-T rows; see `Stages`."""
        return _by_parts(self._stages.adjoint, rows) if len(rows) else rows

    def at_stages(self, starts: Function, rhs: Function) -> Function:
        """Return the values at the Gauss points from starts (c, N, n) and right-hand sides."""
        return _by_parts(
            self._stages.solve, starts[:, :, None] * self.gauss.row_sums[:, None] + rhs
        )


def typical_scales(curve: Piecewise) -> Array:
    """Return the ranges (n,) of the states; those that stand still are measured by the others."""
    ranges = curve.ranges()
    largest = float(ranges.max(initial=0.0)) or 1.0
    return np.where(ranges > _STILL * largest, ranges, largest)


def _by_parts(function: Callable[[Array], Array], values: Function) -> Function:
    """Apply a real linear function to real and imaginary part."""
    if np.iscomplexobj(values):
        return function(values.real) + 1j * function(values.imag)
    return function(np.asarray(values, dtype=float))
