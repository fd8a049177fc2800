"""Curves of other points over a stability chart, such as the folds of cycles that bound orbits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.results.same import same

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from numpy.typing import NDArray

    from racs_bif.results.branch import Branch

KINDS: Final = {
    "lpc": "fold of cycles (LPC)",
    "bpc": "branch point of cycles (BPC)",
    "pd": "period doubling (PD)",
    "ns": "Neimark-Sacker (NS)",
    "curve": "curve",
}
"""Kinds of curves, and what they are called in print."""
_HELD: Final = 1e-9


@dataclass(frozen=True, kw_only=True, eq=False)
class ChartCurve:
    """A curve of special points, m points long.

    Parameters
    ----------
    kind : str
        A key of `KINDS`.
    name : str
        Of the branch it was made from.
    values : array (m, 2)
        The two parameters of the chart, SI.
    stopped : str
        Why it ended.
    """

    kind: str
    name: str
    values: NDArray[np.float64]
    stopped: str = ""

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.values)

    def __eq__(self, other: object) -> bool:
        """Compare bit by bit."""
        return same(self, other) if isinstance(other, ChartCurve) else NotImplemented

    __hash__ = None  # type: ignore[assignment]


def curve_of(
    branch: Branch,
    plane: tuple[str, str],
    held: Mapping[str, float],
    kind: str | None = None,
    *,
    loose: Collection[str] = (),
) -> ChartCurve:
    """Return a branch of two parameters as a curve over a chart.

    Parameters
    ----------
    branch : Branch
        As `racs_bif.continue_curve` returns it.
    plane : (str, str)
        Parameters of the chart.
    held : mapping of str to float
        The chart's parameters; all but the plane's must be those of the branch.
    kind : str, optional
        A key of `KINDS`; told by the branch's name or method where left out.
    loose : collection of str
        Parameters that follow from those of the plane, and need not be the same.

    Raises
    ------
    UsageError
        If the branch is no curve in this plane, was computed at other values of what is held, or
        the kind is unknown.
    """
    if set(branch.parameters) != set(plane):
        msg = (
            f"'{branch.name}' is a curve in {' and '.join(branch.parameters)}, the chart's plane "
            f"is that of {plane[0]} and {plane[1]}; leave it out"
        )
        raise UsageError(msg)
    for name, value in branch.system.parameters.items():
        here = held.get(name, value)
        if name in plane or name in loose:
            continue
        if abs(here - value) > _HELD * max(abs(here), abs(value)):
            msg = (
                f"'{branch.name}' was computed at {name} = {value:g}, the chart at {here:g}; "
                f"compute both at one {name}"
            )
            raise UsageError(msg)
    if kind is None:
        told = f"{branch.name} {branch.method}".lower()
        kind = next((known for known in KINDS if known in told), "curve")
    if kind not in KINDS:
        msg = f"unknown kind of curve '{kind}'; there are: {', '.join(KINDS)}"
        raise UsageError(msg)
    order = [branch.parameters.index(name) for name in plane]
    return ChartCurve(
        kind=kind,
        name=branch.name,
        values=np.ascontiguousarray(branch.values[:, order]),
        stopped=branch.stopped,
    )
