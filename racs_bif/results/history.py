"""A time history as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from racs_bif.errors import UsageError, nearest
from racs_bif.results.same import same
from racs_bif.units import after

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes

    from racs_bif.results.provenance import SystemInfo

Reals = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class TimeHistory:
    """A time history, nt samples long.

    Parameters
    ----------
    times : array (nt,)
        From 0, equidistant [s].
    state_names : tuple of str
        The model's states.
    states : array (nt, n)
        Their values, SI.
    outputs : dict of str to array (nt,)
        Outputs of the fractional elements, then of the model; NaN where an element's output is
        infinite, which it may be at t = 0.
    inputs : dict of str to array (nt,)
        The parameters that moved; where they jump, just before.
    system : SystemInfo
        What it was computed from; parameters that moved have there the values before t = 0.
    operator : str
        "exact" or "realised"; a model without fractional elements is "ordinary".
    method : str
        "bdf2", "l1" or "fast" for the exact operator, otherwise "lsoda" or "radau".
    history : str
        What was before t = 0: "rest", "constant" or "equilibrium".
    step : float
        Size of the steps that were made; NaN where the method chose it [s].
    order : float
        Order of convergence at fixed times; NaN where the method chose it.
    errors : dict of str to float
        Estimated error of states and outputs, see `racs_bif.simulate`; NaN where none was made.
    extrapolated : bool
        Whether two runs were combined to raise the order.
    stopped : str
        Why it ended.
    early : bool
        True where that is not what was asked for.

    Raises
    ------
    ValueError
        If the columns do not have the same length.
    """

    times: Reals
    state_names: tuple[str, ...]
    states: Reals
    outputs: Mapping[str, Reals] = field(default_factory=dict)
    inputs: Mapping[str, Reals] = field(default_factory=dict)
    system: SystemInfo
    operator: str
    method: str
    history: str
    step: float
    order: float
    errors: Mapping[str, float] = field(default_factory=dict)
    extrapolated: bool = False
    stopped: str = ""
    early: bool = False

    def __post_init__(self) -> None:
        """Check that the columns fit together."""
        columns = [self.states, *self.outputs.values(), *self.inputs.values()]
        if {len(column) for column in columns} != {len(self.times)} or self.states.shape[1:] != (
            len(self.state_names),
        ):
            msg = (
                f"a time history of {len(self.times)} samples: columns of another length or number"
            )
            raise ValueError(msg)

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.times)

    def __eq__(self, other: object) -> bool:
        """Compare bit by bit."""
        return same(self, other) if isinstance(other, TimeHistory) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        """Return one line: of what, how long, and how it was computed."""
        end = f"{self.times[-1]:g}{after(self.system.time_unit)}"
        return (
            f"<time history of {self.system.model}: {len(self)} samples to {end}, "
            f"{self.operator} operator by {self.method}, history {self.history}>"
        )

    def _repr_html_(self) -> str:
        """Return what a notebook shows."""
        from racs_bif.results.shown import history_card

        return history_card(self)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all columns: states, outputs, inputs."""
        return tuple(self._columns())

    @property
    def units(self) -> dict[str, str]:
        """Units of all columns by name; empty where the model gives none."""
        return {name: self.system.unit(name) for name in self.names}

    def column(self, name: str) -> Reals:
        """Return a state, output or input (nt,).

        Raises
        ------
        UsageError
            If there is no such column.
        """
        columns = self._columns()
        if name not in columns:
            msg = f"the time history has no '{name}'; {nearest(name, columns)}"
            raise UsageError(msg)
        return columns[name]

    def extremes(self, name: str, *, after: float = 0.0) -> tuple[float, float]:
        """Return the least and the greatest value of a column, between samples too.

        Parameters
        ----------
        name : str
            State, output or input.
        after : float
            From which time on [s].

        Raises
        ------
        UsageError
            If there is no such column or it has fewer than eight samples from then on.
        """
        from racs_bif.simulation import signals

        return signals.extremes(*self._after(name, after))

    def period(self, name: str, *, after: float = 0.0) -> float:
        """Return the mean period [s] of a column, NaN where it does not repeat.

        Parameters
        ----------
        name : str
            State, output or input.
        after : float
            From which time on [s].

        Raises
        ------
        UsageError
            If there is no such column or it has fewer than eight samples from then on.
        """
        from racs_bif.simulation import signals

        return signals.period(*self._after(name, after))

    def to_dataframe(self) -> pd.DataFrame:
        """Return the history as a table, a sample a row, indexed by time."""
        import pandas as pd

        return pd.DataFrame(self._columns(), index=pd.Index(self.times, name="time"))

    def to_xarray(self) -> xr.Dataset:
        """Return the history as a data set over the dimension ``time``, with units."""
        from racs_bif.results.arrays import history_dataset

        return history_dataset(self)

    def plot(self, *names: str, ax: Axes | None = None) -> Axes:
        """Draw one column, or several, against time.

        Parameters
        ----------
        *names : str
            Columns; by default what the model suggests.
        ax : Axes, optional
            Where to draw; a new figure by default.

        Raises
        ------
        UsageError
            If there is no such column.
        """
        from racs_bif.plots.history import draw

        return draw(self, *names, ax=ax)

    def _after(self, name: str, after: float) -> tuple[Reals, Reals]:
        column = self.column(name)
        kept = (self.times >= after) & np.isfinite(column)
        return self.times[kept], column[kept]

    def _columns(self) -> dict[str, Reals]:
        columns = dict(zip(self.state_names, self.states.T, strict=True))
        return columns | dict(self.outputs) | dict(self.inputs)
