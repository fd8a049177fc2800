"""H: pairs of eigenvalues on the imaginary axis, told apart from neutral saddles."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.continuation.problem import Detector
from racs_bif.equilibria.hopf_form import hopf_form

if TYPE_CHECKING:
    from racs_bif.continuation.points import Array, Point, Spectrum
    from racs_bif.equilibria.hopf_form import HopfForm
    from racs_bif.equilibria.problem import EquilibriumProblem

REAL = 1e-7
"""Below this a frequency is zero."""
_OFF = 1e-3
_SUSPICIOUS = 1e-8
_ASIDE = 1e-4
_LOCATED = 1e-10
"""Error of a Hopf point's parameter, relative: a coefficient that is zero within it is zero."""

_DEGENERATE = 1e-15
"""Coefficients below this are rounding: a linear system, or a vertical branch of orbits."""


def criticality(l1: float) -> str:
    """Say in a word what the sign of the first Lyapunov coefficient means.

    Examples
    --------
    >>> criticality(-0.5), criticality(0.0)
    ('supercritical', 'degenerate')
    """
    if abs(l1) <= _DEGENERATE:
        return "degenerate"
    return "supercritical" if l1 < 0.0 else "subcritical"


class Hopf(Detector):
    """Two eigenvalues have zero sum.

    Parameters
    ----------
    own : int
        Number of leading states that are the model's own; see `hopf_form`.
    """

    label = "H"
    crossings = 2

    def __init__(self, own: int) -> None:
        self.own = own

    def value(self, problem: EquilibriumProblem, point: Point) -> float:
        """Return the smallest of the sums that can change sign, with the sign of their product.

        All sums of two eigenvalues multiply to the determinant of the bialternate product
        (Kuznetsov, section 10.2.2). Sums of conjugates and of two real eigenvalues are real and
        decide its sign: here by those above zero, which are known even where only the rightmost
        eigenvalues are.
        """
        del problem
        sums = real_sums(point.spectrum)[0]
        if not len(sums):
            return float("nan")
        sign = -1.0 if np.count_nonzero(sums > 0.0) % 2 else 1.0
        return float(sign * np.abs(sums).min())

    def data(self, problem: EquilibriumProblem, point: Point) -> dict[str, Any] | None:
        """Return frequency, normal form and criticality; None at a neutral saddle."""
        sums, frequencies = real_sums(point.spectrum)
        k = int(np.argmin(np.abs(sums)))
        omega = float(frequencies[k])
        if abs(sums[k]) > _OFF * omega:
            return (
                None  # the sign changed where eigenvalues met, or were no longer among those found
            )
        if omega <= REAL * (1.0 + np.abs(point.spectrum).max() * REAL):
            return None
        form = self._form(problem, point.z, omega)
        if abs(form.l1) < _SUSPICIOUS:
            form = self._rounded(problem, point.z, form)
        return {
            "omega": omega,
            "l1": form.l1,
            "c1": form.c1.real,
            "criticality": criticality(form.l1),
            "crossing_speed": form.mu_slope.real,
            "form": form,
        }

    def _form(self, problem: EquilibriumProblem, z: Array, omega: float) -> HopfForm:
        path = problem.path
        p, dp = path.vector(z[-1]), path.direction(z[-1])
        return hopf_form(problem.field, z[:-1], p, dp, omega, self.own)

    def _rounded(self, problem: EquilibriumProblem, z: Array, form: HopfForm) -> HopfForm:
        """Return the form with Re c1 zero if it is zero within the error of the parameter."""
        unit = max(1.0, abs(float(z[-1])))
        beside = z + _ASIDE * unit * np.append(form.drift, 1.0)
        change = self._form(problem, beside, form.omega).c1.real - form.c1.real
        if abs(form.c1.real) * _ASIDE <= _LOCATED * abs(change):
            return replace(form, c1=1j * form.c1.imag)
        return form


def real_sums(spectrum: Spectrum) -> tuple[np.ndarray, np.ndarray]:
    """Return the real sums of two eigenvalues, and the frequency (0 for two real ones) of each."""
    upper = spectrum[spectrum.imag > 0.0]
    real = spectrum[spectrum.imag == 0.0].real
    i, j = np.triu_indices(len(real), 1)
    sums = np.concatenate([2.0 * upper.real, real[i] + real[j]])
    return sums, np.concatenate([upper.imag, np.zeros(len(i))])
