"""What a branch is made of: points, special points, and the trace that holds them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from racs_bif.continuation.stopped import Stopped

Array = NDArray[np.float64]
"""Real array."""
Spectrum = NDArray[np.complex128]
"""Eigenvalues or multipliers."""


@dataclass(slots=True, weakref_slot=True)
class Point:
    """One solution on a branch.

    Attributes
    ----------
    z : array (n + 1,)
        The unknowns, the parameter last.
    tangent : array (n + 1,)
        Direction of the branch, of length 1 in the scaled norm when it was computed, pointing along
        the branch.
    spectrum : complex array (m,)
        Eigenvalues or multipliers.
    stable : bool or None
        Whether the solution is stable; None where that is not known.
    unstable : int
        How many eigenvalues are on the unstable side.
    measures : dict
        What is plotted.
    arclength : float
        Scaled length of the branch from its first point.
    iterations : int
        Newton iterations the point took.
    tests : dict
        Values of the test functions by the label of their detector, as the branch was traced.
    label : str
        The special point's label, empty for an ordinary point.
    """

    z: Array
    tangent: Array
    spectrum: Spectrum
    stable: bool | None
    unstable: int
    measures: dict[str, float]
    arclength: float
    iterations: int
    tests: dict[str, float] = field(default_factory=dict)
    label: str = ""

    @property
    def parameter(self) -> float:
        """The value of the continuation parameter."""
        return float(self.z[-1])


@dataclass(slots=True)
class SpecialPoint:
    """An event on a branch.

    Attributes
    ----------
    label : str
        What kind of point it is, "LP" for instance.
    name : str
        The label and the number along the branch, "LP1".
    index : int
        Its place among the points of the trace.
    z, tangent, spectrum
        As of its `Point`.
    data : dict
        What the detector knows about it.
    interval : float
        Width in the parameter of the bracket in which it was located.
    """

    label: str
    name: str
    index: int
    z: Array
    tangent: Array
    spectrum: Spectrum
    data: dict[str, Any]
    interval: float

    @property
    def parameter(self) -> float:
        """The value of the continuation parameter."""
        return float(self.z[-1])


@dataclass(slots=True)
class Trace:
    """A branch as it was traced.

    Attributes
    ----------
    points : list of Point
        In the order along the branch, events among them.
    special : list of SpecialPoint
        The events in the order along the branch.
    stopped : Stopped
        Why the branch ended at its last point.
    stopped_backward : Stopped or None
        Why it ended at its first point; None where that is the start.
    message : str
        What else there is to know, one sentence a line; empty when all went well.
    unexplained : list of (float, float)
        Intervals of the parameter in which no special point explains how the spectrum changes.
    """

    points: list[Point]
    special: list[SpecialPoint]
    stopped: Stopped
    stopped_backward: Stopped | None = None
    message: str = ""
    unexplained: list[tuple[float, float]] = field(default_factory=list)

    def __getitem__(self, name: str) -> SpecialPoint:
        """Return the special point of this name, such as ``"H1"``.

        Raises
        ------
        KeyError
            If there is none of this name; the message lists those there are.
        """
        for special in self.special:
            if special.name == name:
                return special
        known = ", ".join(special.name for special in self.special) or "none"
        msg = f"no special point '{name}' on this branch; there are: {known}"
        raise KeyError(msg)
