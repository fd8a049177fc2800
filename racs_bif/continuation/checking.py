"""Whether a step stayed on its branch, and how long the next one may be."""

from __future__ import annotations

import math
from dataclasses import dataclass
from operator import itemgetter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from racs_bif.continuation.points import Array
    from racs_bif.continuation.scaling import Scaling

CONTRACTION = 0.25
"""Largest ratio of the second Newton correction to the first.

Newton's first contraction is about the error of the prediction over the distance to the nearest
other solution, so that this bound keeps predictions well nearer to their own branch.
"""
_SKEW = 0.04
_SAFETY = 0.7
_USUAL_ITERATIONS = 4
_LONGER, _SHORTER = 2.0, 0.5


@dataclass(slots=True)
class Verdict:
    """Judgement of a step.

    Attributes
    ----------
    accepted : bool
        Whether the step counts.
    factor : float
        By how much to change the step.
    length : float
        Scaled length of the chord.
    reason : str
        Why it does not count.
    """

    accepted: bool
    factor: float
    length: float
    reason: str = ""


def judge(
    scaling: Scaling,
    ends: tuple[Array, Array],
    tangents: tuple[Array, Array],
    newton: tuple[int, float],
    largest_angle: float,
) -> Verdict:
    """Judge a step by the angle between the tangents, its skewness and Newton's contraction.

    The chord of a smooth piece halves the angle between the tangents at its ends, up to the square
    of its length. A step onto a parallel branch is skew: Newton may have converged at once there,
    and both tangents may agree, but the chord does not lie along them.

    Parameters
    ----------
    scaling : Scaling
        The norm.
    ends : tuple of array (n + 1,)
        The solutions before and after.
    tangents : tuple of array (n + 1,)
        The unit tangents there.
    newton : tuple
        Iterations and first contraction.
    largest_angle : float
        Largest angle between the tangents, rad.
    """
    weights = scaling.weights
    before, after = tangents
    cosine = float(weights.dot(before * after))
    chord = ends[1] - ends[0]
    length = scaling.norm(chord)
    if not cosine > 0.0 or length == 0.0:
        reason = "the tangent turned back" if length else "the step has no length"
        return Verdict(accepted=False, factor=_SHORTER, length=length, reason=reason)
    angle = math.acos(min(cosine, 1.0))
    # Between unit vectors: 2 - 2 cos is the square of their distance.
    along = float(weights.dot(chord * (before + after))) / (length * math.sqrt(2.0 + 2.0 * cosine))
    skew = math.sqrt(max(2.0 - 2.0 * along, 0.0))
    iterations, contraction = newton
    ratios = {
        "the tangent turned too much": angle / largest_angle,
        "the step does not lie along the branch": math.sqrt(skew / _SKEW),
        "Newton's method contracts too slowly": math.sqrt(contraction / CONTRACTION),
    }
    worst, ratio = max(ratios.items(), key=itemgetter(1))
    if ratio > 1.0:
        factor = max(_SHORTER, _SAFETY / ratio)
        return Verdict(accepted=False, factor=factor, length=length, reason=worst)
    factor = _SAFETY / max(ratio, _SAFETY / _LONGER)
    if iterations > _USUAL_ITERATIONS:
        factor = min(factor, _USUAL_ITERATIONS / iterations)
    return Verdict(accepted=True, factor=max(factor, _SHORTER), length=length)
