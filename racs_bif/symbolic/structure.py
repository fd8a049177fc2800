"""Jacobians most of whose entries do not depend on the state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Structure:
    """The Jacobian f_x = constant + left V(x) right at one parameter vector.

    Attributes
    ----------
    constant : array (n, n)
        What does not depend on the state.
    left : array (n, k)
    right : array (r, n)
        Where the entries that vary act, and on what.
    varying : callable
        Maps states (n, N) to V (N, k, r).
    """

    constant: Array
    left: Array
    right: Array
    varying: Callable[[Array], Array]

    @property
    def rank(self) -> int:
        """The number k of rows that vary."""
        return int(self.left.shape[1])
