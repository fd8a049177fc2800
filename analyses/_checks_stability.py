"""Checks of claims by exact roots: for which C_s is straight running stable, and where it is not.

Also what follows from the equations alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

from racs_bif.fractional.passivity import passivity

if TYPE_CHECKING:  # the folder is no package; the shelf finds its files in every installation
    from collections.abc import Mapping

    from analyses._audit_symbols import state_space_entries
    from analyses._claimed import (
        STATEMENTS,
        Intervals,
        Need,
        Reading,
        common,
        conditions_of,
        describe,
        judge,
    )
    from analyses._ledger import ALWAYS, Bench, Finding
    from analyses._stability_search import SPAN
else:
    from racs_bif.shelf.analyses._audit_symbols import state_space_entries
    from racs_bif.shelf.analyses._claimed import (
        STATEMENTS,
        Need,
        Reading,
        common,
        conditions_of,
        describe,
        judge,
    )
    from racs_bif.shelf.analyses._ledger import ALWAYS, Finding
    from racs_bif.shelf.analyses._stability_search import SPAN


class Plain:
    """A check that says nothing of stability and needs no roots over C_s."""

    def conditions(self) -> tuple[Mapping[str, float], ...]:
        """Return no conditions."""
        return ()

    def readings(self) -> tuple[Reading, ...]:
        """Return no readings."""
        return ()


@dataclass(frozen=True)
class Says:
    """One of the statements of `_claimed`, by its key."""

    key: str

    def conditions(self) -> tuple[Mapping[str, float], ...]:
        """Return the statement's conditions."""
        return tuple(c for s in STATEMENTS if s.key == self.key for c in conditions_of(s))

    def readings(self) -> tuple[Reading, ...]:
        """Return the statement's readings."""
        return next(s.readings for s in STATEMENTS if s.key == self.key)

    def find(self, bench: Bench) -> Finding:
        """Return where the statement holds, and its Hopf points."""
        words = []
        for reading in self.readings():
            found = judge(reading, bench.known)
            label = f"{reading.label}: " if reading.label else ""
            hopf = [
                f"Hopf at C_s = {c:.2f} N/rad ({w:.4f} rad/s)"
                for c, w in zip(found.hopf, found.omega, strict=True)
            ]
            words.append(label + ", ".join([*hopf, f"true for C_s {describe(found.holds)}"]))
        boundary = any(reading.boundary for reading in self.readings())
        return Finding(
            computed="exact Hopf points in C_s" if boundary else "exact root counts over C_s",
            found="; ".join(words),
            where=bench.holds(self.readings()),
        )


@dataclass(frozen=True)
class Needs:
    """Several conditions, each of them stable or with shimmy."""

    needs: tuple[Need, ...]

    def conditions(self) -> tuple[Mapping[str, float], ...]:
        """Return them."""
        return tuple(need.condition for need in self.needs)

    def readings(self) -> tuple[Reading, ...]:
        """Return the one reading."""
        return (Reading(self.needs),)

    def find(self, bench: Bench) -> Finding:
        """Return where all of them are as they should."""
        where = bench.holds(self.readings())
        return Finding(
            computed=f"exact root counts over C_s under {len(self.needs)} condition(s)",
            found=f"true for C_s {describe(where)}",
            where=where,
        )


@dataclass(frozen=True)
class Together:
    """What several statements say together, and further conditions."""

    keys: tuple[str, ...]

    def conditions(self) -> tuple[Mapping[str, float], ...]:
        """Return the conditions of all."""
        return tuple(c for key in self.keys for c in Says(key).conditions())

    def readings(self) -> tuple[Reading, ...]:
        """Return nothing: the statements themselves are in the ledger."""
        return ()

    def find(self, bench: Bench) -> Finding:
        """Return where all statements hold."""
        sets = [bench.holds(Says(key).readings()) for key in self.keys]
        where = common(*sets)
        return Finding(
            computed=f"the stiffnesses for which {', '.join(self.keys)} are true together",
            found=f"C_s {describe(where)}",
            where=where,
        )


@dataclass(frozen=True)
class Threshold:
    """Raising a parameter stabilises, or the reverse: judged by the least stable C_s.

    Parameters
    ----------
    parameter : str
        The parameter.
    values : tuple of float
        Its values, rising.
    stabilises : bool
        Whether raising it is said to stabilise.
    others : tuple of mapping
        Further conditions; the claim is checked under each.
    """

    parameter: str
    values: tuple[float, ...]
    stabilises: bool
    others: tuple[Mapping[str, float], ...] = ({"u": 20.0},)

    def conditions(self) -> tuple[Mapping[str, float], ...]:
        """Return the condition at every value, under all others."""
        return tuple({**o, self.parameter: value} for o in self.others for value in self.values)

    def readings(self) -> tuple[Reading, ...]:
        """Return nothing: a tendency is no statement about one condition."""
        return ()

    def find(self, bench: Bench) -> Finding:
        """Compare the sets of stable stiffnesses; each must have one lower end and no upper one."""
        true, words = True, []
        for other in self.others:
            stable = [
                bench.course({**other, self.parameter: value}).where("stable")
                for value in self.values
            ]
            plain = all(len(one) == 1 and one[0][1] == SPAN[1] for one in stable)
            least = [one[0][0] if one else SPAN[1] for one in stable]
            falls = all(b < a for a, b in pairwise(least))
            rises = all(b > a for a, b in pairwise(least))
            true = true and plain and (falls if self.stabilises else rises)
            name = ", ".join(f" {k} = {v:g}" for k, v in other.items())
            pairs = zip(self.values, least, strict=True)
            listed = ", ".join(f"{self.parameter} = {value:g}: {c:.0f}" for value, c in pairs)
            words.append(f"stable above C_s [N/rad]{' at' if name else ''}{name}: {listed}")
        return Finding(
            computed=f"the stiffness above which straight running is stable, over {self.parameter}",
            found="; ".join(words),
            where=ALWAYS if true else (),
        )


class PrintedMatrices(Plain):
    """Whether the printed matrices (12) follow from (9)."""

    def find(self, bench: Bench) -> Finding:
        """Derive them again and count the entries that differ."""
        entries = state_space_entries()
        wrong = [entry.name for entry in entries if not entry.agrees]
        return Finding(
            computed="(10)-(12) derived from (9) by sympy, entry by entry",
            found=f"{len(wrong)} of {len(entries)} entries differ: {', '.join(wrong) or 'none'}",
            where=() if wrong else ALWAYS,
        )


class Passive(Plain):
    """Whether the viscoelastic law with its printed numbers is a passive material's."""

    def find(self, bench: Bench) -> Finding:
        """Look for frequencies at which the material would give energy."""
        law = bench.base.exact.laws(bench.base.values)[0]
        found = passivity(law)
        return Finding(
            computed="sign of the loss modulus Im Z(i omega) at all frequencies",
            found=str(found),
            where=ALWAYS if found.passive else (),
        )


def stable(**condition: float) -> Need:
    """Return the need for a stable straight running."""
    return Need(condition, "stable")


def shimmy(**condition: float) -> Need:
    """Return the need for shimmy."""
    return Need(condition, "shimmy")


def middle_of(where: Intervals) -> float:
    """Return a stiffness in the midst of the first interval of a set, in log C_s."""
    low, high = where[0]
    return float((low * high) ** 0.5)
