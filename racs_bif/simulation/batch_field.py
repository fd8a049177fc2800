"""The realised equations of many members, each with its own parameters, at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.simulation.batch_filters import BatchFilters, apply, filters_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.fractional.system import System
    from racs_bif.symbolic.compiled import CompiledModel
    from racs_bif.symbolic.field import Array

_NEWTON = 20
_RESTED = 1e-13
_SINGULAR = 1e-14


class BatchField:
    """x' = rate(x) for M members; x = (y, z), (n, M), with y the model's own states.

    The memory states z are those of `racs_bif.simulation.batch_filters`.

    Parameters
    ----------
    system : System
        The model; its own parameter values are not used.
    P : array (np, M)
        Base parameters.
    filters : BatchFilters, optional
        The members' filters, where they are known already.
    """

    def __init__(self, system: System, P: Array, filters: BatchFilters | None = None) -> None:
        self.system, self.P = system, P
        self.compiled = system.compiled
        self.ny, self.ne = len(self.compiled.states), len(self.compiled.elements)
        self.filters = filters
        if self.ne and filters is None:
            self.filters = filters_of(system.field, P)
        through = np.empty((0, P.shape[1])) if self.filters is None else self.filters.D
        self.padded = np.concatenate([P, through])
        self.core = self.compiled.kernel("core").bind(self.padded)
        self._jacobian = _Jacobian(self.compiled, self.padded)

    @property
    def size(self) -> int:
        """Number n of states of a member."""
        return self.ny + (0 if self.filters is None else len(self.filters.poles))

    def take(self, which: NDArray[np.intp]) -> BatchField:
        """Return the equations of some members."""
        filters = None if self.filters is None else self.filters.take(which)
        return BatchField(self.system, np.ascontiguousarray(self.P[:, which]), filters)

    def gather(self, x: Array) -> Array:
        """Return what the core takes, (y, C z), (ny + ne, M)."""
        if self.filters is None:
            return x
        return np.concatenate([x[: self.ny], apply(self.filters.C, x[self.ny :])])

    def spread(self, values: Array) -> Array:
        """Return (y', B e) (n, M) from what the core returns, (y', e)."""
        if self.filters is None:
            return values
        return np.concatenate([values[: self.ny], apply(self.filters.B, values[self.ny :])])

    def rate(self, x: Array) -> Array:
        """Return x' (n, M)."""
        out = self.spread(self.core(self.gather(x)))
        if self.filters is not None:
            out[self.ny :] += self.filters.drift(x[self.ny :])
        return out

    def moved(self, x: Array, v: Array) -> Array:
        """Return the Jacobian at x times directions v (n, M)."""
        core = self._jacobian(self.gather(x))
        out = self.spread(apply(core, self.gather(v)))
        if self.filters is not None:
            out[self.ny :] += self.filters.drift(v[self.ny :])
        return out

    def linear(self, x: Array, shift: Array) -> BatchLinear:
        """Return the linearisation at x, to solve (shift - Jacobian) k = right with."""
        return BatchLinear(self, self._jacobian(self.gather(x)), shift)

    def from_states(self, states: Array) -> Array:
        """Return x (n, M) from states (n, M) in the order of ``system.field.states``."""
        if self.filters is None or self.filters.turned is None:
            return states.copy()
        turned = np.broadcast_to(
            self.filters.turned, (states.shape[1], *self.filters.turned.shape[1:])
        )
        z = np.linalg.solve(turned, states[self.ny :].T[:, :, None])[:, :, 0].T
        return np.concatenate([states[: self.ny], z])

    def to_states(self, x: Array) -> Array:
        """Return states (n, M) in the order of ``system.field.states`` from x."""
        if self.filters is None or self.filters.turned is None:
            return x.copy()
        return np.concatenate([x[: self.ny], apply(self.filters.turned, x[self.ny :])])

    def at_rest(self, y: Array) -> Array:
        """Return x (n, M) with the filters at rest while the own states y (ny, M) are held.

        An element that integrates is at rest with no output. Where there is no such state it is
        not finite.
        """
        filters = self.filters
        if filters is None:
            return y.copy()
        count = y.shape[1]
        A = filters.matrix
        # z = K e: a filter whose A is singular integrates, and stays where it is.
        K = -np.linalg.pinv(A, rcond=_SINGULAR) @ filters.B
        gain = np.broadcast_to(filters.C @ K, (count, self.ne, self.ne))
        X = np.concatenate([y, np.zeros((self.ne, count))])
        with np.errstate(all="ignore"):
            for _ in range(_NEWTON):
                residual = X[self.ny :] - apply(gain, self.core(X)[self.ny :])
                matrix = np.eye(self.ne) - gain @ self._jacobian(X)[:, self.ny :, self.ny :]
                # One that is not finite must not keep the others from being solved.
                bad = ~np.isfinite(matrix).all(axis=(1, 2))
                matrix[bad] = np.eye(self.ne)
                step = (np.linalg.pinv(matrix) @ residual.T[:, :, None])[:, :, 0].T
                X[self.ny :] -= step
                if not np.any(np.abs(step) > _RESTED * (1.0 + np.abs(X[self.ny :]))):
                    break
            return np.concatenate([y, apply(K, self.core(X)[self.ny :])])


