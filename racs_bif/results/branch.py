"""A branch as data: columns along the arclength, special points, and why it ended."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from racs_bif.errors import UsageError, nearest
from racs_bif.results.same import same

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes

    from racs_bif.results.provenance import SystemInfo
    from racs_bif.results.special import SpecialPoint

Reals = NDArray[np.float64]
_SAME_VALUE = 1e-12


@dataclass(frozen=True, kw_only=True, eq=False)
class Profile:
    """One period of an orbit.

    Parameters
    ----------
    times : array (nt,)
        From 0 to the period, s.
    names : tuple of str
        The states.
    states : array (nt, n)
        Their values, SI.
    """

    times: Reals
    names: tuple[str, ...]
    states: Reals

    def __eq__(self, other: object) -> bool:
        """Compare bit by bit."""
        return same(self, other) if isinstance(other, Profile) else NotImplemented

    __hash__ = None  # type: ignore[assignment]


@dataclass(frozen=True, kw_only=True, eq=False)
class Branch:
    """A branch of equilibria or of periodic orbits, npoints long.

    Parameters
    ----------
    name : str
        "EQ1", "PO1".
    kind : str
        "equilibrium", "orbit" or "curve".
    parameters : tuple of str
        Active parameters.
    values : array (npoints, number of active parameters)
        Their values, SI.
    arclength : array (npoints,)
        Scaled arclength.
    stable : bool array (npoints,)
        Stability; False where it is not known.
    unstable : int array (npoints,)
        Number of unstable eigenvalues or multipliers; -1 where it is not known.
    spectrum : complex array (npoints, m)
        Eigenvalues or multipliers, padded with NaN.
    labels : tuple of str
        Label of each point, empty for most.
    state_names : tuple of str
        Names of the columns of `states`, the model's own first.
    states : array (npoints, n)
        States of equilibria; n may be 0 for orbits.
    measures : dict of str to array (npoints,)
        What may be plotted: ``"max delta_c"``, ``"min delta_c"``, ``"period"``.
    special : tuple of SpecialPoint
        Special, user and end points in the order of the branch.
    stopped : str
        Why the branch ended and what to do about it.
    early : bool
        True where that is not what was asked for.
    system : SystemInfo
        What it was computed from.
    method : str
        How: "shooting", ...
    profiles : dict of str to Profile
        One period of the orbit at special points, under their names.
    samples : dict of int to Profile
        One period of orbits along the branch, under their places among its points.
    connected : bool
        Whether it is connected to the first branch of the diagram through special points.
    origin : object
        The system itself, from which `at` solves for points; neither saved nor compared.

    Raises
    ------
    ValueError
        If the columns do not have the same length.
    """

    name: str
    kind: str
    parameters: tuple[str, ...]
    values: Reals
    arclength: Reals
    stable: NDArray[np.bool_]
    unstable: NDArray[np.int64]
    spectrum: NDArray[np.complex128]
    labels: tuple[str, ...]
    stopped: str
    early: bool
    system: SystemInfo
    state_names: tuple[str, ...] = ()
    states: Reals = field(default_factory=lambda: np.empty((0, 0)))
    measures: Mapping[str, Reals] = field(default_factory=dict)
    special: tuple[SpecialPoint, ...] = ()
    method: str = ""
    profiles: Mapping[str, Profile] = field(default_factory=dict)
    samples: Mapping[int, Profile] = field(default_factory=dict)
    connected: bool = True
    origin: object = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        """Bring the columns to their types and check that they fit together."""
        count = len(self.labels)
        freeze = object.__setattr__
        values = np.asarray(self.values, dtype=float)
        freeze(self, "values", values.reshape(len(values), -1))
        freeze(self, "arclength", np.asarray(self.arclength, dtype=float))
        freeze(self, "stable", np.asarray(self.stable, dtype=bool))
        freeze(self, "unstable", np.asarray(self.unstable, dtype=np.int64))
        freeze(self, "spectrum", np.asarray(self.spectrum, dtype=complex).reshape(count, -1))
        freeze(self, "labels", tuple(self.labels))
        freeze(self, "special", tuple(self.special))
        freeze(self, "measures", {k: np.asarray(v, float) for k, v in self.measures.items()})
        states = np.asarray(self.states, dtype=float)
        freeze(self, "states", states if states.size else np.empty((count, len(self.state_names))))
        columns = [self.values, self.arclength, self.stable, self.unstable, self.spectrum]
        columns += [self.states, *self.measures.values()]
        widths = (self.values.shape[1], self.states.shape[1])
        if {len(column) for column in columns} != {count} or widths != (
            len(self.parameters),
            len(self.state_names),
        ):
            msg = f"branch {self.name}: its columns are not all {count} points long, or lack names"
            raise ValueError(msg)

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.labels)

    def __eq__(self, other: object) -> bool:
        """Compare bit by bit; what special points start from is left out."""
        return same(self, other) if isinstance(other, Branch) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        """Return one line: what, where, how long, and its special points."""
        names = ", ".join(point.name for point in self.special) or "none"
        ends = f"{self.values[0, 0]:.6g} to {self.values[-1, 0]:.6g}" if len(self) else "empty"
        return (
            f"<{self.kind} branch {self.name}: {len(self)} points, "
            f"{self.parameters[0]} {ends}, special points: {names}>"
        )

    def _repr_html_(self) -> str:
        """Return what a notebook shows."""
        from racs_bif.results.shown import branch_card

        return branch_card(self)

    @property
    def parameter(self) -> Reals:
        """The first active parameter along the branch, (npoints,)."""
        first: Reals = self.values[:, 0]
        return first

    def __getitem__(self, name: str | int) -> SpecialPoint:
        """Return a special point by its name.

        Raises
        ------
        UsageError
            If there is none; the message names those there are.
        """
        if not isinstance(name, str):
            msg = f"branch {self.name} is asked for a special point by its name, not by {name!r}"
            raise UsageError(f"{msg}; take .values[{name!r}] or .column(NAME)[{name!r}] for a row")
        for point in self.special:
            if point.name == name:
                return point
        hint = nearest(name, [point.name for point in self.special])
        msg = f"branch {self.name} has no special point '{name}'; {hint}"
        raise UsageError(msg)

    def column(self, quantity: str) -> Reals:
        """Return a parameter, state or measure along the branch, (npoints,).

        Raises
        ------
        UsageError
            If the branch has no such column.
        """
        columns = self._columns()
        if quantity not in columns:
            msg = f"branch {self.name} has no '{quantity}'; {nearest(quantity, columns)}"
            raise UsageError(msg)
        return columns[quantity]

    def at(self, **values: float) -> SpecialPoint:
        """Return the point at a value of an active parameter, computed exactly.

        A labelled point that is there is returned. Otherwise, on a branch of equilibria, the
        operating point is solved for.

        Raises
        ------
        UsageError
            If there is no such point, or there are several.
        ConvergenceError
            If the point cannot be solved for.

        Examples
        --------
        >>> import racs_bif as rb
        >>> branch = rb.continue_equilibria(rb.load_model("racs"), "u", (5, 15))
        >>> point = branch.at(u=12)
        >>> round(point.state["delta_c"], 6), point.unstable
        (-0.004621, 2)
        """
        for name in values:
            if name not in self.parameters:
                msg = f"'{name}' is not active on {self.name}; {nearest(name, self.parameters)}"
                raise UsageError(msg)
        where = ", ".join(f"{name}={value:g}" for name, value in values.items())
        found = [point for point in self.special if _is_at(point, values)]
        solvable = self.kind == "equilibrium" and self.system.equations
        if not found and solvable:
            from racs_bif.verbs.operating_point import solve_at

            return solve_at(self, float(values[self.parameters[0]]))
        if not found:
            numbers = ", ".join(f"{value:g}" for value in values.values())
            msg = (
                f"no point of {self.name} was computed exactly at {where}; "
                f"ask for it with at=({numbers},) when continuing"
            )
            raise UsageError(msg)
        if len(found) > 1:
            names = ", ".join(point.name for point in found)
            msg = f"{self.name} passes {where} more than once: take one of {names} by name"
            raise UsageError(msg)
        if found[0].origin is None and solvable:
            from racs_bif.verbs.operating_point import with_origin

            return with_origin(self, found[0])
        return found[0]

    def to_dataframe(self) -> pd.DataFrame:
        """Return the branch as a table, a point a row: parameters, states, measures, stability."""
        import pandas as pd

        columns: dict[str, object] = dict(self._columns())
        columns |= {"stable": self.stable, "unstable": self.unstable, "label": list(self.labels)}
        return pd.DataFrame(columns)

    def to_xarray(self) -> xr.Dataset:
        """Return the branch as a data set; see `racs_bif.results.arrays.branch_dataset`."""
        from racs_bif.results.arrays import branch_dataset

        return branch_dataset(self)

    def special_table(self) -> pd.DataFrame:
        """Return the special points as a table, a point a row, with numbers and words only."""
        import pandas as pd

        rows = []
        for point in self.special:
            row: dict[str, object] = {"name": point.name, "label": point.label}
            row |= point.parameters
            if point.exact is not None:
                row |= {f"{name} exact": value for name, value in point.exact.parameters.items()}
            # A user value's data has a name too: that of what was asked for.
            plain = {k: v for k, v in point.data.items() if not isinstance(v, np.ndarray)}
            row = plain | row if "name" in plain else row | plain
            rows.append(row)
        return pd.DataFrame(rows)

    def plot(self, state: str | None = None, *, ax: Axes | None = None) -> Axes:
        """Draw the branch as a diagram of its own; a curve in the plane of its parameters."""
        if self.kind == "curve":
            from racs_bif.plots.curve import draw as draw_curve

            return draw_curve([self], ax=ax)
        from racs_bif.plots.diagram import draw
        from racs_bif.results.diagram import Diagram

        return draw(Diagram(self), state, ax=ax)

    def plot_profiles(self, *names: str, state: str | None = None, ax: Axes | None = None) -> Axes:
        """Draw one period of orbits; see `racs_bif.plots.orbit_profiles.draw_profile`."""
        from racs_bif.plots.orbit_profiles import draw_profile

        return draw_profile(self, names, state, ax=ax)

    def plot_phase(
        self, *names: str, states: tuple[str, str] | None = None, ax: Axes | None = None
    ) -> Axes:
        """Draw orbits in a plane; see `racs_bif.plots.orbit_profiles.draw_phase`."""
        from racs_bif.plots.orbit_profiles import draw_phase

        return draw_phase(self, names, states, ax=ax)

    def plot_multipliers(self, name: str | None = None, *, ax: Axes | None = None) -> Axes:
        """Draw multipliers along the branch, or those of one orbit with the unit circle."""
        from racs_bif.plots.orbit_multipliers import draw_circle, draw_multipliers

        return draw_multipliers(self, ax=ax) if name is None else draw_circle(self, name, ax=ax)

    def plot_period(self, *, ax: Axes | None = None) -> Axes:
        """Draw the period along the branch; see `racs_bif.plots.orbit.draw_period`."""
        from racs_bif.plots.orbit import draw_period

        return draw_period(self, ax=ax)

    def _columns(self) -> dict[str, Reals]:
        columns = dict(zip(self.parameters, self.values.T, strict=True))
        columns |= dict(zip(self.state_names, self.states.T, strict=True))
        return columns | dict(self.measures)


def _is_at(point: SpecialPoint, values: Mapping[str, float]) -> bool:
    return all(
        abs(point.parameters[name] - value) <= _SAME_VALUE * max(1.0, abs(value))
        for name, value in values.items()
    )
