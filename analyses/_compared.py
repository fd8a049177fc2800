"""The same picture at more than one stiffness, for the paper gives none."""

from __future__ import annotations

from typing import TYPE_CHECKING

from racs_bif import load_model
from racs_bif.plots.text import symbol

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from analyses._pinned import titled
    from analyses._ridden import Ride, ride
    from analyses._swept import computed, part
    from racs_bif.plots.sweep import Case
else:
    from racs_bif.shelf.analyses._pinned import titled
    from racs_bif.shelf.analyses._ridden import ride
    from racs_bif.shelf.analyses._swept import computed, part


def rides(  # noqa: PLR0913 - a panel's choices
    stiffnesses: Mapping[str, float],
    fixed: Mapping[str, float],
    parameter: str,
    values: Sequence[float],
    *,
    span: tuple[float, float],
    duration: float,
    step: float,
    points: int,
    progress: Callable[[float], None] | None = None,
) -> dict[str, Ride]:
    """Ride at several values of a parameter with every stiffness.

    Parameters
    ----------
    stiffnesses : mapping of str to float
        C_s [N/rad] by where it comes from.
    fixed : mapping of str to float
        Parameters that are not the paper's own.
    parameter, values
        What is varied, and its values.
    span, duration, step, points
        See `analyses._ridden.ride`.
    progress : callable, optional
        Told the share that is done.

    Returns
    -------
    dict of str to Ride
        By title.
    """
    units = {p.name: p.unit for p in load_model("racs").parameter_table}
    found: dict[str, Ride] = {}
    for source, stiffness in stiffnesses.items():
        for value in values:
            title = f"{symbol(parameter)} = {value:g} {units[parameter]}"
            found[f"{title}, {titled(stiffness, source)}"] = ride(
                {**fixed, parameter: value, "C_s": stiffness},
                duration=duration,
                step=step,
                points=points,
                parameter=parameter,
                span=span,
            )
            report = part(progress, len(found) - 1, len(stiffnesses) * len(values))
            if report is not None:
                report(0.9)
    return found


def sweeps(  # noqa: PLR0913 - a panel's choices
    stiffnesses: Mapping[str, float],
    fixed: Mapping[str, float],
    parameter: str,
    span: tuple[float, float],
    *,
    marks: Mapping[str, float],
    members: int,
    duration: float,
    points: int,
    longest: float = 3.5,
    progress: Callable[[float], None] | None = None,
) -> list[Case]:
    """Sweep and continue with every stiffness; see `rides` and `analyses._swept.computed`."""
    return [
        computed(
            titled(stiffness, source),
            {**fixed, "C_s": stiffness},
            parameter,
            span,
            marks=marks,
            members=members,
            duration=duration,
            points=points,
            longest=longest,
            report=part(progress, k, len(stiffnesses)),
        )
        for k, (source, stiffness) in enumerate(stiffnesses.items())
    ]
