"""Floquet exponents of the exact operator, by Hill's method: no realisation at all.

A perturbation e^(sigma t) v(t), v periodic, obeys (left - right J) v = 0 with both sides taken at
sigma + i k Omega, k from -H to H. For fractional elements this is a nonlinear eigenproblem; its
solutions are found one by one, by Newton's method from the multipliers of a realisation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import ConvergenceError

if TYPE_CHECKING:
    from racs_bif.orbits.balance import Balanced
    from racs_bif.orbits.fourier import Complex

_ITERATIONS: Final = 15
_TOLERANCE: Final = 1e-10
_TRIVIAL: Final = 1e-7
_SEED: Final = 7


@dataclass(frozen=True, eq=False)
class ExactMultiplier:
    """A Floquet multiplier of the exact operator.

    Attributes
    ----------
    multiplier : complex
        e^(sigma T).
    exponent : complex
        sigma, per unit of time, on the principal sheet of the laws.
    shift : float
        Distance from the guess.
    residual : float
        Last correction of sigma T: what is left of the error.
    vector : complex array
        The periodic factor v, the harmonics -H to H of the unknowns kept.
    """

    multiplier: complex
    exponent: complex
    shift: float
    residual: float
    vector: Complex


def exact_multiplier(
    orbit: Balanced, guess: complex, vector: Complex | None = None
) -> ExactMultiplier:
    """Find the multiplier of the exact operator near a guess, other than the trivial one.

    Parameters
    ----------
    orbit : Balanced
        The balance at the orbit.
    guess : complex
        A multiplier of a realisation.
    vector : complex array, optional
        Of the same multiplier of an orbit near by, with as many harmonics.

    Raises
    ------
    ConvergenceError
        If there is none near it. Multipliers on the positive real axis below 1 have none: the
        principal branch is cut there, and the exact operator decays algebraically instead.
    """
    sigma = complex(np.log(complex(guess))) / orbit.period
    v = _first_vector(orbit, sigma) if vector is None else vector
    size = len(v)
    border, change = v.conj() / np.vdot(v, v).real, math.inf
    for _ in range(_ITERATIONS):
        matrix = np.zeros((size + 1, size + 1), dtype=complex)
        matrix[:size, :size] = _matrix(orbit, sigma)
        matrix[:size, size] = _slope(orbit, sigma, v)
        matrix[size, :size] = border
        residual = np.append(matrix[:size, :size] @ v, border @ v - 1.0)
        step = np.linalg.solve(matrix, residual)
        v, sigma = v - step[:size], sigma - complex(step[size])
        change = abs(step[size]) * orbit.period
        if change < _TOLERANCE:
            multiplier = complex(np.exp(sigma * orbit.period))
            if abs(multiplier - 1.0) < _TRIVIAL:
                break
            return ExactMultiplier(multiplier, sigma, abs(multiplier - guess), change, v)
        if not change < 2.0 * math.pi:
            break
    raise ConvergenceError(f"the exact operator has no multiplier near {guess:.6g}")


def _first_vector(orbit: Balanced, sigma: complex) -> Complex:
    """Return a vector by inverse iteration."""
    rng = np.random.default_rng(_SEED)
    size = (2 * orbit.harmonics + 1) * len(orbit.balance.kept)
    v = rng.standard_normal(size) + 1j * rng.standard_normal(size)
    for _ in range(3):
        v = np.linalg.solve(_matrix(orbit, sigma), _slope(orbit, sigma, v))
        v /= np.linalg.norm(v)
    return v


def _shifts(orbit: Balanced, sigma: complex) -> Complex:
    k = np.arange(-orbit.harmonics, orbit.harmonics + 1)
    return np.asarray(sigma + 2j * np.pi / orbit.period * k)


def _matrix(orbit: Balanced, sigma: complex) -> Complex:
    """Return the matrix of all harmonics at an exponent."""
    elimination = orbit.balance.elimination
    s = _shifts(orbit, sigma)
    left, right = orbit.diagonals.at(s)
    maps = elimination.maps((left, right), orbit.fixed)
    count, width = len(s), len(elimination.kept)
    k = np.arange(count)
    places = (k[:, None] - k) % orbit.transforms.shape[1]
    matrix = np.zeros((count, width, count, width), dtype=complex)
    rows, columns = orbit.balance.compiled.varying_at
    for term in orbit.balance.terms:
        parts = orbit.transforms[term.entry[:, None, None], places]
        heads = right.T[rows[term.entry]][:, :, None]
        factors = maps[:, columns[term.entry], term.unknown].T[:, None, :]
        matrix[:, term.row, :, term.unknown] -= parts * heads * factors
    own = left[:, :, None] * maps - right[:, :, None] * (orbit.fixed @ maps)
    matrix[k, :, k] += own[:, elimination.left]
    return matrix.reshape(count * width, count * width)


def _slope(orbit: Balanced, sigma: complex, v: Complex) -> Complex:
    """Return the derivative by the exponent of the matrix times v."""
    elimination = orbit.balance.elimination
    s = _shifts(orbit, sigma)
    sides = orbit.diagonals.at(s)
    left_s, right_s = orbit.diagonals.slopes(s)
    maps = elimination.maps(sides, orbit.fixed)
    X = (maps @ v.reshape(len(s), -1, 1))[:, :, 0]
    moved = left_s * X - right_s * _linearised(orbit, X)
    if len(elimination.rows):
        given = elimination.given_by(-moved[:, elimination.rows], sides, orbit.fixed)
        moved = moved + sides[0] * given - sides[1] * _linearised(orbit, given)
    return moved[:, elimination.left].ravel()


def _linearised(orbit: Balanced, X: Complex) -> Complex:
    """Return the spectrum of the core's Jacobian times X (2H + 1, n), harmonics from -H to H."""
    points, count = orbit.points.shape[1], orbit.harmonics
    padded = np.zeros((X.shape[1], points), dtype=complex)
    padded[:, np.arange(-count, count + 1)] = X.T
    values = np.fft.ifft(padded, axis=1)
    product = orbit.fixed @ values
    rows, columns = orbit.balance.compiled.varying_at
    np.add.at(product, rows, orbit.varying * values[columns])
    return np.asarray(np.fft.fft(product, axis=1)[:, np.arange(-count, count + 1)].T)
