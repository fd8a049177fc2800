"""What of a realised model depends on parameters only: its filters and constant derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.errors import ValidityError
from racs_bif.numerics.sparse import LARGE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from racs_bif.fractional.filter import Filter
    from racs_bif.fractional.laws import Law
    from racs_bif.symbolic.compiled import CompiledModel
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True)
class Bank:
    """The filters of all elements: z' = A z + B e, w = C z + D e, with z (nz,), e and w (ne,).

    Parameters
    ----------
    filters : tuple of Filter
        One for each element.
    own : int
        Number ny of the model's own states.
    A, B, C : array (nz, nz), (nz, ne), (ne, nz)
        Block-diagonal.
    """

    filters: tuple[Filter, ...]
    own: int
    A: Array
    B: Array
    C: Array

    @classmethod
    def of(cls, filters: tuple[Filter, ...], own: int) -> Bank:
        """Put filters side by side."""
        A = diagonal([f.A for f in filters])
        B = diagonal([f.B[:, None] for f in filters])
        return cls(filters, own, A, B, diagonal([f.C[None, :] for f in filters]))

    @cached_property
    def left(self) -> Array:
        """diag(1, B), by which `spread` multiplies."""
        return diagonal([np.eye(self.own), self.B])

    @cached_property
    def right(self) -> Array:
        """diag(1, C), by which `gather` multiplies."""
        return diagonal([np.eye(self.own), self.C])

    def spread(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return derivatives (ny + nz,) from what the core returns, (y', e)."""
        if not self.filters:
            return values
        if self.own < LARGE:
            return np.asarray(self.left @ values)
        return np.concatenate((values[: self.own], self.B @ values[self.own :]))

    def gather(self, x: NDArray[Any]) -> NDArray[Any]:
        """Return what the core takes, (y, C z), from states (ny + nz,)."""
        if not self.filters:
            return x
        if len(x) != self.own + len(self.A):
            raise ValidityError(other_size(self.own + len(self.A), len(x)))
        if self.own < LARGE:
            return np.asarray(self.right @ x)
        return np.concatenate((x[: self.own], self.C @ x[self.own :]))

    def around(self, core: Any) -> Any:  # noqa: ANN401 - scipy has no types
        """Return left @ core @ right + diag(0, A) as a sparse array."""
        from scipy.sparse import block_diag, csc_array, eye_array

        eye = eye_array(self.own)
        left, right = block_diag([eye, csc_array(self.B)]), block_diag([eye, csc_array(self.C)])
        still = csc_array((self.own, self.own))
        return csc_array(left @ core @ right + block_diag([still, csc_array(self.A)]))


@dataclass(frozen=True)
class Frame:
    """What depends on parameters only: x' = left @ core(right @ x, P) + (0, A z).

    Parameters
    ----------
    P : array (np + ne,)
        Base parameters and direct feedthroughs.
    laws : tuple of Law
        Laws of the elements.
    bank : Bank
        Their filters, with the matrices `left` and `right`.
    compiled : CompiledModel
        The core.
    """

    P: Array
    laws: tuple[Law, ...]
    bank: Bank
    compiled: CompiledModel

    @property
    def filters(self) -> tuple[Filter, ...]:
        """The filters."""
        return self.bank.filters

    @cached_property
    def fixed(self) -> Array:
        """The entries of f_x that do not depend on the state, (n, n)."""
        bank = self.bank
        fixed = bank.left @ self.compiled.fixed_jacobian(self.P) @ bank.right
        fixed[bank.own :, bank.own :] += bank.A
        return np.asarray(fixed)


def other_size(here: int, before: int) -> str:
    """Say that the filters have become others, as they do where an order passes a whole number."""
    return (
        f"the realised system has {here} states here, not {before} as before, where an order "
        "passes a whole number; narrow the span"
    )


def diagonal(blocks: Sequence[Array]) -> Array:
    """Return the block-diagonal matrix of (possibly empty) blocks."""
    rows = sum(b.shape[0] for b in blocks)
    columns = sum(b.shape[1] for b in blocks)
    out = np.zeros((rows, columns))
    i = j = 0
    for b in blocks:
        out[i : i + b.shape[0], j : j + b.shape[1]] = b
        i, j = i + b.shape[0], j + b.shape[1]
    return out
