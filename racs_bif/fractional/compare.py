"""Realisations side by side, on one system."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ConvergenceError, ParameterError
from racs_bif.fractional.exact_hopf import ExactHopf, solve_hopf
from racs_bif.fractional.fitted import Fitted
from racs_bif.fractional.realised_hopf import solve_realised_hopf
from racs_bif.fractional.residues import imaginary_axis

if TYPE_CHECKING:
    from collections.abc import Iterable

    from racs_bif.fractional.filter import Filter, Realisation
    from racs_bif.fractional.laws import Complex, Law
    from racs_bif.fractional.system import System
    from racs_bif.symbolic.field import Array
    from racs_bif.symbolic.paths import ParameterPath

_ROUNDING = 1e-9


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """What a realisation makes of the laws of a system; the worst of several elements.

    Parameters
    ----------
    name : str
        Name of the realisation.
    states : int
        Number of memory states.
    band : (float, float)
        The realisation's own band [rad/s].
    static_gain : float
        Z(0) of the realised law, of the first element; infinite where it integrates.
    static_error : float
        Largest difference of Z(0) from the exact law's, relative to it (absolute where that is 0);
        0 where both are infinite.
    error : float
        Largest error of the frequency response over the compared band, relative to the exact law's.
    largest_pole : float
        Largest real part of the poles, without those at 0 of laws that integrate [rad/s].
    real_poles : bool
        Whether all these poles are real and negative.
    passive : bool
        Whether Im Z(i omega) >= 0 at all frequencies, so that force over displacement, as which an
        element is read here, takes energy and gives none.
    hopf_error : float, optional
        Relative error of the parameter at the Hopf point; None where there is no such point.
    omega_error : float, optional
        Relative error of the frequency there.
    refused : str
        Why the realisation cannot be had; the numbers are then NaN.
    """

    name: str
    states: int
    band: tuple[float, float]
    static_gain: float
    static_error: float
    error: float
    largest_pole: float
    real_poles: bool
    passive: bool
    hopf_error: float | None = None
    omega_error: float | None = None
    refused: str = ""


def compare(
    system: System,
    realisations: Iterable[Realisation],
    *,
    band: tuple[float, float] | None = None,
    hopf: tuple[str, float, float] | None = None,
    X: Array | None = None,
) -> list[Comparison]:
    """Compare realisations of a system's laws.

    Parameters
    ----------
    system : System
        The system, at whose parameters the laws are taken.
    realisations : iterable of Realisation
        What is compared. A fitted one is put on the exact Hopf point's frequency if `hopf` is
        given.
    band : (float, float), optional
        Frequencies [rad/s] over which errors are taken; the system's band where left out.
    hopf : (str, float, float), optional
        Parameter, and estimates of its value and of the frequency [rad/s] at the Hopf point that is
        compared.
    X : array (size,), optional
        Estimate of states and element outputs there; the equilibrium near the model's guess where
        left out.

    Returns
    -------
    list of Comparison
        One row for each, in their order; one that refuses a law says so in its row.

    Raises
    ------
    ConvergenceError
        If the exact model has no Hopf point near `hopf`.
    """
    low, high = band or system.settings.band
    exact, path = None, None
    if hopf is not None:
        parameter, value, omega = hopf
        path = system.path(parameter)
        if X is None:
            p = path.vector(value)
            X = system.exact_point(system.equilibrium(p), p)
        exact = solve_hopf(system.exact, path, X, value, omega)
    rows = []
    for realisation in realisations:
        settings = realisation
        if isinstance(settings, Fitted) and exact is not None:
            settings = replace(settings, omega=exact.omega)
        try:
            row = _row(replace(system, settings=settings), (low, high))
        except ParameterError as error:
            rows.append(_refusal(settings, str(error)))
            continue
        if exact is not None and path is not None:
            row = _with_hopf(row, replace(system, settings=settings), path, exact)
        rows.append(row)
    return rows


def _row(system: System, band: tuple[float, float]) -> Comparison:
    laws = system.field.laws(system.values)
    filters = [system.settings.realise(law) for law in laws]
    s = imaginary_axis(band, 400)
    pairs = list(zip(laws, filters, strict=True))
    poles = np.concatenate([_poles(law, f) for law, f in pairs])
    real = np.abs(poles.imag) <= _ROUNDING * np.abs(poles)
    return Comparison(
        name=system.settings.name,
        states=sum(len(f.B) for f in filters),
        band=system.settings.band,
        static_gain=_static(laws[0], filters[0]),
        static_error=max(_static_error(law, f) for law, f in pairs),
        error=max(float(np.max(np.abs(f(s) / law(s) - 1.0))) for law, f in pairs),
        largest_pole=float(poles.real.max()),
        real_poles=bool(np.all(real & (poles.real < 0.0))),
        passive=all(is_passive(f) for f in filters),
    )


def is_passive(realised: Filter) -> bool:
    """Say whether Im Z(i omega) >= 0, sampled well beyond the poles of a filter on either side."""
    poles = np.abs(np.linalg.eigvals(realised.A))
    poles = poles[poles > _ROUNDING * poles.max()]
    omega = np.geomspace(1e-3 * poles.min(), 1e3 * poles.max(), 4000)
    values = realised(np.asarray(1j * omega))
    return bool(np.all(values.imag >= -_ROUNDING * np.abs(values)))


def _poles(law: Law, realised: Filter) -> Complex:
    poles = np.linalg.eigvals(realised.A).astype(complex)
    if law.integrates:
        poles = np.delete(poles, int(np.argmin(np.abs(poles))))
    return poles


def _static(law: Law, realised: Filter) -> float:
    return float("inf") if law.integrates else float(realised(np.zeros(1, dtype=complex))[0].real)


def _static_error(law: Law, realised: Filter) -> float:
    if law.integrates:
        return 0.0
    return abs(_static(law, realised) - law.static_gain) / (abs(law.static_gain) or 1.0)


def _with_hopf(
    row: Comparison, system: System, path: ParameterPath, exact: ExactHopf
) -> Comparison:
    try:
        # From beside the exact point, so that the solution is found and not merely confirmed.
        beside = exact.value + 1e-3 * (abs(exact.value) or 1.0)
        found = solve_realised_hopf(system, path, exact.X, beside, 1.001 * exact.omega)
    except ConvergenceError:
        return row
    return replace(
        row,
        hopf_error=abs(found.value - exact.value) / (abs(exact.value) or 1.0),
        omega_error=abs(found.omega / exact.omega - 1.0),
    )


def _refusal(settings: Realisation, why: str) -> Comparison:
    nothing = float("nan")
    return Comparison(
        name=settings.name,
        states=0,
        band=settings.band,
        static_gain=nothing,
        static_error=nothing,
        error=nothing,
        largest_pole=nothing,
        real_poles=False,
        passive=False,
        refused=why,
    )
