"""The approach of a branch of orbits to a homoclinic orbit or a heteroclinic cycle.

An orbit that passes a saddle ever more closely takes ever longer, and the parameter tends to that
of the connection: lambda = lambda_0 + C e^(-nu T), where nu is the smallest of the rates, leaving
or arriving, at the saddles passed (Yu. A. Kuznetsov, *Elements of Applied Bifurcation Theory*,
chapter 6). As T = -(1 / nu) log |lambda - lambda_0| + ..., the limit follows from the last orbits.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.orbits.slow_passages import Saddle, saddles_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from racs_bif.continuation.points import Point
    from racs_bif.orbits.problem import OrbitProblem
    from racs_bif.symbolic.field import Array

_FEWEST: Final = 4
"""Orbits from which a limit is estimated."""
_LONG: Final = 3.0
"""How many times longer than the fastest orbit of the branch one must be to be looked at."""
_SLOWS: Final = 0.4
"""Largest share of the parameter's motion over the last orbits that is due to the very last."""
_DWELLS: Final = 3.0
"""Least share of the period, in units of 1 / nu, that is spent near saddles."""
_NEAR: Final = 0.05
"""Largest distance to a saddle, relative to the orbit, of one that passes it closely."""


@dataclass(frozen=True, eq=False)
class Connection:
    """What a branch of orbits of growing period tends to.

    Attributes
    ----------
    saddles : tuple of Saddle
        Those passed, in order; one for a homoclinic orbit.
    limit, error : float
        The parameter of the connection, and how uncertain it is.
    rate : float
        nu, in units of inverse time.
    growth : float
        How fast the period grows as the orbits close in: minus dT / d log(distance to the saddle).
    """

    saddles: tuple[Saddle, ...]
    limit: float
    error: float
    rate: float
    growth: float

    @property
    def homoclinic(self) -> bool:
        """Whether it leaves and arrives at one saddle."""
        return len(self.saddles) == 1

    @property
    def quantity(self) -> float:
        """Saddle quantity: the sum of the real parts of the leading eigenvalues.

        For a cycle the sum over its saddles.
        """
        return sum(saddle.quantity for saddle in self.saddles)

    @property
    def ratio(self) -> float:
        """Measured growth of the period over what the eigenvalues foretell: near 1 if all is well.

        The distance shrinks like e^(-T lambda_u lambda_s / (lambda_u + lambda_s)).
        """
        return self.growth / sum(saddle.growth for saddle in self.saddles)


def connection(
    problem: OrbitProblem, points: Sequence[Point], own: int, accuracy: float
) -> Connection | None:
    """Return what the last orbits of a branch tend to, None where that is no connection.

    Parameters
    ----------
    problem : OrbitProblem
        The problem.
    points : sequence of Point
        The branch so far, the longest orbit last.
    own : int
        Number of the model's own states.
    accuracy : float
        Uncertainty of the parameter of a single orbit.
    """
    tail = list(points[-_FEWEST:])
    periods = np.array([problem.period(point.z) for point in tail])
    values = np.array([point.parameter for point in tail])
    fastest = min((problem.period(point.z) for point in points), default=np.inf)
    if len(tail) < _FEWEST or not _slows(periods, values, fastest):
        return None
    saddles = saddles_of(problem, tail[-1].z, own)
    rate = min((saddle.slowest for saddle in saddles), default=0.0)
    near = max((saddle.distance for saddle in saddles), default=np.inf) <= _NEAR
    if not (near and rate * periods[-1] > _DWELLS):
        return None
    shares = np.exp(-rate * np.diff(periods))
    limits = (values[1:] - values[:-1] * shares) / (1.0 - shares)
    scatter = float(np.ptp(limits[-2:])) + accuracy
    # where the estimates do not settle, the motion of the parameter itself is the uncertainty
    moved = float(np.abs(np.diff(values[-2:]))[0])
    if scatter > max(moved, 2.0 * accuracy):
        return None
    before = saddles_of(problem, tail[-2].z, own)
    closer = [
        np.log(was.distance / saddle.distance) for saddle, was in zip(saddles, before, strict=False)
    ]
    growth = float((periods[-1] - periods[-2]) / np.mean(closer)) if closer else np.nan
    return Connection(saddles, float(limits[-1]), scatter, rate, growth)


def _slows(periods: Array, values: Array, fastest: float) -> bool:
    """Say whether orbits become long while the parameter comes to rest."""
    longer = bool(np.all(np.diff(periods) > 0.0)) and periods[-1] >= _LONG * fastest
    moved = float(values.max() - values.min())
    return longer and abs(float(values[-1] - values[-2])) <= _SLOWS * moved