class BatchLinear:
    """(shift - Jacobian) k = right for M members, by eliminating the filters.

    Parameters
    ----------
    field : BatchField
        The equations.
    core : array (M, ny + ne, ny + ne)
        Jacobians of the core.
    shift : array (M,)
        What is added to the diagonal.
    """

    def __init__(self, field: BatchField, core: Array, shift: Array) -> None:
        self.field, self.core, self.filters = field, core, field.filters
        ny = field.ny
        matrix = -core
        matrix[:, range(ny), range(ny)] += shift[:, None]
        if self.filters is not None:
            self.memory = self.filters.resolvent(shift)
            gain = self.memory.gain
            matrix[:, ny:] = -gain @ core[:, ny:]
            places = np.arange(ny, core.shape[1])
            matrix[:, places, places] += 1.0
        bad = ~np.isfinite(matrix).all(axis=(1, 2))
        matrix[bad] = np.eye(matrix.shape[1])
        try:
            inverse = np.linalg.inv(matrix)
        except np.linalg.LinAlgError:
            inverse = np.linalg.pinv(matrix)
        inverse[bad] = np.nan
        self.inverse: Array = np.asarray(inverse, dtype=float)

    def solve(self, right: Array) -> Array:
        """Return k (n, M)."""
        if self.filters is None:
            return apply(self.inverse, right)
        ny = self.field.ny
        still = self.memory(right[ny:])
        known = np.concatenate([right[:ny], apply(self.filters.C, still)])
        found = apply(self.inverse, known)
        driven = apply(self.core[:, ny:], found)
        still += self.memory(apply(self.filters.B, driven))
        return np.concatenate([found[:ny], still])


class _Jacobian:
    """The core's Jacobian (M, size, size) for M parameter sets."""

    def __init__(self, compiled: CompiledModel, padded: Array) -> None:
        size = compiled.size
        fixed = np.array(compiled.meta["fixed"], dtype=int).reshape(-1, 2)
        self.fixed = np.zeros((padded.shape[1], size, size))
        values = compiled.kernel("jacobian_fixed").bind(padded)()
        self.fixed[:, fixed[:, 0], fixed[:, 1]] = values.T
        self.varying = compiled.kernel("jacobian_varying").bind(padded)
        self.rows, self.columns = compiled.varying_at

    def __call__(self, X: Array) -> Array:
        """Return it at what the core takes, (size, M)."""
        out = self.fixed.copy()
        out[:, self.rows, self.columns] = self.varying(X).T
        return out
