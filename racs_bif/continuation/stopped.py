"""Why a branch ended, in sentences that the user reads."""

from __future__ import annotations

from enum import Enum


class Stopped(Enum):
    """Why a branch ended and what to do about it; the value of a member is the sentence."""

    SPAN = "The branch reached the end of its span; widen the span to go on."
    CLOSED = "The branch closed on itself: it is complete."
    POINTS = "The branch has as many points as allowed; raise the number of points to go on."
    STEP = (
        "Newton's method did not converge even with the smallest step; look for a singularity of "
        "the equations here, or improve the discretisation."
    )
    TURN = (
        "The branch turns more sharply than the smallest step resolves; look for a corner or a "
        "jump of the equations here, or lower the smallest step."
    )
    FAILED = (
        "The equations could not be evaluated beyond this point; see the message, and narrow the "
        "span to where the model is valid."
    )
    INTERRUPTED = "The run was interrupted; the points up to here are kept."
    VALIDITY = "The branch left the range in which the model is valid; narrow the span."
    PERIOD = (
        "The period grew past its limit, as it does near a homoclinic orbit; raise the limit or "
        "follow the connection itself."
    )
    ACCURACY = (
        "The discretisation no longer resolves the solution; use more intervals, a finer mesh or "
        "another method."
    )
    STATIC = (
        "The frequency of the Hopf points tends to zero, where the exact curve cannot go on; "
        "look for a fold there."
    )
    UNFOLDED = (
        "Branch points do not persist when the second parameter moves: they unfold into folds, or "
        "part; follow the folds instead."
    )
    VANISHED = "The orbit shrank to an equilibrium: look for a Hopf point there."
    HOPF = "The branch of orbits arrived at a Hopf point: it is complete."
    HALVED = "The orbits became orbits of half the period, at a period doubling: it is complete."
    KNOWN = "The branch runs onto one that is known already; the rest of it is there."
    COLLAPSED = (
        "Newton's method fell from an orbit onto an equilibrium that is no Hopf point; the points "
        "before that are kept: lower the largest step, or use a finer mesh."
    )
    CONNECTION = "The orbits approach a connection of equilibria, and the period grows for ever."
    INFINITY = (
        "The branch runs to infinity while the parameter all but stands still: there is no more of "
        "it."
    )
    FOUND = "What was looked for was found; the branch was not followed beyond it."

    @property
    def complete(self) -> bool:
        """Whether the branch ended where it was meant to, or where there is no more of it."""
        return self in _COMPLETE


_COMPLETE = frozenset(
    {
        Stopped.SPAN,
        Stopped.CLOSED,
        Stopped.HOPF,
        Stopped.HALVED,
        Stopped.KNOWN,
        Stopped.CONNECTION,
        Stopped.INFINITY,
        Stopped.FOUND,
    }
)
