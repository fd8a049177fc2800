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

    @property
    def complete(self) -> bool:
        """Whether the branch ended where it was meant to, at its span or closed."""
        return self in {Stopped.SPAN, Stopped.CLOSED}
