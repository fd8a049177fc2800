"""Stretches of a branch between which its stability changes."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

from racs_bif.results.special import OPERATING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from racs_bif.results.branch import Branch

_UNKNOWN = -1
_ROUNDING = 1e-12
_SHALLOW = 1e-3


@dataclass(frozen=True)
class Stretch:
    """Points `first` to `last` of a branch, both included, with `unstable` unstable roots.

    Consecutive stretches share a point, so that nothing is missing between them.
    """

    first: int
    last: int
    unstable: int

    @property
    def kind(self) -> str:
        """``"stable"``, ``"unstable"`` or ``"unknown"``."""
        if self.unstable == _UNKNOWN:
            return "unknown"
        return "unstable" if self.unstable else "stable"


def stretches(branch: Branch) -> list[Stretch]:
    """Return the stretches of a branch on which the number of unstable roots is the same.

    A special point lies between two stretches and belongs to both: what holds between it and its
    neighbour is the neighbour's stability. Between two ordinary points that differ, nothing was
    located, and the larger number is taken.
    """
    found: list[Stretch] = []
    for k in range(len(branch) - 1):
        unstable = _between(branch, k)
        if found and found[-1].unstable == unstable:
            found[-1] = Stretch(found[-1].first, k + 1, unstable)
        else:
            found.append(Stretch(k, k + 1, unstable))
    return found


def merged(parts: list[Stretch]) -> list[Stretch]:
    """Join neighbours that are both stable or both unstable; the larger number is kept."""
    found: list[Stretch] = []
    for part in parts:
        if found and found[-1].kind == part.kind:
            worst = max(found[-1].unstable, part.unstable)
            found[-1] = Stretch(found[-1].first, part.last, worst)
        else:
            found.append(part)
    return found


def describe_stability(branch: Branch) -> str:
    """Return a line such as ``"stable 5 to 10.2, unstable (2) 10.2 to 30"``.

    It runs along the branch, from the end with the lower value of the active parameter. A stretch
    on which the parameter turns back says how far it goes: ``"stable 24.737 to 1 to 24.737"``.
    """
    values = branch.parameter
    parts = [(_waypoints(values[part.first : part.last + 1]), part) for part in stretches(branch)]
    if len(branch) and values[-1] < values[0]:
        parts = [(way[::-1], part) for way, part in reversed(parts)]
    tiny = _ROUNDING * float(abs(values).max(initial=0.0))
    ways = [[0.0 if abs(value) <= tiny else value for value in way] for way, _ in parts]
    digits = _digits(ways, tiny)
    words = []
    for way, (_, part) in zip(ways, parts, strict=True):
        count = f" ({part.unstable})" if part.kind == "unstable" else ""
        words.append(f"{part.kind}{count} {' to '.join(f'{value:.{digits}g}' for value in way)}")
    return ", ".join(words)


def _waypoints(values: NDArray[np.float64]) -> list[float]:
    """Return the ends of a stretch, and between them how far out it goes if it turns back."""
    start, end = float(values[0]), float(values[-1])
    least, most = float(values.min()), float(values.max())
    shallow = _SHALLOW * (most - least)
    out = [
        (int(places.argmax()), value)
        for places, value in ((values == least, least), (values == most, most))
        if min(abs(value - start), abs(value - end)) > shallow
    ]
    return [start, *(value for _, value in sorted(out)), end]


def _digits(ways: list[list[float]], tiny: float) -> int:
    """Return how many digits it takes to tell the ends of every stretch apart, at least five."""
    pairs = [pair for way in ways for pair in pairwise(way) if abs(pair[0] - pair[1]) > tiny]
    for digits in range(5, 17):
        if all(f"{start:.{digits}g}" != f"{end:.{digits}g}" for start, end in pairs):
            return digits
    return 17


def _between(branch: Branch, k: int) -> int:
    here, there = int(branch.unstable[k]), int(branch.unstable[k + 1])
    if here == there:
        return here
    if _is_special(branch.labels[k]) != _is_special(branch.labels[k + 1]):
        return there if _is_special(branch.labels[k]) else here
    return _UNKNOWN if _UNKNOWN in (here, there) else max(here, there)


def _is_special(label: str) -> bool:
    return bool(label) and label not in OPERATING
