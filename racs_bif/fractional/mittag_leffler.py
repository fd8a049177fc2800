"""The Mittag-Leffler function of two parameters.

Power series near zero; elsewhere the inverse Laplace transform of ``s**(a-b) / (s**a - z)`` at
time one, by the trapezoidal rule on a parabola about the negative real axis, plus residues of the
poles to the right of it. Source: R. Garrappa, *Numerical evaluation of two and three parameter
Mittag-Leffler functions*, SIAM J. Numer. Anal. 53 (2015) 1350-1369. Other than there the parabola
is chosen from a few, for the largest relative distance to all singularities, and the step from
that distance: more points, no case distinctions.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.errors import UsageError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from racs_bif.fractional.laws import Complex

_SERIES = 0.9  # |z| up to which the series is summed
_DIGITS = 38.0  # -log of the error wanted
_VERTICES = np.array([0.6, 0.85, 1.2, 1.6, 2.0])  # square roots of the parabolas' vertices
_LARGE = 4.0  # log of the integrand on the parabola
_FAR = 4.5  # log of |s| where the parabolas end
_OVERFLOW = 700.0
_HIGHEST = 10.0


def mittag_leffler(a: float, b: float, z: ArrayLike) -> NDArray[Any]:
    """Return E_{a,b}(z), the sum of ``z**k / Gamma(a k + b)``.

    Parameters
    ----------
    a : float
        Order, 0 < a <= 2.
    b : float
        Second parameter, at most 10 in modulus.
    z : array_like
        Arguments, real or complex.

    Returns
    -------
    array
        Shaped like z, real for real z. The error is about 1e-13 of the larger of the value and of
        1/(1 + |z|); infinite where the value overflows.

    Raises
    ------
    UsageError
        If a or b are out of range or z is not finite.

    Examples
    --------
    >>> print(f"{mittag_leffler(0.5, 1.0, -1.0):.10f}")
    0.4275835762
    """
    z = np.asarray(z, dtype=complex if np.iscomplexobj(z) else float)
    if not 0.0 < a <= 2.0 or not abs(b) <= _HIGHEST:
        msg = f"E_{{a,b}} must have 0 < a <= 2 and |b| <= {_HIGHEST:g}, not a = {a:g} and b = {b:g}"
        raise UsageError(msg)
    if not np.all(np.isfinite(z)):
        msg = "the argument of the Mittag-Leffler function must be finite"
        raise UsageError(msg)
    flat = z.ravel().astype(complex)
    value = np.zeros(flat.shape, dtype=complex)
    with np.errstate(over="ignore", invalid="ignore"):
        small = np.abs(flat) <= _SERIES
        value[small] = _series(a, b, flat[small])
        if a == b == 1.0:
            value[~small] = np.exp(flat[~small])
        else:
            value[~small] = [_inverse_laplace(a, b, complex(x)) for x in flat[~small]]
    shaped = value if np.iscomplexobj(z) else value.real
    return np.asarray(shaped.reshape(z.shape))


def _series(a: float, b: float, z: Complex) -> Complex:
    from scipy.special import rgamma

    largest = float(np.abs(z).max(initial=0.0))
    terms = 2 if largest == 0.0 else 2 + int(np.ceil(_DIGITS / -np.log(min(largest, _SERIES))))
    total = np.zeros(z.shape, dtype=complex)
    for coefficient in rgamma(a * np.arange(terms + 12) + b)[::-1]:
        total = total * z + coefficient
    return total


def _inverse_laplace(a: float, b: float, z: complex) -> complex:
    """Return E_{a,b}(z) by the parabola ``s = mu (1 + i x)**2``."""
    poles = _poles(a, z)
    mu, distance = _parabola(poles, b - a)
    # towards s = 0 the integrand grows where b > a, towards the far ends where b < a
    step = 2.0 * np.pi * distance / (_DIGITS - 2.0 * max(b - a, 0.0) * np.log1p(-distance))
    reach = np.sqrt(1.0 + (_DIGITS + 2.0 + max(a - b, 0.0) * _FAR) / mu)
    count = int(np.ceil(reach / step))
    root = 1.0 + 1j * step * np.arange(-count, count + 1)
    s = mu * root**2
    total = np.sum(np.exp(s) * s ** (a - b) / (s**a - z) * root) * mu * step / np.pi
    # Poles right of the parabola are not enclosed by it.
    right = poles[np.sqrt(poles).real > np.sqrt(mu)]
    return complex(total + _residues(right, b).sum() / a)


def _residues(poles: Complex, b: float) -> Complex:
    """Return ``exp(s) s**(1-b)``, infinite of the right signs where it overflows."""
    exponents = poles + (1.0 - b) * np.log(poles)
    if np.all(np.maximum(exponents.real, poles.real) < _OVERFLOW):
        return np.asarray(np.exp(poles) * poles ** (1.0 - b))
    size, phase = np.exp(exponents.real), exponents.imag
    imaginary = np.where(np.sin(phase) == 0.0, 0.0, size * np.sin(phase))
    out = np.zeros(len(poles), dtype=complex)
    out.real, out.imag = size * np.cos(phase), imaginary
    return out


def _poles(a: float, z: complex) -> Complex:
    """Return the poles on the principal sheet."""
    turns = np.arange(-2, 3)
    angle = (np.angle(z) + 2.0 * np.pi * turns) / a
    angle = angle[np.abs(angle) < np.pi]
    return np.asarray(abs(z) ** (1.0 / a) * np.exp(1j * angle))


def _parabola(poles: Complex, power: float) -> tuple[float, float]:
    """Return mu and the distance over x of the nearest singularity; s = 0 is at distance one.

    Of parabolas on which ``s**-power`` is not so large that rounding is felt.
    """
    places = np.sqrt(poles).real[:, None] / _VERTICES - 1.0
    distance = np.minimum(np.abs(places).min(axis=0, initial=1.0), 0.85)
    large = _VERTICES**2 - 2.0 * power * np.log(_VERTICES) > _LARGE
    best = int(np.argmax(np.where(large, 0.0, distance)))
    return float(_VERTICES[best] ** 2), float(distance[best])
