"""The mesh of an orbit: steps on [0, 1], gathered in segments of equally many steps."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import UsageError

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True, eq=False)
class Mesh:
    """Steps over one period, in segments that are integrated side by side.

    Parameters
    ----------
    nodes : array (N + 1,)
        Ends of the N steps in units of the period, rising from 0 to 1.
    segments : int
        Number M of segments; N is a multiple of it.

    Raises
    ------
    UsageError
        If the nodes do not rise from 0 to 1, or the steps cannot be shared out evenly.
    """

    nodes: Array
    segments: int

    def __post_init__(self) -> None:
        nodes = self.nodes
        if nodes.ndim != 1 or len(nodes) < 2 or nodes[0] != 0.0 or nodes[-1] != 1.0:
            raise UsageError("the nodes of a mesh must be a list from 0 to 1")
        if not np.all(np.diff(nodes) > 0.0):
            raise UsageError("the nodes of a mesh must rise: two of them coincide or are swapped")
        if self.segments < 1 or (len(nodes) - 1) % self.segments:
            raise UsageError(
                f"{len(nodes) - 1} steps do not share out over {self.segments} segments: "
                "choose a number of steps that is a multiple of the number of segments"
            )

    @classmethod
    def uniform(cls, steps: int, segments: int) -> Mesh:
        """Return equal steps; their number is rounded up to a multiple of the segments."""
        return cls(np.linspace(0.0, 1.0, rounded(steps, segments) + 1), segments)

    @property
    def steps(self) -> int:
        """Number N of steps."""
        return len(self.nodes) - 1

    @property
    def per_segment(self) -> int:
        """Number K of steps in a segment."""
        return self.steps // self.segments

    @cached_property
    def widths(self) -> Array:
        """Widths (N,) of the steps in units of the period."""
        return np.diff(self.nodes)

    @property
    def starts(self) -> Array:
        """Where the segments begin (M,), in units of the period."""
        return self.nodes[: -1 : self.per_segment]

    def times(self, fractions: Array) -> Array:
        """Return the times (N, k) at the given fractions (k,) of every step."""
        return self.nodes[:-1, None] + self.widths[:, None] * fractions

    def dense(self, each: int, fewest: int) -> Array:
        """Return times from 0 to 1, so many in each step, or more that there are the fewest."""
        each = max(each, -(-fewest // self.steps))
        return np.append(self.times(np.arange(each) / each), 1.0)


def rounded(steps: int, segments: int) -> int:
    """Return the number of steps rounded up to a multiple of the segments."""
    return -(-steps // segments) * segments


def equidistributed(mesh: Mesh, errors: Array, order: int, steps: int, segments: int) -> Mesh:
    """Move the nodes so that every step has the same share of the error.

    The error of a step is taken to scale with its width to the power `order`; the density of steps
    is then errors^(1/order) / width (C. de Boor, *Good approximation by splines with variable
    knots*, 1973). The mean density is added to it, so that a quiet stretch still keeps half of the
    steps that a uniform mesh would give it, and a spike cannot take all of them.

    Parameters
    ----------
    mesh : Mesh
        Where the errors were found.
    errors : array (N,)
        Error of each step, not negative.
    order : int
        Power of the width with which the error of a step falls.
    steps, segments : int
        Size of the mesh wanted; the steps are rounded up to a multiple of the segments.

    Returns
    -------
    Mesh
        The new mesh.
    """
    share = np.maximum(errors, 0.0) ** (1.0 / order)
    total = float(share.sum())
    count = rounded(steps, segments)
    if total == 0.0:
        return Mesh.uniform(count, segments)
    share = share / total + mesh.widths
    cumulative = np.concatenate(([0.0], np.cumsum(share)))
    wanted = np.linspace(0.0, cumulative[-1], count + 1)
    nodes = np.interp(wanted, cumulative, mesh.nodes)
    nodes[0], nodes[-1] = 0.0, 1.0
    return Mesh(nodes, segments)
