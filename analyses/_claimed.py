"""What the paper says is stable and what shimmies, as data, and for which stiffness it is so.

The paper does not give C_s. A statement "stable under these conditions" or "shimmy under those"
holds for some stiffnesses and not for others; one that places a boundary asks for both, one on
either side of it, as far from it as the printed digits leave open. Figures 9 to 14 are at 20 m/s
where the paper gives a speed at all (9 and 13); 10, 11, 12 and 14 are taken so too.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:  # the folder is no package; the shelf finds its files in every installation
    from collections.abc import Mapping, Sequence

    from analyses._stability import Course, courses
    from analyses._stability_search import SPAN, Array
else:
    from racs_bif.shelf.analyses._stability import courses
    from racs_bif.shelf.analyses._stability_search import SPAN

Intervals = tuple[tuple[float, float], ...]
"""Stiffnesses [N/rad], in order and apart."""
Key = tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class Need:
    """Under a condition straight running is ``stable``, or there is ``shimmy``."""

    condition: Mapping[str, float]
    state: str


@dataclass(frozen=True)
class Reading:
    """One way to understand a statement.

    Parameters
    ----------
    needs : tuple of Need
        All have to be.
    label : str
        What tells this reading from others, if there are any.
    boundary : dict of str to float, optional
        The condition under which the statement has a Hopf point.
    """

    needs: tuple[Need, ...]
    label: str = ""
    boundary: Mapping[str, float] | None = None


@dataclass(frozen=True)
class Statement:
    """A statement of the paper about stability.

    Parameters
    ----------
    key : str
        The figure, ``fig03``.
    place : str
        The place in the paper.
    short : str
        What it says, for a table or a picture.
    readings : tuple of Reading
        One of them has to hold.
    """

    key: str
    place: str
    short: str
    readings: tuple[Reading, ...]


def _edge(
    parameter: str,
    value: float,
    digits: float,
    first: str,
    second: str,
    label: str = "",
    **others: float,
) -> Reading:
    """Return what a boundary asks for: one state below a parameter's value, another above it."""
    below, above = value - digits, value + digits
    needs = (Need({**others, parameter: below}, first), Need({**others, parameter: above}, second))
    return Reading(needs, label, {**others, parameter: value})


def _one(state: str, **condition: float) -> tuple[Reading, ...]:
    return (Reading((Need(condition, state),)),)


STATEMENTS: Final = (
    Statement(
        "fig03",
        "section 3, Fig. 3",
        "Hopf at u = 10.2 m/s",
        (_edge("u", 10.2, 0.05, "stable", "shimmy"),),
    ),
    Statement("fig04", "section 3, Figs 4, 6(a)", "stable at u = 10", _one("stable", u=10.0)),
    Statement("fig05", "section 3, Figs 5, 6(b)", "shimmy at u = 20", _one("shimmy", u=20.0)),
    Statement(
        "fig07",
        "section 4.1, Fig. 7",
        "stable at alpha = 0.3, shimmy at 0.4, 0.5",
        (
            Reading(
                (
                    Need({"u": 20.0, "alpha": 0.3}, "stable"),
                    Need({"u": 20.0, "alpha": 0.4}, "shimmy"),
                    Need({"u": 20.0, "alpha": 0.5}, "shimmy"),
                )
            ),
        ),
    ),
    Statement(
        "fig09",
        "section 4.2, Fig. 9",
        "Hopf at c = 0.15 m",
        (_edge("c", 0.15, 0.005, "stable", "shimmy", u=20.0),),
    ),
    Statement(
        "fig10",
        "section 4.2, Fig. 10(a)",
        "Hopf at m_c = 160 kg",
        tuple(
            _edge("m_c", 160.0, 5.0, "shimmy", "stable", f"c = {c:g}", u=20.0, c=c)
            for c in (0.15, 0.2, 0.3)
        ),
    ),
    Statement(
        "fig11a", "section 4.2, Fig. 11(a)", "shimmy at c = 0.2", _one("shimmy", u=20.0, c=0.2)
    ),
    Statement(
        "fig11b", "section 4.2, Fig. 11(b)", "unstable at c = 0.3", _one("shimmy", u=20.0, c=0.3)
    ),
    Statement(
        "fig12",
        "section 4.2, Fig. 12",
        "shimmy at m_c = 30, c = 0.2",
        _one("shimmy", u=20.0, c=0.2, m_c=30.0),
    ),
    Statement(
        "fig13",
        "section 4.3, Fig. 13",
        "Hopf at delta_f = 0.08",
        (_edge("delta_f", 0.08, 0.005, "shimmy", "stable", u=20.0),),
    ),
    Statement(
        "fig14a",
        "section 4.3, Fig. 14(a)",
        "shimmy at delta_f = 0.04",
        _one("shimmy", u=20.0, delta_f=0.04),
    ),
    Statement(
        "fig14b",
        "section 4.3, Fig. 14(b)",
        "stable at delta_f = 0.12",
        _one("stable", u=20.0, delta_f=0.12),
    ),
)


