"""Truncated Fourier series of several functions at once, in real coefficients.

A series of H harmonics in the angle theta = 2 pi t / T is an array (2H + 1, m): the means, the
coefficients of cos theta ... cos H theta, and those of sin theta ... sin H theta. Its complex
spectrum is the array (H + 1, m) of x_k in sum_k x_k e^(i k theta), k from -H to H.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array

Complex = NDArray[np.complex128]

_STILL = 1e-6
_FINE = 8
_POLISHING = 4


def harmonics_of(series: Array) -> int:
    """Return the number H of harmonics."""
    return (len(series) - 1) // 2


def to_complex(series: Array) -> Complex:
    """Return the spectrum (H + 1, m) of a series (2H + 1, m)."""
    count = harmonics_of(series)
    spectrum = np.empty((count + 1, *series.shape[1:]), dtype=complex)
    spectrum[0] = series[0]
    spectrum[1:].real = 0.5 * series[1 : count + 1]
    spectrum[1:].imag = -0.5 * series[count + 1 :]
    return spectrum


def to_real(spectrum: Complex) -> Array:
    """Return the series (2H + 1, m) of a spectrum (H + 1, m)."""
    parts = (spectrum[:1].real, 2.0 * spectrum[1:].real, -2.0 * spectrum[1:].imag)
    return np.concatenate(parts)


def resized(series: Array, harmonics: int) -> Array:
    """Return the series with other harmonics: cut off, or zero."""
    count = harmonics_of(series)
    kept = min(count, harmonics)
    result = np.zeros((2 * harmonics + 1, *series.shape[1:]))
    result[: kept + 1] = series[: kept + 1]
    result[harmonics + 1 : harmonics + 1 + kept] = series[count + 1 : count + 1 + kept]
    return result


def turned(series: Array) -> Array:
    """Return the derivative of a series by theta."""
    count = harmonics_of(series)
    k = np.arange(1, count + 1).reshape(-1, *[1] * (series.ndim - 1))
    result = np.zeros_like(series)
    result[1 : count + 1] = k * series[count + 1 :]
    result[count + 1 :] = -k * series[1 : count + 1]
    return result


def amplitudes(series: Array) -> Array:
    """Return the root of the sum of all squared harmonics (m,): the amplitude of a pure one."""
    return np.asarray(np.sqrt(np.sum(series[1:] ** 2, axis=0)))


def odd(harmonics: int) -> NDArray[np.bool_]:
    """Return which rows (2H + 1,) of a series are odd harmonics."""
    k = np.arange(1, harmonics + 1)
    return np.concatenate(([False], k % 2 == 1, k % 2 == 1))


def subharmonics(series: Array) -> Array:
    """Return the odd harmonics of a series: those that tell one half of a period from the other."""
    return np.asarray(series[odd(harmonics_of(series))])


def doubled(series: Array) -> Array:
    """Return the series (4H + 1, m) of a function over two of its periods."""
    count = harmonics_of(series)
    longer = np.zeros((4 * count + 1, *series.shape[1:]))
    longer[0] = series[0]
    longer[2 : 2 * count + 1 : 2] = series[1 : count + 1]
    longer[2 * count + 2 :: 2] = series[count + 1 :]
    return longer


def tails(series: Array) -> Array:
    """Return the largest of the highest harmonics (m,), relative to all of them.

    The last tenth is looked at, and no fewer than four: symmetric orbits lack every other one.
    """
    count = harmonics_of(series)
    last = max(4, count // 10)
    squares = series[1 : count + 1] ** 2 + series[count + 1 :] ** 2
    # what stands still but for rounding has a tail of rounding
    total = squares.sum(axis=0)
    total = np.maximum(total, _STILL**2 * total.max(initial=0.0) + np.finfo(float).tiny)
    return np.asarray(np.sqrt(squares[-last:].max(axis=0) / total))


@cache
def points_for(harmonics: int) -> int:
    """Return how many time points resolve products of series without folding them back.

    With more than 4H points a product with a series of 2H harmonics is exact, as the Jacobian
    needs; what a nonlinearity makes beyond 3H is folded onto harmonics that are kept.
    """
    from scipy.fft import next_fast_len

    return int(next_fast_len(4 * harmonics + 2, real=True))


def sampled(spectrum: Complex, points: int) -> Array:
    """Return the values (m, N) at equal times over one period."""
    padded = np.zeros((spectrum.shape[1], points // 2 + 1), dtype=complex)
    padded[:, : len(spectrum)] = spectrum.T
    return np.fft.irfft(padded, points, axis=1) * points


def analysed(values: Array, harmonics: int) -> Complex:
    """Return the spectrum (H + 1, m) of values (m, N) at equal times over one period."""
    transform = np.fft.rfft(values, axis=1)[:, : harmonics + 1]
    spectrum = np.zeros((harmonics + 1, len(values)), dtype=complex)
    spectrum[: transform.shape[1]] = transform.T / values.shape[1]
    return spectrum


def evaluated(spectrum: Complex, fractions: Array) -> Array:
    """Return the values (m, k) at fractions (k,) of the period."""
    k = np.arange(len(spectrum))
    weighted = np.concatenate((spectrum[:1], 2.0 * spectrum[1:]))
    turns = np.exp(2j * np.pi * np.outer(k, fractions))
    return np.asarray((weighted.T @ turns).real)


def extrema(spectrum: Complex) -> tuple[Array, Array]:
    """Return the highest and lowest values (m,) of a spectrum (H + 1, m).

    The best of many samples is polished by Newton's method on the derivative.
    """
    values = sampled(spectrum, _FINE * (len(spectrum) + 1))
    return _extreme(spectrum, values, 1.0), _extreme(spectrum, values, -1.0)


def _extreme(spectrum: Complex, values: Array, sign: float) -> Array:
    best = np.argmax(sign * values, axis=1)
    start = values[np.arange(len(values)), best]
    angle = 2.0 * np.pi * best / values.shape[1]
    reach = 2.0 * np.pi / values.shape[1]
    k = np.arange(len(spectrum))[:, None]
    weighted = 2.0 * spectrum
    weighted[0] = spectrum[0]
    theta = angle
    for _ in range(_POLISHING):
        terms = weighted * np.exp(1j * k * theta)
        slope = -(k * terms).imag.sum(axis=0)
        bend = -(k**2 * terms).real.sum(axis=0)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(sign * bend < 0.0, slope / bend, 0.0)
        theta = np.clip(theta - step, angle - reach, angle + reach)
    polished = (weighted * np.exp(1j * k * theta)).real.sum(axis=0)
    # a flat or a constant function has nothing to polish
    return np.asarray(sign * np.maximum(sign * polished, sign * start))
