"""A map over the plane of a stability chart as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from racs_bif.results.same import same
from racs_bif.units import rate_unit

if TYPE_CHECKING:
    from racs_bif.results.provenance import SystemInfo

Reals = NDArray[np.float64]
STATUS = ("certain", "not settled", "failed", "no equilibrium")
"""What the numbers of `SweepMap.status` mean."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SweepMap:
    """What simulations of the realised model settled on, (n1, n2) cells.

    Parameters
    ----------
    value : array (n1, n2)
        Half the range of a state (``amplitude``, its unit), the largest Lyapunov exponent
        (``lyapunov``, 1/s), or the number of crossings of a section in which the orbit repeats
        (``periods``; 0 at rest, infinite where it does not repeat). NaN where it is not certain.
    error : array (n1, n2)
        How much the amplitude changed over the last quarter of the duration, or what is left of it
        at rest; the exponent's standard error; how far from repeating the crossings are, of the
        range.
    status : int8 array (n1, n2)
        0 certain, 1 not settled by the end, 2 failed, 3 no equilibrium to start from.
    watch : str
        The state.
    duration : float
        Of each simulation [s].
    tolerance : float
        Relative error of a step.
    start : dict of str to float
        States at t = 0 that were given.
    """

    value: Reals
    error: Reals
    status: NDArray[np.int8]
    watch: str
    duration: float
    tolerance: float
    start: Mapping[str, float] = field(default_factory=dict)

    def __eq__(self, other: object) -> bool:
        """Compare bit by bit."""
        return same(self, other) if isinstance(other, SweepMap) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    @property
    def tally(self) -> dict[str, int]:
        """Numbers of cells by what is known of them."""
        return {text: int((self.status == k).sum()) for k, text in enumerate(STATUS)}


@dataclass(frozen=True, kw_only=True, eq=False)
class ChartMap:
    """A map over the plane, (n1, n2) cells, each computed at its middle.

    Parameters
    ----------
    quantity : {"count", "damping", "amplitude", "lyapunov", "periods"}
        What was asked for.
    unstable : int8 array (n1, n2)
        Number of unstable roots; -1 where they could not be counted, -2 without an equilibrium.
    sigma, omega : array (n1, n2)
        Rightmost root, 1/s and rad/s; NaN where it is not certain, and but for a map of damping.
    evaluations : int
        Determinants that it took, and steps of simulations.
    sweep : SweepMap, optional
        What simulations tell, where they were asked for.
    """

    quantity: str
    unstable: NDArray[np.int8]
    sigma: Reals
    omega: Reals
    evaluations: int
    sweep: SweepMap | None = None

    def __eq__(self, other: object) -> bool:
        """Compare bit by bit."""
        return same(self, other) if isinstance(other, ChartMap) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    @property
    def shown(self) -> Reals | None:
        """What fills the plane of a picture (n1, n2); None for a map of counts."""
        if self.sweep is not None:
            return self.sweep.value
        return self.sigma if self.quantity == "damping" else None

    @property
    def unknown(self) -> int:
        """Number of cells of which nothing is certain."""
        if self.sweep is not None:
            return int(np.count_nonzero(self.sweep.status))
        return int((self.unstable < 0).sum())

    def unit(self, system: SystemInfo) -> str:
        """Return the unit of `shown`."""
        if self.quantity == "amplitude" and self.sweep is not None:
            return system.unit(self.sweep.watch)
        rates = self.quantity in {"damping", "lyapunov"}
        return rate_unit(system.time_unit) if rates else ""
