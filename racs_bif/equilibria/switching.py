"""The start of the other branch at a branch point."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

    from racs_bif.symbolic.field import Array


def other_branch(z: Array, data: Mapping[str, Any]) -> tuple[Array, Array]:
    """Return a start (n+1,) and a tangent (n+1,) for the branch that crosses at a branch point.

    `racs_bif.continuation.trace` takes both and follows the other branch in both directions.

    Parameters
    ----------
    z : array (n+1,)
        The branch point.
    data : mapping
        What `BranchPoint` found there.
    """
    return np.array(z, dtype=float), np.array(data["other_tangent"], dtype=float)
