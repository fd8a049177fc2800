"""The rightmost exact root of many parameter sets at once.

Roots known at one set are polished by Newton's method on det Delta at all others; that no other is
right of them is certified by the argument principle. Where it is not so, all roots of one of
these sets are computed anew and the rest is tried again with those.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.charts.counting import count_right
from racs_bif.errors import ConvergenceError, ParameterError
from racs_bif.fractional.characteristic import Characteristic
from racs_bif.fractional.radii import annulus
from racs_bif.fractional.roots import roots_right

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.charts.sums import Sums
    from racs_bif.fractional.exact import ExactModel
    from racs_bif.fractional.laws import Complex
    from racs_bif.symbolic.field import Array

_ITERATIONS = 12
_CONVERGED = 1e-10
_BESIDE = 1e-6
_MOST = 40
_KEPT = 4
_TOGETHER = 512
_REAL = 1e-10
_SAME = 1e-6


@dataclass(frozen=True)
class Rightmost:
    """Rightmost roots of N parameter sets.

    Parameters
    ----------
    root : complex array (N,)
        The root, Im >= 0; NaN where it is not certain, or there is none.
    evaluations : int array (N,)
        Number of determinants for each.
    """

    root: Complex
    evaluations: NDArray[np.int64]


def rightmost(model: ExactModel, sums: Sums, X: Array, P: Array) -> Rightmost:
    """Find the rightmost roots.

    Parameters
    ----------
    model : ExactModel
        The model.
    sums : Sums
        Its N determinants.
    X, P : arrays (size, N) and (np, N)
        Equilibria and base parameters.
    """
    count = len(sums)
    root = np.full(count, np.nan, dtype=complex)
    sure = np.zeros(count, dtype=bool)
    hopeless = np.asarray(~np.isfinite(sums.coefficients).all(axis=0))
    evaluations, place = np.zeros(count, dtype=np.int64), count // 2
    for _ in range(_MOST):
        rest = np.flatnonzero(~sure & ~hopeless)
        if not len(rest):
            break
        place = place if place in rest else int(rest[len(rest) // 2])
        known = _roots(model, X[:, place], P[:, place])
        if known is None:
            hopeless[place] = True
            continue
        roots, spent = _tracked(sums.take(rest), known)
        evaluations[rest] += spent
        good, spent = _certified(sums.take(rest), roots)
        evaluations[rest] += spent
        root[rest[good]] = roots[0, good]
        sure[rest[good]] = True
        if not sure[place]:
            hopeless[place] = True
    root[~sure] = np.nan
    return Rightmost(root, evaluations)


def _roots(model: ExactModel, X: Array, P: Array) -> Complex | None:
    """Return the rightmost roots of one set, None where they cannot be found."""
    try:
        ch = Characteristic.of_model(model, X, P)
        lowest = -2.0 * float(np.exp(min(annulus(ch).outer, 200.0)))
        above = -1.0
        while above > lowest:
            roots = roots_right(ch, above).roots
            if len(roots):
                return np.asarray(roots[roots.imag >= 0.0][:_KEPT])
            above *= 10.0
    except (ConvergenceError, ParameterError):
        pass
    return None


def _tracked(sums: Sums, known: Complex) -> tuple[Complex, NDArray[np.int64]]:
    """Return the roots (k, N) that Newton's method finds from known ones, the rightmost first.

    Each is there once, with Im >= 0; NaN fills up.
    """
    roots = np.full((len(known), len(sums)), np.nan, dtype=complex)
    evaluations = np.zeros(len(sums), dtype=np.int64)
    for k, start in enumerate(known):
        t = np.full(len(sums), np.log(start + 0j))
        moving = np.arange(len(sums))
        done = np.zeros(len(sums), dtype=bool)
        for _ in range(_ITERATIONS):
            value, slope, _scale = sums.take(moving).evaluate(t[moving])
            evaluations[moving] += 1
            with np.errstate(all="ignore"):
                step = value / slope
            t[moving] -= step
            size = np.abs(step)
            done[moving[size < _CONVERGED]] = True
            moving = moving[(size >= _CONVERGED) & (size < 2.0)]
            if not len(moving):
                break
        on_sheet = done & (np.abs(t.imag) <= np.pi + _CONVERGED)
        s = np.exp(np.where(on_sheet, t, 0.0))
        s = s.real + 1j * np.where(np.abs(s.imag) <= _REAL * np.abs(s), 0.0, np.abs(s.imag))
        with np.errstate(invalid="ignore"):
            again = (np.abs(roots[:k] - s) <= _SAME * np.abs(s)).any(axis=0)
        roots[k] = np.where(on_sheet & ~again, s, np.nan)
    order = np.argsort(np.where(np.isnan(roots), np.inf, -roots.real), axis=0, kind="stable")
    return np.take_along_axis(roots, order, axis=0), evaluations


def _certified(sums: Sums, roots: Complex) -> tuple[NDArray[np.bool_], NDArray[np.int64]]:
    """Say where nothing is right of the first roots, by the argument principle.

    Most are certified together: right of a line a little left of all their rightmost roots there
    are as many roots as are known there. The rest is counted right of its own root each.
    """
    good = np.zeros(roots.shape[1], dtype=bool)
    evaluations = np.zeros(roots.shape[1], dtype=np.int64)
    there = np.flatnonzero(~np.isnan(roots[0]))
    order = there[np.argsort(roots[0, there].real, kind="stable")]
    for k in range(0, len(order), _TOGETHER):
        cells = order[k : k + _TOGETHER]
        line = float(roots[0, cells[0]].real - _BESIDE * np.abs(roots[0, cells[0]]))
        with np.errstate(invalid="ignore"):
            right = roots[:, cells].real > line
        known = np.where(right, np.where(roots[:, cells].imag > 0.0, 2, 1), 0).sum(axis=0)
        counts = count_right(sums.take(cells), line)
        evaluations[cells] += counts.evaluations
        good[cells] = counts.unstable == known
    rest = there[~good[there]]
    if len(rest):
        rightmost = roots[0, rest]
        counts = count_right(sums.take(rest), rightmost.real + _BESIDE * np.abs(rightmost))
        evaluations[rest] += counts.evaluations
        good[rest] = counts.unstable == 0
    return good, evaluations
