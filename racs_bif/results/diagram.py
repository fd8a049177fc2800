"""Branches that belong together."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from racs_bif.errors import UsageError, nearest
from racs_bif.results.same import same

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    import pandas as pd
    from matplotlib.axes import Axes

    from racs_bif.results.branch import Branch
    from racs_bif.results.special import SpecialPoint


class Diagram:
    """A bifurcation diagram: branches with names of their own.

    Branches or special points whose name is taken already are renumbered, in the order given:
    a second PO1 becomes PO2.

    Parameters
    ----------
    *branches : Branch
        At least one.

    Raises
    ------
    UsageError
        If there is no branch.
    """

    branches: tuple[Branch, ...]

    def __init__(self, *branches: Branch) -> None:
        if not branches:
            msg = "a diagram needs at least one branch: Diagram(branch, ...)"
            raise UsageError(msg)
        taken: set[str] = set()
        points_taken: set[str] = set()
        named = []
        for branch in branches:
            name = _free(branch.name, taken)
            names = {p.name: _free(p.name, points_taken) for p in branch.special}
            named.append(_renamed(branch, name, names))
        self.branches = tuple(named)

    def __iter__(self) -> Iterator[Branch]:
        """Iterate over the branches."""
        return iter(self.branches)

    def __len__(self) -> int:
        """Return the number of branches."""
        return len(self.branches)

    def __getitem__(self, name: str) -> Branch | SpecialPoint:
        """Return a branch or a special point by its name.

        Raises
        ------
        UsageError
            If there is neither.
        """
        things: list[Branch | SpecialPoint] = [*self.branches, *self.special_points]
        for thing in things:
            if thing.name == name:
                return thing
        known = [thing.name for thing in things]
        msg = f"the diagram has no '{name}'; {nearest(name, known)}"
        raise UsageError(msg)

    def __eq__(self, other: object) -> bool:
        """Compare bit by bit."""
        if not isinstance(other, Diagram):
            return NotImplemented
        return same(self.branches, other.branches)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        """Return a line for each branch."""
        return "\n".join(map(repr, self.branches))

    def _repr_html_(self) -> str:
        """Return what a notebook shows."""
        from racs_bif.results.shown import diagram_card

        return diagram_card(self)

    @property
    def special_points(self) -> tuple[SpecialPoint, ...]:
        """The special points of all branches."""
        return tuple(point for branch in self.branches for point in branch.special)

    @property
    def early(self) -> bool:
        """True if a branch ended before it had what was asked for."""
        return any(branch.early for branch in self.branches)

    def to_dataframe(self) -> pd.DataFrame:
        """Return all branches as one table, a point a row, named in the column ``branch``."""
        import pandas as pd

        tables = [branch.to_dataframe().assign(branch=branch.name) for branch in self]
        return pd.concat(tables, ignore_index=True)

    def special_table(self) -> pd.DataFrame:
        """Return all special points as a table, a point a row."""
        import pandas as pd

        tables = [branch.special_table().assign(branch=branch.name) for branch in self]
        return pd.concat(tables, ignore_index=True)

    def plot(self, state: str | None = None, *, ax: Axes | None = None) -> Axes:
        """Draw the diagram; see `racs_bif.plots.diagram.draw`."""
        from racs_bif.plots.diagram import draw

        return draw(self, state, ax=ax)


def _free(name: str, taken: set[str]) -> str:
    free, number = name, 1
    while free in taken:
        number += 1
        free = f"{name.rstrip('0123456789')}{number}"
    taken.add(free)
    return free


def _renamed(branch: Branch, name: str, names: Mapping[str, str]) -> Branch:
    if name == branch.name and all(old == new for old, new in names.items()):
        return branch
    special = tuple(replace(p, name=names[p.name], branch=name) for p in branch.special)
    profiles = {names.get(key, key): profile for key, profile in branch.profiles.items()}
    return replace(branch, name=name, special=special, profiles=profiles)
