"""Special points: where something happens on a branch, and what was found out there."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from racs_bif.labels import LABELS
from racs_bif.results.same import same

if TYPE_CHECKING:
    from collections.abc import Mapping

Value = bool | int | float | complex | str | NDArray[np.generic]
"""What a detector may find out about a point."""
OPERATING = frozenset({"EP", "MX", "UZ"})
"""Labels of points that are marked without anything happening to the dynamics."""


@dataclass(frozen=True, kw_only=True)
class ExactPoint:
    """The same point on the exact, fractional characteristic function.

    Parameters
    ----------
    parameters : dict of str to float
        Where it is.
    omega : float
        Its frequency, rad/s.
    shift : dict of str to float
        What the realisation is off by: (realised - exact) / exact, for each active parameter and
        for ``omega``.
    l1 : float, optional
        First Lyapunov coefficient of the exact operator, at a Hopf point.
    """

    parameters: Mapping[str, float]
    omega: float
    shift: Mapping[str, float]
    l1: float | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class SpecialPoint:
    """A labelled point of a branch.

    Everything a detector found is in `data` and may be read as an attribute: ``hopf.omega``.

    Parameters
    ----------
    label, name, branch : str
        Kind ("H"), name on its branch ("H1"), name of the branch ("EQ1").
    parameters : dict of str to float
        The active parameters.
    state : dict of str to float
        The model's own states; on an orbit, where the phase condition puts its beginning.
    data : dict
        Numbers, words and arrays: omega, l1, criticality, period, multipliers, ... Entries that
        are None are left out.
    exact : ExactPoint, optional
        The point re-solved on the exact operator.
    index : int
        Its place among the branch's points.
    origin : object
        What is needed to start another branch here; neither saved nor compared.
    """

    label: str
    name: str
    branch: str = ""
    parameters: Mapping[str, float] = field(default_factory=dict)
    state: Mapping[str, float] = field(default_factory=dict)
    data: Mapping[str, Value] = field(default_factory=dict)
    exact: ExactPoint | None = None
    index: int = -1
    origin: object = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        """Turn numpy's scalars into Python's and lists into arrays: what a file gives back."""
        plain = {key: _plain(value) for key, value in self.data.items() if value is not None}
        object.__setattr__(self, "data", plain)
        for key in ("parameters", "state"):
            numbers = {name: float(value) for name, value in getattr(self, key).items()}
            object.__setattr__(self, key, numbers)

    def __eq__(self, other: object) -> bool:
        """Compare bit by bit, `origin` excepted."""
        return same(self, other) if isinstance(other, SpecialPoint) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def __getattr__(self, name: str) -> Value:
        """Return what a detector found under this name.

        Raises
        ------
        AttributeError
            If it found no such thing; the message names what there is.
        """
        if name.startswith("__") or "data" not in self.__dict__:
            raise AttributeError(name)
        if name not in self.data:
            found = ", ".join(self.data) or "nothing more"
            msg = f"{self.name} ({self.title}) has no '{name}'; it has: {found}"
            raise AttributeError(msg)
        return self.data[name]

    def _repr_html_(self) -> str:
        """Return what a notebook shows."""
        from racs_bif.results.shown import point_card

        return point_card(self)

    @property
    def title(self) -> str:
        """The kind of point in words."""
        return LABELS[self.label].title if self.label in LABELS else self.label

    @property
    def omega(self) -> float:
        """Frequency of the critical pair, rad/s."""
        return self._number("omega")

    @property
    def l1(self) -> float:
        """First Lyapunov coefficient in Kuznetsov's normalisation, c1 / omega."""
        return self._number("l1")

    @property
    def period(self) -> float:
        """Period of the orbit, s."""
        return self._number("period")

    @property
    def criticality(self) -> str:
        """``"supercritical"`` or ``"subcritical"``."""
        return str(self.__getattr__("criticality"))

    def _number(self, name: str) -> float:
        return float(self.__getattr__(name))  # type: ignore[arg-type]


def _plain(value: object) -> Value:
    if isinstance(value, np.ndarray) and value.ndim:
        return value
    if isinstance(value, list | tuple):
        return np.asarray(value)
    if isinstance(value, np.generic | np.ndarray):
        value = value.item()
    if not isinstance(value, bool | int | float | complex | str):
        msg = f"special points hold numbers, words and arrays, not {type(value).__name__}"
        raise TypeError(msg)
    return value
