"""Stretches of a branch between which its stability changes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from racs_bif.results.special import OPERATING

if TYPE_CHECKING:
    from racs_bif.results.branch import Branch

_UNKNOWN = -1
_ROUNDING = 1e-12


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

    It runs along the branch, from the end with the lower value of the active parameter.
    """
    values = branch.parameter
    parts = [(values[part.first], values[part.last], part) for part in stretches(branch)]
    if len(branch) and values[-1] < values[0]:
        parts = [(end, start, part) for start, end, part in reversed(parts)]
    tiny = _ROUNDING * float(abs(values).max(initial=0.0))
    ends = [[0.0 if abs(end) <= tiny else float(end) for end in part[:2]] for part in parts]
    digits = _digits(ends)
    words = []
    for (start, end), (_, _, part) in zip(ends, parts, strict=True):
        count = f" ({part.unstable})" if part.kind == "unstable" else ""
        words.append(f"{part.kind}{count} {start:.{digits}g} to {end:.{digits}g}")
    return ", ".join(words)


def _digits(ends: list[list[float]]) -> int:
    """Return how many digits it takes to tell the ends of every stretch apart, at least five."""
    for digits in range(5, 17):
        told = [(f"{start:.{digits}g}", f"{end:.{digits}g}", start == end) for start, end in ends]
        if all(first != last or same for first, last, same in told):
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
