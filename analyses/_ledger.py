"""What a claim of the paper is, what a check finds, and how the verdict follows from it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Any, Final, Protocol

from racs_bif import load_model

if TYPE_CHECKING:  # the folder is no package; the shelf finds its files in every installation
    from collections.abc import Hashable, Mapping, Sequence

    from analyses._claimed import (
        STATEMENTS,
        Intervals,
        Key,
        Reading,
        Statement,
        common,
        conditions_of,
        describe,
        either,
        judge,
        key_of,
        within,
    )
    from analyses._stability import Course, courses
    from analyses._stability_search import SPAN
    from racs_bif.fractional.system import System
else:
    from racs_bif.shelf.analyses._claimed import (
        STATEMENTS,
        common,
        conditions_of,
        describe,
        either,
        judge,
        key_of,
        within,
    )
    from racs_bif.shelf.analyses._stability import courses
    from racs_bif.shelf.analyses._stability_search import SPAN

HOLDS: Final = "holds"
CALIBRATED: Final = "holds with the calibrated C_s"
ONLY: Final = "holds only for C_s in"
CONTRADICTS: Final = "contradicts"
FALSE: Final = "does not hold"
KINDS: Final = (HOLDS, CALIBRATED, ONLY, CONTRADICTS, FALSE)
"""The kinds of verdicts."""
ALWAYS: Final[tuple[tuple[float, float], ...]] = (SPAN,)
"""The set of a claim that is true whatever C_s is."""


@dataclass(frozen=True, kw_only=True)
class Finding:
    """What a check found.

    Parameters
    ----------
    computed : str
        What was computed.
    found : str
        The values found.
    where : Intervals, optional
        Stiffnesses for which the claim is true; `ALWAYS` where C_s is no matter. None: it was
        checked with the calibrated C_s alone, and `true` tells what came out.
    true : bool
        See `where`.
    """

    computed: str
    found: str
    where: Intervals | None = None
    true: bool = False


class Check(Protocol):
    """How a claim is checked."""

    def conditions(self) -> Sequence[Mapping[str, float]]:
        """Return the conditions whose exact roots are wanted over C_s."""

    def readings(self) -> tuple[Reading, ...]:
        """Return what the claim says of stability, in all readings; nothing where it does not."""

    def find(self, bench: Bench) -> Finding:
        """Check the claim."""


@dataclass(frozen=True, kw_only=True)
class Claim:
    """A claim of the paper.

    Parameters
    ----------
    key : str
        A short name.
    place : str
        Where it stands in the paper.
    says : str
        What it says, quoted or paraphrased.
    stated : str
        The parameters that it states; the others have their values of section 3.
    check : Check
        How it is checked.
    figure : str
        The figure that shows it, ``fig03``.
    """

    key: str
    place: str
    says: str
    stated: str
    check: Check
    figure: str = ""


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A claim with what was found and the verdict.

    Parameters
    ----------
    claim : Claim
        The claim.
    finding : Finding
        What was found.
    verdict : str
        One of the verdicts.
    against : tuple of str
        Claims that say the opposite under the same conditions.
    apart : tuple of str
        Claims about stability that no C_s makes true together with this one.
    """

    claim: Claim
    finding: Finding
    verdict: str
    against: tuple[str, ...] = ()
    apart: tuple[str, ...] = ()

    @property
    def kind(self) -> str:
        """The verdict without what is particular to the claim."""
        return next(kind for kind in reversed(KINDS) if self.verdict.startswith(kind))


@dataclass(eq=False)
class Bench:
    """What all checks share.

    Parameters
    ----------
    claims : tuple of Claim
        The claims that are checked; their exact roots are computed together.
    resolution : int
        Stiffnesses on the grid of `_stability.courses`.
    seconds : float
        Length of the simulations from which Lyapunov exponents are taken.
    kept : dict
        What several checks use, such as orbits.
    """

    claims: tuple[Claim, ...]
    resolution: int
    seconds: float
    kept: dict[Hashable, Any] = field(default_factory=dict)

    @cached_property
    def base(self) -> System:
        """The vehicle with the calibrated stiffness."""
        return load_model("racs")

    @property
    def calibrated(self) -> float:
        """The calibrated C_s [N/rad]."""
        return float(self.base.parameters["C_s"])

    def system(self, condition: Mapping[str, float]) -> System:
        """Return the vehicle under a condition."""
        return self.base.with_parameters(condition)

    @cached_property
    def known(self) -> Mapping[Key, Course]:
        """What straight running is under the conditions of all claims."""
        wanted = [condition for claim in self.claims for condition in claim.check.conditions()]
        wanted += [condition for each in STATEMENTS for condition in conditions_of(each)]
        found = courses("paper", wanted, self.resolution)
        return {key_of(c): course for c, course in zip(wanted, found, strict=True)}

    def course(self, condition: Mapping[str, float]) -> Course:
        """Return what straight running is under a condition of a check."""
        return self.known[key_of(condition)]

    def statement(self, key: str) -> Statement:
        """Return one of the statements about stability."""
        return next(each for each in STATEMENTS if each.key == key)

    def holds(self, readings: Sequence[Reading]) -> Intervals:
        """Return the stiffnesses for which one of some readings is true."""
        return either(*(judge(reading, self.known).holds for reading in readings))

    def same(self, condition: Mapping[str, float]) -> Key:
        """Return a condition with all its defaults, to compare it with another."""
        base = {p.name: self.base.parameters[p.name] for p in self.base.compiled.parameters}
        return key_of({**base, **condition})


def examine(claims: tuple[Claim, ...], findings: Sequence[Finding], bench: Bench) -> list[Entry]:
    """Return the verdicts on all claims.

    A claim about stability contradicts another where both speak of the same conditions and say the
    opposite, in all their readings: then C_s is no matter. Two claims are apart where each is true
    for some C_s, and none makes both true.
    """
    entries = []
    for claim, finding in zip(claims, findings, strict=True):
        against = tuple(
            other.key for other in claims if other is not claim and _opposed(claim, other, bench)
        )
        apart = tuple(
            other.key
            for other, its in zip(claims, findings, strict=True)
            if other.check.readings() and finding.where and its.where
            if not common(finding.where, its.where)
        )
        verdict = verdict_on(finding, against, bench.calibrated)
        entries.append(
            Entry(claim=claim, finding=finding, verdict=verdict, against=against, apart=apart)
        )
    return entries


def verdict_on(finding: Finding, against: tuple[str, ...], calibrated: float) -> str:
    """Return the verdict that follows from what was found."""
    if finding.where is None:
        return CALIBRATED if finding.true else f"{FALSE} with the calibrated C_s"
    if finding.where == ALWAYS:
        return HOLDS
    if not finding.where:
        return FALSE
    if within(calibrated, finding.where):
        return CALIBRATED
    if against:
        return f"{CONTRADICTS} {', '.join(against)}; {ONLY} {_range(finding.where)}"
    return f"{ONLY} {_range(finding.where)}"


def _range(where: Intervals) -> str:
    return f"[{describe(where)}] N/rad"


def _opposed(one: Claim, other: Claim, bench: Bench) -> bool:
    pairs = list(product(one.check.readings(), other.check.readings()))
    return bool(pairs) and all(
        any(
            a.state != b.state and bench.same(a.condition) == bench.same(b.condition)
            for a, b in product(first.needs, second.needs)
        )
        for first, second in pairs
    )
