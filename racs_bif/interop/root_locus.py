"""The eigenvalues along a branch as continuous loci."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.units import SECONDS

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from racs_bif.results.branch import Branch
    from racs_bif.results.special import SpecialPoint
    from racs_bif.symbolic.field import Array

_FAR = 1e100
"""What it costs to pair an eigenvalue with none."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RootLocus:
    """Eigenvalues of equilibria, or multipliers of orbits, along a branch.

    Parameters
    ----------
    parameter : str
        The branch's first active parameter.
    unit : str
        Its unit.
    values : array (npoints,)
        Its values, SI.
    eigenvalues : complex array (npoints, m)
        A column is a continuous locus; NaN where it has no value.
    kind : str
        ``"equilibrium"``, ``"orbit"`` or ``"curve"``: of orbits these are multipliers.
    special : tuple of SpecialPoint
        The branch's special points; their `index` is a row.
    model : str
        Name of the model.
    time_unit : str
        Unit of the time; empty where it has none.
    """

    parameter: str
    unit: str
    values: Array
    eigenvalues: NDArray[np.complex128]
    kind: str
    special: tuple[SpecialPoint, ...]
    model: str
    time_unit: str = SECONDS

    def to_dataframe(self) -> pd.DataFrame:
        """Return the loci as a table of complex columns, indexed by the parameter."""
        import pandas as pd

        index = pd.Index(self.values, name=self.parameter)
        return pd.DataFrame(self.eigenvalues, index=index)

    def plot(
        self,
        *,
        window: tuple[float, float, float, float] | None = None,
        ax: Axes | None = None,
    ) -> Axes:
        """Draw the loci; see `racs_bif.plots.root_locus.draw`."""
        from racs_bif.plots.root_locus import draw

        return draw(self, window=window, ax=ax)


def root_locus(branch: Branch) -> RootLocus:
    """Sort the eigenvalues along a branch into continuous loci.

    From point to point eigenvalues are paired so that the sum of their squared distances to where
    a straight line leads them is least (an assignment problem). Two loci that come so close that
    the steps of the branch do not tell them apart may be exchanged there.

    Parameters
    ----------
    branch : Branch
        Any branch that carries eigenvalues or multipliers.

    Returns
    -------
    RootLocus

    Raises
    ------
    UsageError
        If the branch carries none.

    Examples
    --------
    >>> import racs_bif as rb
    >>> locus = rb.root_locus(rb.continue_equilibria(rb.load_model("racs"), "u", (5, 15)))
    >>> locus.eigenvalues.shape[1]
    18
    """
    spectrum = branch.spectrum
    if not spectrum.size or np.all(np.isnan(spectrum)):
        msg = f"{branch.name} carries no eigenvalues; take a branch of equilibria or of orbits"
        raise UsageError(msg)
    sorted_rows = np.array(spectrum, dtype=np.complex128)
    steps = np.diff(branch.arclength)
    for k in range(1, len(sorted_rows)):
        expected = sorted_rows[k - 1]
        if k > 1 and steps[k - 2] > 0.0:
            ahead = expected + (expected - sorted_rows[k - 2]) * (steps[k - 1] / steps[k - 2])
            expected = np.where(np.isnan(ahead), expected, ahead)
        sorted_rows[k] = sorted_rows[k][_pairing(expected, sorted_rows[k])]
    name = branch.parameters[0]
    return RootLocus(
        parameter=name,
        unit=branch.system.unit(name),
        time_unit=branch.system.time_unit,
        values=branch.parameter,
        eigenvalues=sorted_rows,
        kind=branch.kind,
        special=branch.special,
        model=branch.system.model,
    )


def _pairing(expected: NDArray[np.complex128], found: NDArray[np.complex128]) -> NDArray[np.int64]:
    """Return which of the eigenvalues found continues each locus."""
    from scipy.optimize import linear_sum_assignment

    apart = np.abs(expected[:, None] - found[None, :]) ** 2
    apart = np.where(np.isnan(apart), _FAR, apart)
    return np.asarray(linear_sum_assignment(apart)[1])