def key_of(condition: Mapping[str, float]) -> Key:
    """Return a condition as a key; the same condition gives the same key."""
    return tuple(sorted((name, float(value)) for name, value in condition.items()))


@dataclass(frozen=True)
class Found:
    """For which stiffnesses a reading holds.

    Parameters
    ----------
    reading : Reading
        The reading.
    holds : Intervals
        Where it does.
    hopf : tuple of float
        Stiffnesses [N/rad] with a Hopf point exactly under its boundary condition.
    omega : tuple of float
        Their frequencies [rad/s].
    """

    reading: Reading
    holds: Intervals
    hopf: tuple[float, ...]
    omega: tuple[float, ...]


def find(
    variant: str, statements: Sequence[Statement], resolution: int
) -> tuple[tuple[Found, ...], ...]:
    """Find out for which stiffnesses statements hold.

    Parameters
    ----------
    variant : str
        Variant of the vehicle.
    statements : sequence of Statement
        They are looked into together.
    resolution : int
        As in `_stability.courses`.

    Returns
    -------
    tuple of tuple of Found
        For each statement, for each reading.
    """
    conditions = [condition for each in statements for condition in conditions_of(each)]
    found = courses(variant, conditions, resolution)
    by_key = {key_of(c): course for c, course in zip(conditions, found, strict=True)}
    return tuple(
        tuple(judge(reading, by_key) for reading in statement.readings) for statement in statements
    )


def conditions_of(statement: Statement) -> list[Mapping[str, float]]:
    """Return all conditions that a statement is about."""
    found = [need.condition for reading in statement.readings for need in reading.needs]
    return found + [reading.boundary for reading in statement.readings if reading.boundary]


def judge(reading: Reading, by_key: Mapping[Key, Course]) -> Found:
    """Find out for which stiffnesses a reading holds, from what is known of its conditions."""
    sets = [by_key[key_of(need.condition)].where(need.state) for need in reading.needs]
    hopf = by_key[key_of(reading.boundary)].hopf if reading.boundary else ()
    return Found(
        reading, common(*sets), tuple(h.stiffness for h in hopf), tuple(h.omega for h in hopf)
    )


def holds(found: Sequence[Found]) -> Intervals:
    """Return the stiffnesses for which one of a statement's readings holds."""
    return either(*(each.holds for each in found))


def common(*sets: Intervals) -> Intervals:
    """Return what lies in all of some sets."""
    left = sets[0]
    for right in sets[1:]:
        pairs = ((max(a[0], b[0]), min(a[1], b[1])) for a, b in product(left, right))
        left = tuple(sorted(pair for pair in pairs if pair[0] < pair[1]))
    return left


def either(*sets: Intervals) -> Intervals:
    """Return what lies in one of some sets at least."""
    merged: list[tuple[float, float]] = []
    for low, high in sorted(pair for one in sets for pair in one):
        if merged and low <= merged[-1][1]:
            merged[-1] = (merged[-1][0], max(merged[-1][1], high))
        else:
            merged.append((low, high))
    return tuple(merged)


def within(value: float, where: Intervals) -> bool:
    """Tell whether a stiffness lies in a set."""
    return any(low <= value <= high for low, high in where)


def distance(stiffness: Array, where: Intervals) -> Array:
    """Return how far stiffnesses (n,) are from a set, in log C_s; infinite where it is empty."""
    x = np.log(stiffness)
    apart = [np.maximum(np.maximum(np.log(low) - x, x - np.log(high)), 0.0) for low, high in where]
    nearest: Array = np.min([np.full(len(x), np.inf), *apart], axis=0)
    return nearest


def describe(sets: Intervals) -> str:
    """Write a set of stiffnesses; what reaches an end of the search is open there."""
    words = []
    for low, high in sets:
        if low <= SPAN[0] and high >= SPAN[1]:
            words.append("all")
        elif low <= SPAN[0]:
            words.append(f"below {high:.0f}")
        elif high >= SPAN[1]:
            words.append(f"above {low:.0f}")
        else:
            words.append(f"{low:.0f} to {high:.0f}")
    return ", ".join(words) or "none"
