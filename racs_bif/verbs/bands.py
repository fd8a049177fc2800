"""Whether a realisation holds what decides stability, and a wider or finer one where not.

A realisation is good on its band; roots slower or faster than that are its own. The argument
principle counts the exact unstable roots at all points together, and right beside folds. Where the
realisation has other numbers there, or a Hopf point beyond its band, branches are followed again on
a wider one; where a Hopf point is far from the exact one, with a higher order. What the user chose
is kept.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, TypeVar

from racs_bif.errors import ConvergenceError, ParameterError
from racs_bif.fractional.diffusive import Diffusive
from racs_bif.units import after, frequency_unit
from racs_bif.verbs.assemble import interrupted
from racs_bif.verbs.contradictions import contradiction, refused

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from racs_bif.continuation.points import Trace
    from racs_bif.equilibria.problem import EquilibriumProblem
    from racs_bif.fractional.system import System

    Followed = Sequence[tuple[EquilibriumProblem, Trace]]

Band = tuple[float, float]
R = TypeVar("R")

_FURTHER: Final = 10.0
"""How much further a band reaches than what it must hold, or than it did."""
_LIMITS: Final = (1e-7, 1e6)
"""Beyond these multiples of the model's own band none is tried."""
_MARGIN: Final = 2.0
"""How far within its band a realisation is good, as a factor."""
_FINER: Final = 1.5
"""How much higher the next order is."""
_REFINEMENTS: Final = 3
"""How often it is raised for points that stay far from the exact ones."""


@dataclass(frozen=True)
class Remark:
    """What is to be said of a realisation.

    Parameters
    ----------
    text : str
        Sentences, empty where the first realisation holds.
    settled : bool
        Whether no contradiction to the exact equations is left.
    """

    text: str = ""
    settled: bool = True


@dataclass(frozen=True)
class _Wanted:
    """A realisation that is wanted: its band, by how much its order is to exceed that band's own.

    `reasons` are sentences about either.
    """

    band: Band
    finer: float = 1.0
    reasons: tuple[str, str] = ("", "")

    def of(self, system: System) -> System:
        """Return a system with it."""
        settings = Diffusive(band=self.band)
        return replace(system, settings=replace(settings, order=round(self.finer * settings.order)))

    @property
    def text(self) -> str:
        """What is to be said of it."""
        return "".join(f" {reason}" for reason in self.reasons if reason)


def on_a_band_that_holds(
    system: System,
    work: Callable[[System], R],
    traces: Callable[[System, R], Followed],
) -> tuple[System, R, Remark]:
    """Follow branches, and again on wider bands or finer ones until the exact equations agree.

    Parameters
    ----------
    system : System
        The system; one whose realisation is not the default keeps it.
    work : callable
        Follows branches of equilibria.
    traces : callable
        What it followed.

    Returns
    -------
    system : System
        The system with the realisation taken: its own, where none settles it.
    result
        Of `work`.
    remark : Remark
        What is to be said of it.
    """
    first = result = work(system)
    own: Band = tuple(system.compiled.meta["band"])
    if not system.fractional or system.settings != Diffusive(band=own):
        return system, result, Remark()
    kept, present = system, _Wanted(own)
    while True:
        followed = traces(kept, result)
        if any(interrupted(found) for _, found in followed):
            return kept, result, Remark(present.text)
        trouble = _trouble(kept, present, followed)
        if trouble is None:
            return kept, result, Remark(present.text)
        wanted, told = trouble
        if wanted.band[0] < _LIMITS[0] * own[0] or wanted.band[1] > _LIMITS[1] * own[1]:
            return system, first, Remark(f" No wider band settles it: {told}.", settled=False)
        if wanted.finer > _FINER**_REFINEMENTS:
            return kept, result, Remark(present.text)
        trial = wanted.of(kept)
        try:
            result = work(trial)
        except (ConvergenceError, ParameterError):
            told = f" On a wider band nothing is found: {told}."
            return system, first, Remark(told, settled=False)
        kept, present = trial, wanted


def _trouble(system: System, present: _Wanted, followed: Followed) -> tuple[_Wanted, str] | None:
    """Return the realisation that is wanted and why, None where the present one will do."""
    for problem, found in followed:
        beyond = _beyond(system, problem, found)
        if beyond is not None:
            return _widened(system, present, *beyond), beyond[1]
        told = contradiction(system, problem, found)
        if told:
            low, high = present.band
            return _widened(system, present, (low / _FURTHER, high), told), told
    for problem, found in followed:
        told = _far(system, problem, found)
        if told:
            finer = _FINER * present.finer
            said = f"The realisation's order was raised to {finer:.3g} times its default: {told}."
            return replace(present, finer=finer, reasons=(present.reasons[0], said)), told
    return None


def _widened(system: System, present: _Wanted, band: Band, told: str) -> _Wanted:
    unit = after(frequency_unit(system.time_unit))
    said = f"The realisation's band was widened to {band[0]:.4g} to {band[1]:.4g}{unit}: {told}."
    return replace(present, band=band, reasons=(said, present.reasons[1]))


def _beyond(system: System, problem: EquilibriumProblem, found: Trace) -> tuple[Band, str] | None:
    """Return a band that holds a Hopf point beyond the present one, and what is to be said."""
    low, high = system.settings.band
    unit = after(frequency_unit(system.time_unit))
    for point in found.special:
        omega = float(point.data.get("omega", low))
        if point.label == "H" and not _MARGIN * low <= omega <= high / _MARGIN:
            wider = min(low, omega / _FURTHER), max(high, omega * _FURTHER)
            name, value = problem.parameter, float(point.z[-1])
            return wider, f"there is a Hopf point of {omega:.4g}{unit} at {name} = {value:.6g}"
    return None


def _far(system: System, problem: EquilibriumProblem, found: Trace) -> str:
    """Say which Hopf point is farther from the exact one than `certify` accepts, if any."""
    for point in refused(system, problem, found):
        name, value = problem.parameter, float(point.z[-1])
        return f"the Hopf point at {name} = {value:.6g} was too far from the exact one"
    return ""
