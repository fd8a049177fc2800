"""The equations of the eigenfunctions of a cycle, and how they change with the cycle."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from racs_bif.orbits.curves.kinds import CycleKind
    from racs_bif.orbits.equations import Collocated, Equations
    from racs_bif.orbits.reference import Reference
    from racs_bif.orbits.twisted import Border
    from racs_bif.symbolic.field import Array, VectorField
    from racs_bif.symbolic.paths import ParameterPath


class Variation:
    """V' = tau f_x V + beta w f along one orbit, w the widths of the intervals.

    Parameters
    ----------
    right : tuple
        Vector field, path of the two parameters and the orbit's equations.
    kind : CycleKind
        How V meets its start, and whether there is a beta.
    at : Collocated
        The orbit.
    reference : Reference
        Scales and phase.
    norms : array (k, N, m, n)
        Functions that V is normalised against, at the Gauss points, over the scales.
    unknowns : pair of array
        V (k, N, m, n) at the nodes, and u.
    """

    def __init__(
        self,
        right: tuple[VectorField, ParameterPath, Equations],
        kind: CycleKind,
        at: Collocated,
        reference: Reference,
        norms: Array,
        unknowns: tuple[Array, Array],
    ) -> None:
        self._field, self._path, self._equations = right
        self._kind, self._at, self._reference, self._norms = kind, at, reference, norms
        self._functions, self._further = unknowns
        self._gauss = at.curve.gauss
        self._widths = at.curve.mesh.widths[:, None, None]
        self._forced = kind.forced(self._further)

    @cached_property
    def jacobians(self) -> Array:
        """f_x at the Gauss points (N, m, n, n)."""
        return self._equations.jacobians(self._at)

    @cached_property
    def border(self) -> Border:
        """The further unknowns' columns and the rows."""
        reference, scales = self._reference, self._reference.scales
        quadrature = self._widths * self._gauss.weights[:, None]
        return self._kind.border(
            forcing=self._widths * self._at.rates / scales,
            starts=self._functions[:, 0, 0] / scales,
            phase=reference.weights * scales,
            norms=quadrature * self._norms,
        )

    def closed(self, functions: Array, further: Array | None = None) -> Array:
        """Return functions (k, N, m, n) with their ends (k, N, m + 1, n).

        The last interval ends with V(0) C, to which `further` adds what a change of u does.
        """
        last = np.roll(functions[:, :, :1], -1, axis=1)
        last[:, -1, 0] = self._kind.twist(self._further) @ functions[:, 0, 0]
        if further is not None:
            closing = self.border.closing * self._reference.scales
            last[:, -1, 0] += np.tensordot(further, closing, 1)
        return np.concatenate((functions, last), axis=2)

    def stages(self, functions: Array, further: Array | None = None) -> Array:
        """Return the values (k, N, m, n) of functions at the Gauss points."""
        return np.asarray(self._gauss.values @ self.closed(functions, further))

    def defects(self) -> tuple[Array, Array]:
        """Return the defects (k, N, m, n) and the conditions' values, both over the scales."""
        closed, scales = self.closed(self._functions), self._reference.scales
        defects = self.linear(closed) - self._forced * self._widths * self._at.rates
        conditions = self.conditions(closed)
        conditions[-1] -= 1.0
        return np.asarray(defects / scales), conditions

    def terms(self) -> tuple[Array, Array]:
        """Return the sizes of the terms that `defects` are made of."""
        closed, scales, g = (
            np.abs(self.closed(self._functions)),
            self._reference.scales,
            self._gauss,
        )
        values = abs(g.values) @ closed
        sizes = abs(g.slopes) @ closed
        moved = np.einsum("Njab,kNjb->kNja", np.abs(self.jacobians), values)
        sizes += self._at.tau[:, None, None] * moved
        sizes += abs(self._forced) * self._widths * np.abs(self._at.rates)
        conditions = np.tensordot(np.abs(self.border.rows), values / scales, 4)
        return np.asarray(sizes / scales), np.asarray(conditions)

    def conditions(self, closed: Array) -> Array:
        """Return the rows' products with functions (k, N, m + 1, n)."""
        stages = (self._gauss.values @ closed) / self._reference.scales
        return np.asarray(np.tensordot(self.border.rows, stages, 4))

    def linear(self, closed: Array) -> Array:
        """Return V' - tau f_x V at the Gauss points (k, N, m, n) from values at all nodes."""
        g = self._gauss
        moved = np.einsum("Njab,kNjb->kNja", self.jacobians, g.values @ closed)
        return np.asarray(g.slopes @ closed - self._at.tau[:, None, None] * moved)

    def turned(self, moves: Array, unknowns: Array) -> Array:
        """Return how the equations change when the orbit moves.

        Parameters
        ----------
        moves : array (q, N, m, n)
            Changes of the orbit at the Gauss points.
        unknowns : array (q, 3)
            Changes of period and parameters.

        Returns
        -------
        array (q, k, N, m, n)
            Derivatives of V' - tau f_x V - beta w f.
        """
        at, count = self._at, len(moves)
        p, period = self._path.vector(at.active), at.period
        x = _columns(at.curve.stages())
        functions = self.stages(self._functions)
        rates = np.einsum("Njab,kNjb->kNja", self.jacobians, functions)
        turned = np.empty((count, *functions.shape))
        for k, function in enumerate(functions):
            v = _columns(function)
            bent = self._field.f_xx_along(
                np.tile(x, (1, count)), p, np.tile(v, (1, count)), _columns(moves)
            )
            change = period * _rows(np.asarray(bent), moves.shape)
            change += unknowns[:, 0, None, None, None] * rates[k]
            for i in range(2):
                dp = self._path.direction(at.active, i)
                moved = _rows(np.asarray(self._field.f_xp_along(x, p, v, dp)), function.shape)
                change += period * unknowns[:, 1 + i, None, None, None] * moved
            turned[:, k] = -self._widths * change
        if self._forced:
            columns = self._equations.columns(at)[1:] / at.tau[:, None, None]
            change = np.einsum("Njab,qNjb->qNja", self.jacobians, moves)
            change += np.tensordot(unknowns[:, 1:], columns, 1)
            turned[:, 0] -= self._forced * self._widths * change
        return turned


def around(nodes: Array, values: Array) -> Array:
    """Return periodic functions (..., N, m, n) at the Gauss points from values at the nodes."""
    last = np.roll(nodes[..., :1, :], -1, axis=-3)
    return np.asarray(values @ np.concatenate((nodes, last), axis=-2))


def _columns(values: Array) -> Array:
    """Return (..., n) as (n, N)."""
    return np.ascontiguousarray(values.reshape(-1, values.shape[-1]).T)


def _rows(values: Array, shape: tuple[int, ...]) -> Array:
    """Return (n, N) as (..., n)."""
    return np.ascontiguousarray(values.T).reshape(shape)
