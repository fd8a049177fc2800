"""Realisations of a model's fractional elements, side by side."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import RacsBifError, UsageError
from racs_bif.fractional.compare import Comparison, compare
from racs_bif.fractional.fitted import Fitted, fit_to_hopf
from racs_bif.fractional.realisations import REALISATIONS, choose_realisation
from racs_bif.numerics.threads import single_threaded
from racs_bif.results.provenance import SystemInfo, describe
from racs_bif.shelf.load import system_of
from racs_bif.verbs.equilibria import continue_equilibria

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from racs_bif.fractional.filter import Realisation
    from racs_bif.fractional.laws import Complex
    from racs_bif.fractional.system import System
    from racs_bif.results.special import SpecialPoint
    from racs_bif.symbolic.model import Model


@dataclass(frozen=True, eq=False)
class RealisationTable:
    """Realisations compared.

    Parameters
    ----------
    rows : tuple of Comparison
        One for each, in the order of their names in `REALISATIONS`.
    omega : array (m,)
        Frequencies [rad/s] of `errors`.
    errors : dict of str to array (m,)
        Error of each realised law over the exact one at these frequencies, the worst of all
        elements; realisations that refuse a law are left out.
    hopf : dict of str to float
        The exact Hopf point that was compared, with ``omega``; empty without one.
    system : SystemInfo
        What it was computed from.
    """

    rows: tuple[Comparison, ...]
    omega: NDArray[np.float64]
    errors: Mapping[str, NDArray[np.float64]]
    hopf: Mapping[str, float]
    system: SystemInfo


@single_threaded
def compare_realisations(
    model: Model | System,
    *,
    along: tuple[str, float, float] | None = None,
    band: tuple[float, float] | None = None,
    order: int = 0,
) -> RealisationTable:
    """Compare all realisations on a model, and by the Hopf point that each yields.

    Parameters
    ----------
    model : Model or System
        A model with fractional elements.
    along : (str, float, float), optional
        Parameter and span in which the Hopf point is looked for that is compared; none where left
        out.
    band : (float, float), optional
        Band of the realisations [rad/s]; the model's own where left out.
    order : int
        Order or sections of each; 0 takes each one's default.

    Returns
    -------
    RealisationTable

    Raises
    ------
    UsageError
        If the model has no fractional element, or there is no Hopf point in the span.
    """
    system = system_of(model)
    if not system.fractional:
        msg = f"model '{system.name}' has no fractional element to realise; take one that has"
        raise UsageError(msg)
    chosen = band or system.settings.band
    hopf = None if along is None else first_hopf(system, along[0], (along[1], along[2]))
    wanted = [choose_realisation(name, chosen, order=order) for name in REALISATIONS]
    estimate = None
    found: dict[str, float] = {}
    if hopf is not None and hopf.exact is not None and along is not None:
        value, omega = hopf.exact.parameters[along[0]], hopf.exact.omega
        estimate = (along[0], value, omega)
        found = {along[0]: value, "omega": omega}
        wanted = [replace(r, omega=omega) if isinstance(r, Fitted) else r for r in wanted]
    rows = compare(system, wanted, band=chosen, hopf=estimate)
    frequencies = np.geomspace(0.1 * chosen[0], 10.0 * chosen[1], 400)
    errors = {
        row.name: _errors(system, realisation, frequencies)
        for row, realisation in zip(rows, wanted, strict=True)
        if not row.refused
    }
    return RealisationTable(tuple(rows), frequencies, errors, found, describe(system))


def _errors(
    system: System, realisation: Realisation, frequencies: NDArray[np.float64]
) -> NDArray[np.float64]:
    s: Complex = np.asarray(1j * frequencies, dtype=np.complex128)
    laws = system.field.laws(system.values)
    each = [np.abs(realisation.realise(law)(s) / law(s) - 1.0) for law in laws]
    worst: NDArray[np.float64] = np.max(each, axis=0)
    return worst


def first_hopf(system: System, parameter: str, span: tuple[float, float]) -> SpecialPoint:
    """Return the first Hopf point on the branch of equilibria through the model's guess.

    Raises
    ------
    UsageError
        If there is none in the span.
    """
    branch = continue_equilibria(system, parameter, span)
    for point in branch.special:
        if point.label == "H" and point.exact is not None:
            return point
    msg = f"no Hopf point for {parameter} in {span[0]:g} .. {span[1]:g}; give another span"
    raise UsageError(msg)


def fitted(system: System, parameter: str, span: tuple[float, float]) -> System:
    """Return a system with its realisation fitted to its first Hopf point in a span.

    A system that has none there is returned as it is.
    """
    try:
        hopf = first_hopf(system, parameter, span)
    except RacsBifError:
        return system
    assert hopf.exact is not None  # first_hopf has looked
    value = hopf.exact.parameters[parameter]
    order = getattr(system.settings, "order", 0)
    return fit_to_hopf(system, parameter, value, hopf.exact.omega, order=order)
