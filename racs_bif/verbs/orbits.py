"""Branches of periodic orbits."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from racs_bif.continuation.settings import StepSettings
from racs_bif.continuation.trace import trace
from racs_bif.errors import UsageError
from racs_bif.numerics.threads import single_threaded
from racs_bif.orbits.branch_point import BranchPointOfCycles
from racs_bif.orbits.cycles_fold import FoldOfCycles
from racs_bif.orbits.endings import Endings
from racs_bif.orbits.methods import METHODS
from racs_bif.orbits.neimark_sacker import NeimarkSacker
from racs_bif.orbits.period_doubling import PeriodDoubling
from racs_bif.orbits.settled import settled
from racs_bif.verbs.equilibria import check_span
from racs_bif.verbs.orbit_branch import Followed, orbit_branch
from racs_bif.verbs.orbit_ends import settle, tracks
from racs_bif.verbs.orbit_start import Beginning, beginning

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from racs_bif.continuation.points import Point
    from racs_bif.continuation.stopped import Stopped
    from racs_bif.continuation.targets import Targets
    from racs_bif.continuation.trace import Until
    from racs_bif.fractional.system import System
    from racs_bif.orbits.methods import Settings
    from racs_bif.results.branch import Branch
    from racs_bif.results.special import SpecialPoint
    from racs_bif.symbolic.model import Model

__all__ = ["METHODS", "STEPS", "continue_orbits", "follow_orbits"]

STEPS: Final = StepSettings(maximum=0.05, tolerance=1e-8)


@single_threaded
def continue_orbits(  # noqa: PLR0913 - each is one choice of the user's
    point: SpecialPoint,
    span: tuple[float, float] | None = None,
    *,
    parameter: str | None = None,
    method: str | None = None,
    at: Targets = (),
    known: Sequence[Branch] = (),
    model: Model | System | str | None = None,
    settings: StepSettings | None = None,
    orbit_settings: Settings | None = None,
    progress: Callable[[Point], None] | None = None,
) -> Branch:
    """Follow the periodic orbits that leave a point through a span of a parameter.

    A Hopf point (H) gives the orbits born there, a period doubling (PD) the orbits of twice the
    period, a branch point of cycles (BPC) the other branch. Any other point of a branch of orbits
    gives the branch through its orbit: in another parameter, by another method, or again.

    Folds of cycles (LPC), branch points (BPC), period doublings (PD) and Neimark-Sacker points (NS)
    are located. A branch ends where it arrives at a Hopf point, at a doubling whose orbits it is
    the double of, at its own beginning or on a branch that is known, and says which.

    Parameters
    ----------
    point : SpecialPoint
        Where to start. A point that was loaded from a file has the orbit's own states only; the
        memory of fractional elements is computed as their steady response to these.
    span : (float, float), optional
        Interval of the parameter; that of the point's own branch where left out.
    parameter : str, optional
        Active parameter; that of the point's own branch where left out.
    method : str, optional
        ``shooting``: multiple shooting with the implicit Radau method, the default from a Hopf
        point. ``collocation``: orthogonal collocation at Gauss points on an adaptive mesh.
        ``harmonic-balance``: Fourier series on the exact fractional operator, from the exact Hopf
        point; multipliers still are those of the realisation, along the exact orbit. By default
        that of the point's own branch.
    at : sequence of float, or dict of str to sequence of float
        Orbits wanted exactly, labelled UZ: values of the parameter, or by name of the parameter,
        the period or another measure, as in ``{"u": [12], "period": [0.8]}``.
    known : sequence of Branch
        Branches that it may run onto, and whose Hopf points and doublings it may arrive at.
    model : Model, System or str, optional
        The model of a point that was loaded from a file, where the model was made in Python.
    settings : StepSettings, optional
        Step control.
    orbit_settings : OrbitSettings, CollocationSettings or BalanceSettings, optional
        How orbits are resolved, as the method has it.
    progress : callable, optional
        Called with every new point.

    Returns
    -------
    Branch
        Named PO1, of kind ``orbit``; from H and PD its first point is that point, an orbit of no
        amplitude.

    Raises
    ------
    UsageError
        If no orbits start at the point, the method is unknown, or the settings are those of
        another.
    ConvergenceError
        If there is no orbit at the start.
    """
    start = beginning(point, parameter, method, orbit_settings, model)
    wanted = span or start.span
    if wanted is None:
        name = start.begun.problem.parameter
        msg = f"give the span of '{name}': {point.name} lies on no branch that varies it"
        raise UsageError(msg)
    low, high = check_span(start.system, start.begun.problem.parameter, wanted)
    if not low <= start.value <= high:
        msg = f"{point.name} at {start.value:g} is outside the span {low:g} to {high:g}; widen it"
        raise UsageError(msg)
    return follow_orbits(
        start, (low, high), at=at, known=known, settings=settings, progress=progress
    )


def follow_orbits(
    start: Beginning,
    span: tuple[float, float],
    *,
    at: Targets = (),
    known: Sequence[Branch] = (),
    settings: StepSettings | None = None,
    progress: Callable[[Point], None] | None = None,
    until: Until | None = None,
) -> Branch:
    """Follow a branch of orbits from its start.

    Parameters
    ----------
    start : Beginning
        Where it starts.
    span : (float, float)
        Interval of the parameter.
    at, known, settings, progress
        As for `continue_orbits`.
    until : callable, optional
        As for `racs_bif.continuation.trace.trace`, asked after what ends a branch of itself.
    """
    problem, z = start.begun.problem, start.begun.z
    if start.begun.tangent is None and start.direction is None:
        z = settled(problem, z)[0]
    system = start.system
    endings = Endings(problem, system.states, span[1] - span[0], tracks(system, known))

    def ended(before: Point, point: Point) -> Stopped | None:
        return endings(before, point) or (until(before, point) if until is not None else None)

    found = trace(
        problem,
        z,
        span,
        [FoldOfCycles(), BranchPointOfCycles(), PeriodDoubling(), NeimarkSacker()],
        settings or STEPS,
        tangent=start.begun.tangent,
        direction=start.direction,
        targets=at,
        progress=progress,
        until=ended,
    )
    found, end = settle(found, system, endings, known)
    return orbit_branch(Followed(system, problem, start.method, span, found), end)
