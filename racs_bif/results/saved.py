"""Where a point of a file came from: the branch that was saved with it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from racs_bif.results.branch import Branch


@dataclass(frozen=True, eq=False)
class Saved:
    """A point's branch, loaded from a file; the `origin` of its special points.

    Parameters
    ----------
    branch : Branch
        The branch.
    name : str
        The point's name on it, under which its profile is found.
    """

    branch: Branch
    name: str
