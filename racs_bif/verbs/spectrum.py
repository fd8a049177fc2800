"""The exact characteristic roots of an equilibrium, beside the eigenvalues of its realisation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.fractional.roots import characteristic_roots
from racs_bif.numerics.threads import single_threaded
from racs_bif.results.provenance import SystemInfo, describe
from racs_bif.shelf.load import system_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from racs_bif.fractional.roots import Roots
    from racs_bif.fractional.system import System
    from racs_bif.symbolic.model import Model


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Characteristic roots and eigenvalues at an equilibrium.

    Parameters
    ----------
    roots : Roots
        The exact roots on the principal sheet, right of a line.
    eigenvalues : complex array (n,)
        Eigenvalues of the realisation, all of them, the rightmost first.
    state : dict of str to float
        The equilibrium.
    system : SystemInfo
        What it was computed from.
    """

    roots: Roots
    eigenvalues: NDArray[np.complex128]
    state: Mapping[str, float]
    system: SystemInfo

    @property
    def shifts(self) -> NDArray[np.float64]:
        """Distance of each root to the nearest eigenvalue, relative to the root's modulus, (k,)."""
        apart = np.abs(self.roots.roots[:, None] - self.eigenvalues[None, :])
        if not apart.size:
            return np.zeros(len(self.roots.roots))
        sizes = np.maximum(np.abs(self.roots.roots), 1e-300)
        return np.asarray(apart.min(axis=1) / sizes)

    def to_dataframe(self) -> pd.DataFrame:
        """Return the exact roots as a table: real [1/s], imaginary [rad/s], shift of each."""
        import pandas as pd

        roots = self.roots.roots
        return pd.DataFrame({"real": roots.real, "imag": roots.imag, "shift": self.shifts})

    def plot(self, *, ax: Axes | None = None) -> Axes:
        """Draw roots and eigenvalues; see `racs_bif.plots.spectrum.draw`."""
        from racs_bif.plots.spectrum import draw

        return draw(self, ax=ax)


@single_threaded
def spectrum(model: Model | System, *, above: float = -1.0) -> Spectrum:
    """Find all characteristic roots right of a line at the equilibrium of a model.

    Parameters
    ----------
    model : Model or System
        The model, with its parameter values.
    above : float
        Roots with Re s > above are found [1/s].

    Returns
    -------
    Spectrum

    Raises
    ------
    UsageError
        If `above` is not finite.
    ConvergenceError
        If no equilibrium is found, or the roots cannot be told apart with certainty.

    Examples
    --------
    >>> import racs_bif as rb
    >>> found = rb.spectrum(rb.load_model("racs", parameters={"u": 20}), above=0)
    >>> found.roots.unstable, complex(found.roots.roots[0].round(6))
    (2, (1.805015+7.660547j))
    """
    if not np.isfinite(above):
        msg = f"the line Re s = {above} is nowhere; give a finite number"
        raise UsageError(msg)
    system = system_of(model)
    x = system.equilibrium()
    eigenvalues = np.linalg.eigvals(system.field.f_x(x, system.values)).astype(complex)
    order = np.lexsort((-eigenvalues.imag, -eigenvalues.real))
    return Spectrum(
        roots=characteristic_roots(system, above=above),
        eigenvalues=eigenvalues[order],
        state=dict(zip(system.states, map(float, x), strict=False)),
        system=describe(system),
    )
