"""Checks of claims by motion: decay, orbits, what a simulation ends on, Lyapunov exponents."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import log
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif import continue_equilibria, continue_orbits, simulate
from racs_bif.errors import RacsBifError
from racs_bif.fractional.roots import characteristic_roots
from racs_bif.simulation.lyapunov import lyapunov_exponents

if TYPE_CHECKING:  # the folder is no package; the shelf finds its files in every installation
    from collections.abc import Mapping

    from analyses._checks_stability import Plain, middle_of
    from analyses._claimed import Reading, judge, key_of
    from analyses._ledger import Bench, Finding
    from racs_bif.fractional.system import System
else:
    from racs_bif.shelf.analyses._checks_stability import Plain, middle_of
    from racs_bif.shelf.analyses._claimed import judge, key_of
    from racs_bif.shelf.analyses._ledger import Finding

SETTLED: Final = (0.05, 0.02)
"""An oscillation counts as settled at one of these shares of its beginning, as is the custom."""
_STIFFEST: Final = 1e5
_CHAOTIC: Final = 0.05
"""A largest Lyapunov exponent [1/s] has to be above this, and above five standard errors."""


@dataclass(frozen=True)
class Criticality(Plain):
    """Whether the Hopf point in u is supercritical."""

    def find(self, bench: Bench) -> Finding:
        """Compute the first Lyapunov coefficient of the exact operator."""
        point = continue_equilibria(bench.base, "u", (5.0, 15.0))["H1"]
        exact = point.exact
        if exact is None or exact.l1 is None:
            return Finding(computed="first Lyapunov coefficient", found="not found")
        return Finding(
            computed="first Lyapunov coefficient of the exact operator",
            found=f"l1 = {exact.l1:.4g} at u = {exact.parameters['u']:.6g} m/s",
            true=exact.l1 < 0.0,
        )


@dataclass(frozen=True)
class Settling(Plain):
    """Whether the oscillation settles in a given time [s] at a given speed [m/s]."""

    speed: float
    seconds: float

    def find(self, bench: Bench) -> Finding:
        """Ask the rightmost exact root for the stiffnesses with that rate of decay."""
        own = _rightmost(bench.system({"u": self.speed}))
        times = [log(1.0 / share) / -own.real for share in SETTLED]
        rates = [log(1.0 / share) / self.seconds for share in SETTLED]
        where = [self._stiffness(bench, rate) for rate in rates]
        return Finding(
            computed="rightmost exact root at u = "
            f"{self.speed:g}; decay to {SETTLED[0]:.0%} or {SETTLED[1]:.0%}",
            found=f"calibrated: {own.real:.4f}+-{own.imag:.4f}i, {times[0]:.0f} to {times[1]:.0f} "
            f"s; {self.seconds:g} s for C_s = {where[0]:.0f} to {where[1]:.0f} N/rad",
            where=((min(where), max(where)),),
        )

    def _stiffness(self, bench: Bench, rate: float) -> float:
        """Return the stiffness at which the rightmost root decays at a rate [1/s]."""
        from scipy.optimize import brentq

        def excess(logarithm: float) -> float:
            there = bench.system({"u": self.speed, "C_s": float(np.exp(logarithm))})
            return _rightmost(there).real + rate

        return float(np.exp(brentq(excess, log(bench.calibrated), log(_STIFFEST), xtol=1e-7)))


def _rightmost(system: System) -> complex:
    roots = characteristic_roots(system, above=-1.0).roots
    oscillating = roots[roots.imag > 1.0]
    return complex(oscillating[0]) if len(oscillating) else complex(-1.0, 0.0)


@dataclass(frozen=True)
class Alike(Plain):
    """Whether yaw rate and compliance steering angle decay alike at a speed [m/s]."""

    speed: float

    def find(self, bench: Bench) -> Finding:
        """Compare the decay of both in a simulation of the exact operator."""
        run = simulate(bench.system({"u": self.speed}), 20.0, method="fast", step=0.01)
        rates = [_decay(run.times, run.column(name)) for name in ("delta_c", "w")]
        return Finding(
            computed="time history of the exact operator, decay of the oscillation from 4 to 20 s",
            found=f"delta_c {rates[0]:.4f} 1/s, yaw rate {rates[1]:.4f} 1/s",
            true=max(rates) < 0.0 and abs(rates[0] - rates[1]) < 0.25 * abs(rates[0]),
        )


def _decay(times: np.ndarray, values: np.ndarray) -> float:
    """Return the rate at which the extremes of the rate of change shrink, from 4 s on."""
    slope = np.gradient(values, times)
    inner = np.flatnonzero((slope[1:-1] - slope[:-2]) * (slope[2:] - slope[1:-1]) < 0.0) + 1
    inner = inner[times[inner] > 4.0]
    return float(np.polyfit(times[inner], np.log(np.abs(slope[inner])), 1)[0])


@dataclass(frozen=True)
class Focus(Plain):
    """Whether straight running is a focus, stable or not, at a speed [m/s]."""

    speed: float
    unstable: bool

    def find(self, bench: Bench) -> Finding:
        """Look at the rightmost exact root."""
        root = characteristic_roots(bench.system({"u": self.speed})).roots[0]
        return Finding(
            computed=f"rightmost exact root at u = {self.speed:g}",
            found=f"{root.real:.6f}+-{abs(root.imag):.6f}i",
            true=root.imag != 0.0 and (root.real > 0.0) == self.unstable,
        )


@dataclass(frozen=True)
class Cycle(Plain):
    """Whether a vehicle from rest ends on the stable orbit, at the last of some speeds [m/s]."""

    span: tuple[float, float]
    speeds: tuple[float, ...]
    seconds: float = 40.0

    def find(self, bench: Bench) -> Finding:
        """Compare a long simulation with the orbit of the exact operator."""
        *_, orbit = _orbits(bench, {"C_s": bench.calibrated}, "u", self.span, self.speeds)
        there = bench.system({"u": orbit.value})
        run = simulate(there, self.seconds, operator="realised", tolerance=1e-6)
        low, high = run.extremes("delta_c", after=0.75 * self.seconds)
        period = run.period("delta_c", after=0.75 * self.seconds)
        return Finding(
            computed="orbit by harmonic balance, its multipliers; simulation from rest",
            found=f"orbit: period {orbit.period:.4f} s, delta_c {orbit.width:.4f} rad wide, "
            f"{'stable' if orbit.stable else 'unstable'}; simulation: {period:.4f} s, "
            f"{high - low:.4f} rad",
            true=orbit.stable and abs(period / orbit.period - 1.0) < 0.02,
        )


@dataclass(frozen=True)
class Piece:
    """An orbit at a value of the parameter: width and middle of delta_c [rad], period [s]."""

    value: float
    width: float
    mean: float
    period: float
    stable: bool


def _orbits(
    bench: Bench,
    condition: Mapping[str, float],
    parameter: str,
    span: tuple[float, float],
    values: tuple[float, ...],
) -> list[Piece]:
    """Return orbits at some values of a parameter, on the branch from the first Hopf point."""
    key = (key_of(condition), parameter, span, values)
    if key not in bench.kept:
        bench.kept[key] = _followed(bench.system(condition), parameter, span, values)
    pieces: list[Piece] = bench.kept[key]
    return pieces


def _followed(
    system: System, parameter: str, span: tuple[float, float], values: tuple[float, ...]
) -> list[Piece]:
    hopf = continue_equilibria(system, parameter, span)["H1"]
    branch = continue_orbits(hopf, span, method="harmonic-balance", at=values)
    pieces = []
    for value in values:
        point = next(p for p in branch.special if abs(p.parameters[parameter] - value) < 1e-9)
        high = float(branch.measures["max delta_c"][point.index])
        low = float(branch.measures["min delta_c"][point.index])
        stable = bool(branch.stable[point.index])
        pieces.append(Piece(value, high - low, 0.5 * (high + low), point.period, stable))
    return pieces


@dataclass(frozen=True)
class Widths:
    """Whether the orbits grow as a parameter goes from value to value.

    Parameters
    ----------
    parameter : str
        The parameter.
    span : (float, float)
        The span in which its Hopf point lies.
    values : tuple of float
        Where orbits are wanted, in the order in which they are said to grow.
    others : mapping
        Further parameters.
    key, reading : str, int
        The statement at whose stiffness this is looked at; the calibrated one where left out.
    asymmetric : bool
        Ask instead whether the orbits' middle is off zero by more than a hundredth of their width.
    """

    parameter: str
    span: tuple[float, float]
    values: tuple[float, ...]
    others: Mapping[str, float]
    key: str = ""
    reading: int = 0
    asymmetric: bool = False

    def conditions(self) -> tuple[Mapping[str, float], ...]:
        """Return none; those of the statement are known."""
        return ()

    def readings(self) -> tuple[Reading, ...]:
        """Return nothing: it is about amplitudes."""
        return ()

    def find(self, bench: Bench) -> Finding:
        """Follow the orbits by harmonic balance."""
        stiffness, where = bench.calibrated, None
        if self.key:
            statement = bench.statement(self.key)
            found = judge(statement.readings[self.reading], bench.known)
            where = found.holds
            stiffness = found.hopf[0] if found.hopf else middle_of(where)
        condition = {**self.others, "C_s": stiffness}
        computed = (
            f"orbits by harmonic balance over {self.parameter} at C_s = {stiffness:.0f} N/rad"
        )
        try:
            pieces = _orbits(bench, condition, self.parameter, self.span, self.values)
        except (RacsBifError, StopIteration) as error:
            return Finding(computed=computed, found=f"not found: {error}", where=())
        true = all(b.width > a.width for a, b in pairwise(pieces))
        if self.asymmetric:
            true = all(abs(piece.mean) > 0.01 * piece.width for piece in pieces)
        listed = ", ".join(
            f"{p.value:g}: {p.width:.4f} (middle {p.mean:+.4f}), {p.period:.3f} s" for p in pieces
        )
        return Finding(
            computed=computed,
            found=f"width of delta_c [rad] and period at {self.parameter} = {listed}",
            where=None if where is None else (where if true else ()),
            true=true,
        )


@dataclass(frozen=True)
class Chaos(Plain):
    """Whether the motion is chaotic under a condition, with several stiffnesses."""

    condition: Mapping[str, float]
    keys: tuple[str, ...]

    def find(self, bench: Bench) -> Finding:
        """Compute the largest Lyapunov exponent at the calibrated and at other stiffnesses."""
        stiffness = {"calibrated": bench.calibrated}
        for key in self.keys:
            found = judge(bench.statement(key).readings[0], bench.known)
            stiffness[key] = found.hopf[0] if found.hopf else middle_of(found.holds)
        words, true = [], []
        for name, value in stiffness.items():
            system = bench.system({**self.condition, "C_s": value})
            start = np.zeros(len(system.field.states))
            start[: len(system.states)] = (0.05, 0.01, 0.01, 0.0)
            found_ = lyapunov_exponents(
                system.field,
                start,
                system.values,
                bench.seconds,
                transient=0.4 * bench.seconds,
                tolerance=1e-6,
            )
            largest, error = float(found_.exponents[0]), float(found_.errors[0])
            true.append(largest > max(_CHAOTIC, 5.0 * error))
            words.append(f"{largest:+.4f} +- {error:.4f} 1/s ({name}, C_s = {value:.0f})")
        return Finding(
            computed="largest Lyapunov exponent of the realised vehicle from near straight running",
            found="; ".join(words),
            where=None if any(true) else (),
            true=any(true),
        )
