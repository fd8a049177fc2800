"""Whether a branch of equilibria reports its stability, and every change of it, as it really is."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby, pairwise
from typing import TYPE_CHECKING

from racs_bif.errors import ConvergenceError
from racs_bif.fractional.certificates import (
    CROSSINGS,
    ROUNDING,
    Place,
    at_fold,
    beside,
    changes,
    exact_count,
    near,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from racs_bif.fractional.certificates import Resolved
    from racs_bif.results.branch import Branch
    from racs_bif.results.certificate import Check
    from racs_bif.results.special import SpecialPoint
    from racs_bif.verbs.subject import Subject


@dataclass(frozen=True)
class _Verdict:
    """What the exact model says of one ordinary point of the branch.

    `count` is the number of exact unstable roots, None where it could not be had; `complaint` is
    empty where that agrees with what is reported. `shifted` points lie between a special point as
    reported and the exact one: there the count is the one reported.
    """

    k: int
    count: int | None
    complaint: str = ""
    shifted: bool = False


def complete(subject: Subject, resolved: Mapping[str, Resolved]) -> Iterator[Check]:
    """Yield the checks of completeness of a branch.

    Parameters
    ----------
    subject : Subject
        The branch and its exact model.
    resolved : mapping of str to Resolved
        Special points that were solved again. The realisation's point and the exact one differ by
        the shift, and so does the stability reported between them.
    """
    branch = subject.branch
    there = [p for p in branch.special if p.label in CROSSINGS and 0 <= p.index < len(branch)]
    critical = {p.index for p in there}
    verdicts = [_judge(subject, k, resolved) for k in range(len(branch)) if k not in critical]
    troubles = [*_disagreements(subject, verdicts), *_unexplained(subject, verdicts, there)]
    yield from troubles
    for point in there:
        yield _sides(subject, point, verdicts, resolved)
    if verdicts and not troubles:
        values = branch.parameter
        finding = (
            f"at all {len(verdicts)} ordinary points the exact roots agree with the stability "
            "reported; their number changes at the special points only"
        )
        interval = float(values.min()), float(values.max())
        yield subject.check(branch.name, "complete", interval, finding, holds=True)


def _judge(subject: Subject, k: int, resolved: Mapping[str, Resolved]) -> _Verdict:
    branch, place = subject.branch, subject.place(k)
    reported = int(branch.unstable[k])
    if reported < 0:
        return _Verdict(k, None, "no stability is reported")
    try:
        count = exact_count(subject.exact, subject.path, place)
    except ConvergenceError as error:
        if _between(subject, place, resolved):
            return _Verdict(k, reported, shifted=True)
        return _Verdict(k, None, str(error))
    neutral = bool(count.on_line) or count.at_zero
    if reported == count.unstable and (neutral or bool(branch.stable[k]) == (reported == 0)):
        return _Verdict(k, reported)
    if _between(subject, place, resolved):
        return _Verdict(k, reported, shifted=True)
    told = "stable" if branch.stable[k] else "unstable"
    complaint = f"reported {told} with {reported} unstable roots, the exact model has "
    return _Verdict(k, count.unstable, f"{complaint}{count.unstable}")


def _between(subject: Subject, place: Place, resolved: Mapping[str, Resolved]) -> bool:
    """Say whether a place lies between a special point as reported and the exact one."""
    for name, exact in resolved.items():
        ends = subject.branch[name].parameters[subject.parameter], exact.value
        rounding = ROUNDING * max(map(abs, ends))
        inside = min(ends) - rounding <= place.value <= max(ends) + rounding
        if inside and near(place.X, exact.X):
            return True
    return False


def _disagreements(subject: Subject, verdicts: list[_Verdict]) -> Iterator[Check]:
    """Yield a failed check for every stretch of points with the same complaint."""
    branch = subject.branch
    for complaint, stretch in groupby(verdicts, key=lambda verdict: verdict.complaint):
        values = [float(branch.parameter[verdict.k]) for verdict in stretch]
        if complaint:
            interval = min(values), max(values)
            where = _where(subject, interval)
            yield subject.check(branch.name, "complete", interval, f"{where}: {complaint}")


def _unexplained(
    subject: Subject, verdicts: list[_Verdict], there: list[SpecialPoint]
) -> Iterator[Check]:
    """Yield a failed check wherever the exact count changes by what no special point explains."""
    branch = subject.branch
    folds = [float(branch.parameter[p.index]) for p in there if p.label != "H"]
    told_apart = [
        v for v in verdicts if not (v.shifted and at_fold(folds, float(branch.parameter[v.k])))
    ]
    for a, b in pairwise(told_apart):
        if a.count is None or b.count is None:
            continue
        points = [p for p in there if a.k < p.index < b.k]
        change = b.count - a.count
        if change in changes(p.label for p in points):
            continue
        values = float(branch.parameter[a.k]), float(branch.parameter[b.k])
        interval = min(values), max(values)
        where = _where(subject, interval)
        counts = f"the number of exact unstable roots goes from {a.count} to {b.count}"
        names = ", ".join(p.name for p in points)
        told = f"as {names} does not explain" if points else "where no special point is reported"
        finding = f"{where}: {counts}, {told}"
        yield subject.check(branch.name, "complete", interval, finding)


def _sides(
    subject: Subject,
    point: SpecialPoint,
    verdicts: list[_Verdict],
    resolved: Mapping[str, Resolved],
) -> Check:
    """Compare both sides of a special point with the stability reported there."""
    branch, k = subject.branch, point.index
    before = next((v.k for v in reversed(verdicts) if v.k < k and not v.shifted), None)
    after = next((v.k for v in verdicts if v.k > k and not v.shifted), None)
    numbers: dict[str, float] = {}
    values, holds, words = [float(branch.parameter[k])], True, []
    try:
        for side, neighbour in (("before", before), ("after", after)):
            if neighbour is None or _apart(branch, k, neighbour):
                continue
            reported = int(branch.unstable[neighbour])
            place = _aside(subject, k, neighbour, resolved)
            found = exact_count(subject.exact, subject.path, place).unstable
            values.append(place.value)
            numbers[side] = found
            words.append(f"{found} exact unstable roots {side} it, {reported} reported")
            holds = holds and found == reported
    except ConvergenceError as error:
        holds, words = False, [str(error)]
    interval = min(values), max(values)
    finding = "; ".join(words) or "no other point on the branch"
    return subject.check(point.name, "complete", interval, finding, holds=holds, numbers=numbers)


def _apart(branch: Branch, k: int, neighbour: int) -> bool:
    """Return whether another special point lies between: the count there is not beside this one."""
    low, high = sorted((k, neighbour))
    return any(low < point.index < high for point in branch.special)


def _aside(subject: Subject, k: int, neighbour: int, resolved: Mapping[str, Resolved]) -> Place:
    """Return a place near point k towards a neighbour, the neighbour if that is within a shift."""
    end = subject.place(neighbour)
    place = beside(subject.exact, subject.path, subject.place(k), end)
    return end if _between(subject, place, resolved) else place


def _where(subject: Subject, interval: tuple[float, float]) -> str:
    low, high = interval
    name = subject.parameter
    return f"at {name} = {low:.7g}" if low == high else f"from {name} = {low:.7g} to {high:.7g}"
