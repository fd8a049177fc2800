"""The filters of many members at once, in coordinates in which their poles stand alone."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from racs_bif.fractional.bank import Bank
    from racs_bif.fractional.realised import RealisedField
    from racs_bif.symbolic.field import Array

_FAITHFUL = 1e-9
"""Error of a response that a change of coordinates may cost, relative to the response."""


@dataclass(frozen=True)
class BatchFilters:
    """The filters z' = poles z + coupling z + B e, w = C z + D e of M members, or one for all.

    Parameters
    ----------
    poles : array (nz, M) or (nz, 1)
        The diagonal.
    coupling : array (M, nz, nz) or (1, nz, nz), optional
        The rest of the state matrix, where its poles do not stand alone.
    B : array (M, nz, ne) or (1, nz, ne)
    C : array (M, ne, nz) or (1, ne, nz)
    D : array (ne, M)
    turned : array (M, nz, nz) or (1, nz, nz), optional
        z = turned @ coordinates of the filter, where these are not its own.
    """

    poles: Array
    coupling: Array | None
    B: Array
    C: Array
    D: Array
    turned: Array | None

    def take(self, which: NDArray[np.intp]) -> BatchFilters:
        """Return those of some members."""

        def members(a: Array) -> Array:
            return a if len(a) == 1 else a[which]

        return replace(
            self,
            poles=self.poles if self.poles.shape[1] == 1 else self.poles[:, which],
            coupling=None if self.coupling is None else members(self.coupling),
            B=members(self.B),
            C=members(self.C),
            D=self.D[:, which],
            turned=None if self.turned is None else members(self.turned),
        )

    @property
    def matrix(self) -> Array:
        """State matrices (M, nz, nz) or (1, nz, nz)."""
        A = self.poles.T[:, :, None] * np.eye(len(self.poles))
        return A if self.coupling is None else A + self.coupling

    def drift(self, z: Array) -> Array:
        """Return what the state matrices make of z (nz, M)."""
        out = self.poles * z
        return out if self.coupling is None else out + apply(self.coupling, z)

    def resolvent(self, shift: Array) -> Resolvent:
        """Return (shift - state matrix)**-1 for shifts (M,)."""
        if self.coupling is None:
            single: Array = np.asarray(1.0 / (shift - self.poles), dtype=float)
            if len(self.C) == 1 and len(self.B) == 1:
                weights = np.einsum("ez,zf->efz", self.C[0], self.B[0])
                gain = np.moveaxis(weights @ single, 2, 0)
            else:
                gain = (self.C * single.T[:, None, :]) @ self.B
            return Resolvent(single, np.asarray(gain, dtype=float))
        whole = np.linalg.inv(shift[:, None, None] * np.eye(len(self.poles)) - self.matrix)
        return Resolvent(np.asarray(whole, dtype=float), self.C @ whole @ self.B)


@dataclass(frozen=True)
class Resolvent:
    """(shift - A)**-1 of M filters.

    Parameters
    ----------
    inverse : array (nz, M) or (M, nz, nz)
        Its diagonal, or all of it.
    gain : array (M, ne, ne)
        From inputs to outputs, the feedthrough left out.
    """

    inverse: Array
    gain: Array

    def __call__(self, z: Array) -> Array:
        """Return what it makes of z (nz, M)."""
        return self.inverse * z if self.inverse.ndim == 2 else apply(self.inverse, z)


def apply(matrices: Array, x: Array) -> Array:
    """Return matrices (M, k, n) or (1, k, n) times columns x (n, M)."""
    if len(matrices) == 1:
        return np.asarray(matrices[0] @ x)
    return np.asarray(np.matmul(matrices, x.T[:, :, None])[:, :, 0].T)


def filters_of(field: RealisedField, P: Array) -> BatchFilters:
    """Return the filters at base parameters P (np, M).

    Parameters
    ----------
    field : RealisedField
        The realised model.
    P : array (np, M)
        Base parameters.

    Raises
    ------
    ParameterError
        If a law cannot be realised.
    """
    banks: dict[bytes, int] = {}
    kept: list[Bank] = []
    which = np.zeros(P.shape[1], dtype=np.intp)
    for k, p in enumerate(P.T):
        laws = field.laws(np.ascontiguousarray(p))
        parts = (part for law in laws for part in (law.numerator, law.denominator))
        key = b"".join(q.coefficients.tobytes() + q.exponents.tobytes() for q in parts)
        if key not in banks:
            banks[key] = len(kept)
            kept.append(field.frame(p).bank)
        which[k] = banks[key]
    return _stacked(kept, which)


def _stacked(banks: Sequence[Bank], which: NDArray[np.intp]) -> BatchFilters:
    single = len(banks) == 1
    modal = [_modal(bank) for bank in banks]
    if any(m is None for m in modal):
        # One for all, so that members do not differ in how they are integrated.
        modal = [(np.zeros(len(b.A)), b.A, b.B, b.C, np.eye(len(b.A))) for b in banks]
    rows = [m for m in modal if m is not None]
    poles = np.array([m[0] for m in rows]).T
    coupling, B, C, turned = (np.array([m[k] for m in rows]) for k in range(1, 5))
    D = np.array([[f.D for f in bank.filters] for bank in banks]).T
    own = all(np.array_equal(t, np.eye(len(t))) for t in turned)
    every = slice(None) if single else which
    return BatchFilters(
        poles=poles[:, every],
        coupling=coupling[every] if coupling.any() else None,
        B=B[every],
        C=C[every],
        D=D.reshape(-1, len(banks))[:, which],
        turned=None if own else turned[every],
    )


def _modal(bank: Bank) -> tuple[Array, Array, Array, Array, Array] | None:
    """Return poles, coupling, B, C and coordinates; None where the poles cannot be told apart."""
    n = len(bank.A)
    diagonal = np.diag(bank.A)
    if np.array_equal(bank.A, np.diag(diagonal)):
        return diagonal.copy(), np.zeros((n, n)), bank.B, bank.C, np.eye(n)
    values, vectors = np.linalg.eig(bank.A)
    if np.any(values.imag) or len(set(values.real)) < n:
        return None
    values, vectors = values.real, vectors.real
    try:
        B, C = np.linalg.solve(vectors, bank.B), bank.C @ vectors
    except np.linalg.LinAlgError:
        return None
    sizes = np.abs(values[values != 0.0])
    s = 1j * np.geomspace(sizes.min(), sizes.max(), 60)
    eye = np.eye(n)
    own = bank.C @ np.linalg.solve(s[:, None, None] * eye - bank.A, bank.B.astype(complex))
    new = (C / (s[:, None, None] - values)) @ B
    if not np.all(np.abs(new - own) <= _FAITHFUL * np.abs(own).max(axis=0)):
        return None
    return values, np.zeros((n, n)), B, C, vectors
