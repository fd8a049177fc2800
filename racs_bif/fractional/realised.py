"""The ordinary differential equation of a model whose elements are realised by filters."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.fractional.bank import Bank, Frame, diagonal
from racs_bif.fractional.laws import Law, read_direction, read_numbers
from racs_bif.symbolic.field import Array, VectorField, Vectors
from racs_bif.symbolic.structure import Structure

if TYPE_CHECKING:
    from racs_bif.fractional.filter import Filter, Realisation
    from racs_bif.symbolic.compiled import CompiledModel
    from racs_bif.symbolic.jets import Algebra, Coefficients


_FEW = 6
"""Up to so many directions are faster one by one, on floats, than at once, on arrays."""


class RealisedField(VectorField):
    """The vector field of a compiled model; its states are (y, z), z the memory of the filters.

    Parameters
    ----------
    compiled : CompiledModel
        The model.
    realisation : Realisation
        What replaces each element's law. Not used by a model without elements.
    """

    def __init__(self, compiled: CompiledModel, realisation: Realisation) -> None:
        self.compiled = compiled
        self.realisation = realisation
        self.parameters = tuple(p.name for p in compiled.parameters)
        self._ny = len(compiled.states)
        self._ne = len(compiled.elements)
        self.stateless = not compiled.states
        self._key: bytes | None = None
        self._kept: Frame | None = None
        self._slopes: dict[bytes, tuple[Filter, ...] | None] = {}
        self._names: tuple[str, ...] | None = None

    @property
    def states(self) -> tuple[str, ...]:  # type: ignore[override]
        """Names of the model's states and of the memory states, ``memory_of_OUTPUT_k``."""
        if self._names is None:
            given = [p.default for p in self.compiled.parameters]
            defaults = np.array([x if isinstance(x, float) else 1.0 for x in given])
            memory = [
                f"memory_of_{law.name}_{k + 1}"
                for law in self.laws(defaults)
                for k in range(len(self.realisation.realise(law).B))
            ]
            self._names = (*self.compiled.states, *memory)
        return self._names

    def laws(self, p: Array) -> tuple[Law, ...]:
        """Return the laws of all elements at base parameters p (np,)."""
        if not self._ne:
            return ()
        numbers = self.compiled.kernel("laws")(self.compiled.padded(p))
        laws, start = [], 0
        meta = self.compiled.meta["law_sizes"]
        for name, through, (a, b) in zip(
            self.compiled.elements, self.compiled.feedthrough, meta, strict=True
        ):
            stop = start + 2 * (a + b)
            laws.append(read_numbers(name, numbers[start:stop], (a, b), feedthrough=through))
            start = stop
        return tuple(laws)

    def law_directions(self, p: Array, dp: Array) -> tuple[Law, ...] | None:
        """Return the derivatives of all laws along dp, None if no law moves."""
        if not self._ne:
            return None
        padded = self.compiled.padded
        slopes = self.compiled.kernel("laws_p")(padded(p), padded(dp))
        if not slopes.any():
            return None
        numbers = self.compiled.kernel("laws")(padded(p))
        directions, start = [], 0
        for law, (a, b) in zip(self.laws(p), self.compiled.meta["law_sizes"], strict=True):
            part = slice(start, start + 2 * (a + b))
            directions.append(read_direction(numbers[part], slopes[part], (a, b), law))
            start = part.stop
        return tuple(directions)

    def frame(self, p: Array) -> Frame:
        """Return what depends on parameters only, kept from call to call."""
        p = np.ascontiguousarray(p, dtype=float)
        key = p.tobytes()
        if self._kept is None or key != self._key:
            self._kept = self._make_frame(p)
            self._key = key
        return self._kept

    def _make_frame(self, p: Array) -> Frame:
        laws = self.laws(p)
        kept = self._kept
        if kept is not None and all(map(_same_law, laws, kept.laws)):
            bank = kept.bank
        else:
            bank = Bank.of(tuple(self.realisation.realise(law) for law in laws), self._ny)
        P = np.concatenate([p, [f.D for f in bank.filters]])
        return Frame(P, laws, bank, self.compiled)

    def core_point(self, x: Array, p: Array) -> Array:
        """Return X = (y, zeta) of states x, shaped (ny + ne,) or (ny + ne, N)."""
        return x if not self._ne else self.frame(p).bank.gather(x)

    def f(self, x: Array, p: Array) -> Array:
        """Return the right-hand side, shaped like `x`."""
        frame = self.frame(p)
        if not self._ne:
            return self.compiled.core(x, frame.P)
        bank = frame.bank
        value = bank.spread(self.compiled.core(bank.gather(x), frame.P))
        value[self._ny :] += frame.bank.A @ x[self._ny :]
        return value

    def f_x(self, x: Array, p: Array) -> Array:
        """Return the Jacobian, (n, n) for one point or (N, n, n) for N points."""
        frame = self.frame(p)
        if not self._ne:
            return self.compiled.core_jacobian(x, frame.P)
        rows, columns = self.compiled.varying_at
        bank = frame.bank
        values = self.compiled.varying_jacobian(bank.gather(x), frame.P)
        size = self.compiled.size
        if x.ndim == 1:
            varying = np.zeros((size, size))
            varying[rows, columns] = values
        else:
            varying = np.zeros((x.shape[1], size, size))
            varying[:, rows, columns] = values.T
        return np.asarray(frame.fixed + bank.left @ varying @ bank.right)

    def f_x_sparse(self, x: Array, p: Array) -> Any:  # noqa: ANN401 - scipy has no types
        """Return the Jacobian (n, n) at one point as a scipy.sparse.csc_array."""
        frame = self.frame(p)
        core = self.compiled.core_jacobian_sparse(frame.bank.gather(x), frame.P)
        return frame.bank.around(core) if self._ne else core

    def structure(self, p: Array) -> Structure:
        """Return the Jacobian's constant part and where it varies; see `Structure`."""
        frame, compiled = self.frame(p), self.compiled
        rows, columns = compiled.varying_at
        varying_rows, row = np.unique(rows, return_inverse=True)
        varying_columns, column = np.unique(columns, return_inverse=True)

        def varying(x: Array) -> Array:
            values = compiled.varying_jacobian(frame.bank.gather(x), frame.P)
            out = np.zeros((x.shape[1], len(varying_rows), len(varying_columns)))
            out[:, row, column] = values.T
            return out

        return Structure(
            constant=frame.fixed,
            left=frame.bank.left[:, varying_rows],
            right=frame.bank.right[varying_columns],
            varying=varying,
        )

    def f_p(self, x: Array, p: Array, dp: Array) -> Array:
        """Return the derivative of f along `dp`, shaped like `x`."""
        frame, slopes = self.frame(p), self._filter_slopes(p, dp)
        X, dP = frame.bank.gather(x), self._full_direction(dp, slopes)
        value = self.compiled.core_p(X, frame.P, dP)
        if slopes is None:
            return frame.bank.spread(value)
        z = x[self._ny :]
        memory = diagonal([s.C[None, :] for s in slopes]) @ z
        jacobian = self.compiled.core_jacobian(X, frame.P)[..., self._ny :]
        through = jacobian @ memory if x.ndim == 1 else np.einsum("Nij,jN->iN", jacobian, memory)
        result = frame.bank.spread(value + through)
        e = self.compiled.core(X, frame.P)[self._ny :]
        result[self._ny :] += diagonal([s.A for s in slopes]) @ z
        result[self._ny :] += diagonal([s.B[:, None] for s in slopes]) @ e
        return np.asarray(result)

    def f_xx(self, x: Array, p: Array, u: Vectors, v: Vectors) -> Vectors:
        """Return the bilinear form B(u, v) at one point, shaped like the directions."""
        frame = self.frame(p)
        R = frame.bank.gather
        return frame.bank.spread(self.compiled.core_xx(R(x), frame.P, R(u), R(v)))

    def f_xx_matrices(self, x: Array, p: Array, v: Vectors) -> Vectors:
        """Return the derivatives of f_x v by x for directions v (n, k), as (k, n, n)."""
        frame = self.frame(p)
        R, size, count = frame.bank.right, self.compiled.size, v.shape[1]
        V, directions = np.repeat(R @ v, size, axis=1), np.tile(np.eye(size), (1, count))
        forms = self.compiled.core_xx(R @ x, frame.P, V, directions)
        core = forms.reshape(size, count, size).transpose(1, 0, 2)
        return np.asarray(frame.bank.left @ core @ R)

    def telling(self, x: Array, p: Array, v: Vectors, own: int) -> Vectors:
        """Return the part of a direction (n,) that counts: states, or outputs where there are none.

        In a model that is made of elements only their outputs are what states are elsewhere.
        """
        return self.outputs_along(x, p, v) if self.stateless else v[:own]

    def own_outputs(self, x: Array, p: Array) -> dict[str, Array]:
        """Return the outputs of all elements at N points x (n, N), each (N,), by name."""
        return dict(zip(self.compiled.elements, self.outputs(x, p), strict=True))

    def outputs_along(self, x: Array, p: Array, v: Vectors) -> Vectors:
        """Return the derivatives (ne,) of the elements' outputs along v (n,) at one point."""
        frame, ny = self.frame(p), self._ny
        V = frame.bank.gather(v)
        jacobian = self.compiled.core_jacobian(frame.bank.gather(x), frame.P)
        return np.asarray(V[ny:] + frame.P[len(p) :] * (jacobian @ V)[ny:])

    def outputs(self, x: Array, p: Array) -> Array:
        """Return the elements' outputs (ne,) of states (n,), or (ne, N) of states (n, N)."""
        frame, ny = self.frame(p), self._ny
        X = frame.bank.gather(x)
        through = (frame.P[len(p) :] * self.compiled.core(X, frame.P)[ny:].T).T
        return np.asarray(X[ny:] + through)

    def series(self, x: Coefficients, p: Array, algebra: Algebra) -> Coefficients:
        """Return the Taylor coefficients (n, len(algebra)) of f at a polynomial x of that shape."""
        frame = self.frame(p)
        bank = frame.bank
        value = bank.spread(self.compiled.expand("core", algebra, frame.P, bank.gather(x)))
        value[self._ny :] += frame.bank.A @ x[self._ny :]
        return value

    def f_xxx(self, x: Array, p: Array, u: Vectors, v: Vectors, w: Vectors) -> Vectors:
        """Return the trilinear form C(u, v, w) at one point, shaped like the directions."""
        frame = self.frame(p)
        R = frame.bank.gather
        return frame.bank.spread(self.compiled.core_xxx(R(x), frame.P, R(u), R(v), R(w)))

    def f_xp(self, x: Array, p: Array, v: Vectors, dp: Array) -> Vectors:
        """Return the derivative of f_x v along `dp` at one point."""
        frame, slopes = self.frame(p), self._filter_slopes(p, dp)
        R, core = frame.bank.gather, self.compiled
        X, V, dP = R(x), R(v), self._full_direction(dp, slopes)
        if v.ndim == 2 and v.shape[1] <= _FEW:
            value = np.column_stack([core.core_xp(X, frame.P, column, dP) for column in V.T])
        else:
            value = core.core_xp(X, frame.P, V, _like(dP, v))
        if slopes is None:
            return frame.bank.spread(value)
        C_p = diagonal([s.C[None, :] for s in slopes])
        jacobian = core.core_jacobian(X, frame.P)
        moved = np.zeros_like(X)
        moved[self._ny :] = C_p @ x[self._ny :]
        value = value + core.core_xx(X, frame.P, V, _like(moved, v))
        value = value + jacobian[:, self._ny :] @ (C_p @ v[self._ny :])
        result = frame.bank.spread(value)
        result[self._ny :] += diagonal([s.A for s in slopes]) @ v[self._ny :]
        result[self._ny :] += diagonal([s.B[:, None] for s in slopes]) @ (jacobian @ V)[self._ny :]
        return np.asarray(result)

    def f_xx_along(self, x: Array, p: Array, u: Vectors, v: Vectors) -> Vectors:
        """Return B(u, v) at N points x (n, N), one pair of directions (n, N) for each, (n, N)."""
        return self.f_xx(x, p, u, v)

    def f_xxx_along(self, x: Array, p: Array, u: Vectors, v: Vectors, w: Vectors) -> Vectors:
        """Return C(u, v, w) at N points x (n, N), three directions (n, N) for each, (n, N)."""
        return self.f_xxx(x, p, u, v, w)

    def f_xp_along(self, x: Array, p: Array, v: Vectors, dp: Array) -> Vectors:
        """Return `f_xp` at N points x (n, N), one direction v (n, N) for each, as (n, N)."""
        frame, slopes, core, ny = self.frame(p), self._filter_slopes(p, dp), self.compiled, self._ny
        R = frame.bank.gather
        X, V = R(x), R(v)
        value = core.core_xp(X, frame.P, V, _like(self._full_direction(dp, slopes), v))
        if slopes is None:
            return frame.bank.spread(value)
        C_p = diagonal([s.C[None, :] for s in slopes])
        jacobians = core.core_jacobian(X, frame.P)
        moved = np.zeros_like(X)
        moved[ny:] = C_p @ x[ny:]
        value = value + core.core_xx(X, frame.P, V, moved)
        value = value + np.einsum("Nij,jN->iN", jacobians[:, :, ny:], C_p @ v[ny:])
        result = frame.bank.spread(value)
        result[ny:] += diagonal([s.A for s in slopes]) @ v[ny:]
        inputs = np.einsum("Nij,jN->iN", jacobians[:, ny:], V)
        result[ny:] += diagonal([s.B[:, None] for s in slopes]) @ inputs
        return np.asarray(result)

    def _filter_slopes(self, p: Array, dp: Array) -> tuple[Filter, ...] | None:
        if not self._ne:
            return None
        key = p.tobytes() + dp.tobytes()
        if key not in self._slopes:
            slopes = None
            directions = self.law_directions(p, dp)
            if directions is not None:
                pairs = zip(self.frame(p).laws, directions, strict=True)
                slopes = tuple(self.realisation.derivative(law, moved) for law, moved in pairs)
            # Two active parameters at a time ask for theirs again and again.
            kept = list(self._slopes.items())[-1:]
            self._slopes = dict([*kept, (key, slopes)])
        return self._slopes[key]

    def _full_direction(self, dp: Array, slopes: tuple[Filter, ...] | None) -> Array:
        if slopes is None:
            return self.compiled.padded(dp)
        return np.concatenate([dp, [s.D for s in slopes]])

    def rest(self, y: Array, w: Array, p: Array) -> Array:
        """Return the states (n,) at which model and filters rest.

        Parameters
        ----------
        y : array (ny,)
            The model's states at an exact equilibrium.
        w : array (ne,)
            Outputs of the elements there.
        p : array (np,)
            Base parameters.
        """
        frame = self.frame(p)
        exact = np.concatenate([y, w])
        inputs = self.compiled.core(exact, self.compiled.padded(p))[self._ny :]
        parts = [y]
        for e, output, f in zip(inputs, w, frame.filters, strict=True):
            # The last row fixes the state of an integrator, which A alone leaves free.
            matrix = np.vstack([f.A, f.C])
            right = np.append(-f.B * e, output - f.D * e)
            parts.append(np.linalg.lstsq(matrix, right, rcond=None)[0])
        return np.concatenate(parts)


def _same_law(a: Law, b: Law) -> bool:
    pairs = ((a.numerator, b.numerator), (a.denominator, b.denominator))
    return all(
        np.array_equal(one.coefficients, other.coefficients)
        and np.array_equal(one.exponents, other.exponents)
        for one, other in pairs
    )


def _like(direction: Array, x: Vectors) -> Array:
    """Return a direction with as many columns as `x`."""
    if x.ndim == 1:
        return direction
    return np.broadcast_to(direction[:, None], (len(direction), x.shape[1]))
