"""What was certified of a result, check by check."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd

    from racs_bif.results.provenance import SystemInfo


@dataclass(frozen=True, kw_only=True)
class Bounds:
    """What an interval proof says of one unknown.

    Parameters
    ----------
    centre, radius : float
        The unknown's side of the box in which exactly one point lies.
    lower, upper : float
        Bounds of that point.
    """

    centre: float
    radius: float
    lower: float
    upper: float


@dataclass(frozen=True, kw_only=True)
class Check:
    """One thing that was checked.

    Parameters
    ----------
    branch : str
        The branch.
    subject : str
        What was checked: a special point's name, or the branch's.
    strength : {"newton", "complete", "proof"}
        How; see `racs_bif.verbs.certify.certify`.
    holds : bool
        Whether it is true.
    finding : str
        What was found, one sentence.
    interval : (float, float)
        Values of the active parameter that the check is about.
    numbers : dict of str to float
        ``value`` and ``omega`` of the exact point, its relative ``shift`` and the last relative
        ``correction``; or roots ``before`` and ``after``.
    box : dict of str to Bounds
        What was proved, by unknown: states, element outputs, the parameter and ``omega``.
    """

    branch: str
    subject: str
    strength: str
    holds: bool
    finding: str
    interval: tuple[float, float]
    numbers: Mapping[str, float] = field(default_factory=dict)
    box: Mapping[str, Bounds] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Certificate:
    """Everything that was checked of a result.

    Parameters
    ----------
    checks : tuple of Check
        Branch by branch.
    strength : {"newton", "complete", "proof"}
        The strongest kind of check that was made.
    parameter : str
        The active parameter.
    system : SystemInfo
        The system behind the first branch.
    notes : tuple of str
        What was not certified.
    """

    checks: tuple[Check, ...]
    strength: str
    parameter: str
    system: SystemInfo
    notes: tuple[str, ...] = ()

    @property
    def holds(self) -> bool:
        """Whether every check is true."""
        return all(check.holds for check in self.checks)

    @property
    def failures(self) -> tuple[Check, ...]:
        """The checks that are not."""
        return tuple(check for check in self.checks if not check.holds)

    def of(self, subject: str, strength: str | None = None) -> tuple[Check, ...]:
        """Return the checks of a special point or branch, all of them or those of one kind."""
        found = [c for c in self.checks if c.subject == subject]
        return tuple(c for c in found if strength in {None, c.strength})

    def to_dataframe(self) -> pd.DataFrame:
        """Return a table, a check a row."""
        import pandas as pd

        names = ("branch", "subject", "strength", "holds", "finding")
        rows = [{n: getattr(c, n) for n in names} | dict(c.numbers) for c in self.checks]
        return pd.DataFrame(rows)
