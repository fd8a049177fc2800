"""Unstable roots of many exact equilibria of one system, counted together."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.charts.counting import UNKNOWN, count_right
from racs_bif.charts.members import Members
from racs_bif.charts.sums import LARGEST, expand

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.fractional.system import System
    from racs_bif.symbolic.field import Array

_TOGETHER: Final = 512


def count_along(system: System, X: Array, P: Array) -> NDArray[np.int64]:
    """Return the numbers of unstable roots at many equilibria.

    Parameters
    ----------
    system : System
        Their system.
    X : array (size, N)
        States and outputs of elements near the exact equilibria.
    P : array (np, N)
        Base parameters.

    Returns
    -------
    int array (N,)
        -1 where Newton's method does not contract at once to an equilibrium, where its roots cannot
        be counted, and throughout where the model is too large for all its minors.
    """
    members, unstable = Members(system), np.full(X.shape[1], UNKNOWN)
    if members.size > LARGEST:
        return unstable
    for k in range(0, X.shape[1], _TOGETHER):
        part = slice(k, k + _TOGETHER)
        at, found, _ = members.newton(X[:, part], P[:, part])
        at, there = at[:, found], P[:, part][:, found]
        if at.shape[1]:
            sums = expand(members.core(at, there), members.laws(there))
            unstable[part][found] = count_right(sums).unstable
    return unstable
