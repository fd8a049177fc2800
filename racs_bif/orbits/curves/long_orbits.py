"""Orbits of one long period in two parameters: the curve of the homoclinic orbit nearby.

A homoclinic orbit is approached by orbits of growing period T, lambda_1(T) - lambda_1 = C e^(-nu T)
with nu the slower of the rates at which it leaves and reaches its saddle (Yu. A. Kuznetsov,
*Elements of Applied Bifurcation Theory*, chapter 6). So lambda_1'(T) / nu tells how far the curve
of fixed T is from that of T = infinity; it is reported with every point.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.orbits.collocation import CollocationProblem
from racs_bif.orbits.equations import Equations
from racs_bif.orbits.slow_passages import saddles_of

if TYPE_CHECKING:
    from racs_bif.continuation.points import Point
    from racs_bif.continuation.problem import Bound
    from racs_bif.continuation.stopped import Stopped
    from racs_bif.orbits.collocation_settings import CollocationSettings
    from racs_bif.orbits.equations import Collocated
    from racs_bif.orbits.piecewise import Piecewise
    from racs_bif.orbits.reference import Reference
    from racs_bif.symbolic.field import Array, VectorField
    from racs_bif.symbolic.paths import ParameterPath


class _HeldPeriod(Equations):
    """Collocation equations whose unknowns beside the orbit are two parameters."""

    def columns(self, at: Collocated) -> Array:
        """Return the derivatives (2, N, m, n) of tau f by the parameters."""
        return super().columns(at)[1:]


class LongOrbits(CollocationProblem):
    """Orbits of one period; z = (X, lambda_1, g, lambda_2).

    Parameters
    ----------
    field : VectorField
        The right-hand side.
    path : ParameterPath
        The two active parameters.
    first : (Reference, Piecewise)
        Phase condition and guess of the first orbit.
    period : float
        The period.
    spans : pair of (float, float)
        Intervals of the parameters; the engine is given the second.
    settings : CollocationSettings
        How orbits are resolved.
    """

    def __init__(
        self,
        field: VectorField,
        path: ParameterPath,
        first: tuple[Reference, Piecewise],
        period: float,
        spans: tuple[tuple[float, float], tuple[float, float]],
        settings: CollocationSettings,
    ) -> None:
        super().__init__(field, path, *first, settings)
        self.name = "orbits of one long period by collocation"
        self.parameter = path.names[1]
        self.equations = _HeldPeriod(field, path)
        self._period, self.spans = period, spans

    def period(self, z: Array) -> float:
        """Return the period, the same for all."""
        del z
        return self._period

    def active(self, z: Array) -> Array:
        """Return the two parameters."""
        return np.array((z[-3], z[-1]))

    def base(self, z: Array) -> Array:
        """Return the base parameters (np,)."""
        return self.path.vector(self.active(z))

    def place(self, measure: str) -> None:
        """Return None: the period is no unknown."""
        del measure

    def scales(self, z: Array) -> Array:
        """Return magnitudes of the unknowns; the first parameter counts like the second."""
        scales = super().scales(z)
        low, high = self.spans[0]
        scales[-2] = (high - low) / np.sqrt(len(z) - 1.0)
        return scales

    def bounds(self) -> tuple[Bound, ...]:
        """Return the span of the first parameter."""
        return ((-3, *self.spans[0]),)

    def ends(self, point: Point) -> Stopped | None:
        """Return why the curve ends here: no amplitude left."""
        return self.vanished if self.degenerate(point.z) else None

    def measures(self, z: Array) -> dict[str, float]:
        """Return what every orbit has, the distance from the homoclinic curve, and its saddle.

        ``shift``: how far the first parameter is from its value at infinite period; ``saddle
        quantity``: sum of the leading eigenvalues. NaN where no saddle is passed.
        """
        shift, quantity = self.homoclinic(z)
        return super().measures(z) | {"shift": shift, "saddle quantity": quantity}

    def homoclinic(self, z: Array) -> tuple[float, float]:
        """Return the shift of the first parameter and the saddle quantity; see `measures`."""
        saddles = saddles_of(self, z, len(self.field.states))
        if not saddles:
            return float("nan"), float("nan")
        rate = min(saddle.slowest for saddle in saddles)
        slope = self._slope(z)
        return -slope / rate, sum(saddle.quantity for saddle in saddles)

    def _slope(self, z: Array) -> float:
        """Return the derivative of the first parameter by the period, the second one held."""
        at, row = self.at(z), np.zeros(len(z))
        row[-1] = 1.0
        rhs = np.zeros(len(z))
        forcing = at.curve.mesh.widths[:, None, None] * at.rates / self.reference(z).scales
        rhs[:-3] = forcing.ravel()
        return float(self.bordered(z, row)(rhs)[-3])
