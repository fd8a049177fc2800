"""Exact equilibria over a plane, continued from place to place."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.charts.members import Members

if TYPE_CHECKING:
    from racs_bif.charts.plane import Plane
    from racs_bif.symbolic.field import Array

SHORTEST = 2.0**-10
_CAREFUL = 2.0**-7
_STEPS = 400


class Sheet(Members):
    """The equilibria over a plane that belong together: each is continued from another.

    Parameters
    ----------
    plane : Plane
        Where.
    """

    def __init__(self, plane: Plane) -> None:
        super().__init__(plane.system)
        self.plane = plane

    def follow(
        self, X: Array, start: Array, end: Array, *, shortest: float = SHORTEST
    ) -> tuple[Array, Array]:
        """Continue equilibria along straight lines.

        Where the determinant changes its sign steps are short: Newton's method would leap over a
        fold to another equilibrium. Where that of the mass matrix does, they end.

        Parameters
        ----------
        X : array (size, N)
            Equilibria at the starts.
        start, end : array (2, N)
            Places in the unit square.
        shortest : float
            Shortest step, of a line. The nearer to a fold they are to come, the shorter it must be.

        Returns
        -------
        (array (size, N), array (N,))
            Equilibria, and how far they came: 1 at the end.
        """
        X = np.array(X, dtype=float)
        reached, step = np.zeros(X.shape[1]), np.ones(X.shape[1])
        with np.errstate(all="ignore"):
            P = self.plane.vectors(start)
            parity, side = np.linalg.slogdet(self.equations(P)(X)[1])[0], self.side(X, P)
        for _ in range(_STEPS):
            moving = np.flatnonzero((reached < 1.0) & (step >= shortest))
            if not len(moving):
                break
            goal = np.minimum(reached[moving] + step[moving], 1.0)
            at = (1.0 - goal) * start[:, moving] + goal * end[:, moving]
            P = self.plane.vectors(at)
            tried, found, there = self.newton(X[:, moving], P)
            found &= (there == parity[moving]) | (step[moving] <= _CAREFUL)
            found &= self.side(tried, P) == side[moving]
            done = moving[found]
            X[:, done], reached[done] = tried[:, found], goal[found]
            parity[done] = there[found]
            step[done] *= 2.0
            step[moving[~found]] *= 0.5
        return X, reached
