"""A period-doubling cascade as data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.results.diagram import Diagram

if TYPE_CHECKING:
    import pandas as pd
    from numpy.typing import NDArray

    from racs_bif.results.branch import Branch
    from racs_bif.results.special import SpecialPoint

FEIGENBAUM: Final = 4.669201609102990
"""The ratio that the distances between doublings tend to (M. J. Feigenbaum, 1978)."""


@dataclass(frozen=True, eq=False)
class Cascade:
    """Branches of orbits of once, twice, four times the period, and the doublings between them.

    Parameters
    ----------
    branches : tuple of Branch
        Each as far as its doubling.
    doublings : tuple of SpecialPoint
        The period doublings, one of each branch that has one.
    stopped : str
        Why it goes no further.
    """

    branches: tuple[Branch, ...]
    doublings: tuple[SpecialPoint, ...]
    stopped: str

    def __repr__(self) -> str:
        """Return a line for each doubling: where, its period, the ratio."""
        ratios = ["", "", *(f"{ratio:.6g}" for ratio in self.ratios)]
        rows = [
            f"{point.branch}: {self.parameter} = {point.parameters[self.parameter]:.12g}, "
            f"period {point.period:.10g}{', ratio ' + ratio if ratio else ''}"
            for point, ratio in zip(self.doublings, ratios, strict=False)
        ]
        return "\n".join([*rows, self.stopped])

    @property
    def parameter(self) -> str:
        """The active parameter."""
        return self.branches[0].parameters[0]

    @property
    def values(self) -> NDArray[np.float64]:
        """Values of the parameter at the doublings."""
        return np.array([point.parameters[self.parameter] for point in self.doublings])

    @property
    def ratios(self) -> NDArray[np.float64]:
        """Each distance between doublings over the next: they tend to `FEIGENBAUM`."""
        steps = np.diff(self.values)
        return np.asarray(steps[:-1] / steps[1:])

    @property
    def limit(self) -> tuple[float, float]:
        """Where the cascade ends in chaos, by the Feigenbaum number, and how uncertain that is.

        Raises
        ------
        UsageError
            If there are fewer than three doublings.
        """
        values = self.values
        if len(values) < 3:
            told = f"{len(values)} of 3 doublings do not tell where a cascade ends"
            msg = f"{told}; follow it to depth=3 or deeper"
            raise UsageError(msg)
        ends = values[1:] + np.diff(values) / (FEIGENBAUM - 1.0)
        return float(ends[-1]), float(abs(ends[-1] - ends[-2]))

    def to_dataframe(self) -> pd.DataFrame:
        """Return the doublings as a table: parameter, period, ratio of distances."""
        import pandas as pd

        count = len(self.doublings)
        ratios = np.full(count, np.nan)
        ratios[2:] = self.ratios
        return pd.DataFrame(
            {
                "branch": [point.branch for point in self.doublings],
                self.parameter: self.values,
                "period": [point.period for point in self.doublings],
                "ratio": ratios,
            }
        )

    @property
    def diagram(self) -> Diagram:
        """All branches together."""
        return Diagram(*self.branches)
