"""All exact characteristic roots of a fractional model right of a vertical line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.fractional.argument import OnContourError, count_right
from racs_bif.fractional.characteristic import Characteristic
from racs_bif.fractional.radii import Annulus, annulus
from racs_bif.fractional.search import Zeros, zeros_in_rectangle

if TYPE_CHECKING:
    from racs_bif.fractional.laws import Complex
    from racs_bif.fractional.system import System
    from racs_bif.symbolic.field import Array

_MARGINS = (0.0517, 0.0371, 0.0873, 0.0213, 0.1291)
_ON_AXIS = 1e-9


@dataclass(frozen=True)
class Roots:
    """Characteristic roots on the principal sheet.

    Parameters
    ----------
    roots : array (k,)
        The roots, rightmost first, a complex pair with its positive imaginary part first.
    errors : array (k,)
        Moduli of the last Newton corrections; for a multiple root the error of the mean, or how far
        its roots lie apart where that is felt.
    multiplicities : array (k,) of int
        Multiplicities.
    above : float
        All roots with Re s > above are here.
    unstable : int
        Number of roots with Re s > 0, with multiplicity; those on the axis and s = 0 left out.
    count_checked : int
        Number of roots right of the line by the argument principle along the line: the same, or
        there would have been an error.
    on_axis : tuple of float
        Frequencies [rad/s] of roots on the imaginary axis, within 1e-9 of their modulus.
    zero_order : float
        Power of s with which det Delta vanishes at s = 0, to about 1e-2; 0 where s = 0 is no root.
        It is not among `roots`.
    on_cut : array
        Negative real numbers where det Delta vanishes on both lips of the branch cut, right of the
        line. They are not on the principal sheet, and not among `roots`.
    """

    roots: Complex
    errors: Array
    multiplicities: np.ndarray
    above: float
    unstable: int
    count_checked: int
    on_axis: tuple[float, ...]
    zero_order: float
    on_cut: Array

    @property
    def at_zero(self) -> bool:
        """Whether s = 0 is a root."""
        return self.zero_order > 0.0


def characteristic_roots(system: System, *, above: float = -1.0) -> Roots:
    """Find all exact characteristic roots right of a line, at the system's equilibrium.

    Parameters
    ----------
    system : System
        A model with numbers.
    above : float
        The line Re s = above [rad/s].

    Returns
    -------
    Roots

    Raises
    ------
    ConvergenceError
        If there is no equilibrium, or roots found and roots counted do not agree.

    Examples
    --------
    >>> from racs_bif.shelf.load import load_model
    >>> print(characteristic_roots(load_model("racs", parameters={"u": 12.0})).roots[0].round(8))
    (0.49290598+8.93656849j)
    """
    p = system.values
    X = system.exact_point(system.equilibrium(), p)
    return roots_right(Characteristic.of_model(system.exact, X, p), above)


def roots_right(ch: Characteristic, above: float = -1.0) -> Roots:
    """Find all roots of det Delta(s) = 0 right of Re s = above; see `characteristic_roots`."""
    if not np.isfinite(above):
        msg = "the line of the roots is not finite; give a number"
        raise ConvergenceError(msg)
    ring = annulus(ch)
    zeros = _zeros(ch, ring, above)
    s, errors, multiplicities, on_cut = _unfolded(ch, zeros)
    on_cut = on_cut[on_cut > above]
    # A root on the line belongs to neither side; the count uses the same distance.
    right = s.real > above + np.where(np.abs(s.real - above) <= 1e-6 * np.abs(s), errors, 0.0)
    s, errors, multiplicities = s[right], errors[right], multiplicities[right]
    count = count_right(ch, above, ring=ring)
    near = np.abs(s.real - above) <= 1e-6 * np.abs(s)
    least, most = int(multiplicities[~near].sum()), int(multiplicities.sum())
    if not least <= count.unstable <= most:
        msg = (
            f"{most} characteristic roots were found right of Re s = {above:g}, but the argument "
            f"principle counts {count.unstable}; move the line or scale the model"
        )
        raise ConvergenceError(msg)
    order = np.lexsort((-s.imag, -np.abs(s.imag), -s.real))
    s, errors, multiplicities = s[order], errors[order], multiplicities[order]
    on_axis = np.abs(s.real) <= np.maximum(_ON_AXIS * np.abs(s), errors)
    unstable = int(multiplicities[(s.real > 0.0) & ~on_axis].sum())
    return Roots(
        roots=s,
        errors=errors,
        multiplicities=multiplicities,
        above=above,
        unstable=unstable,
        count_checked=count.unstable,
        on_axis=tuple(float(x.imag) for x in s[on_axis] if x.imag > 0.0),
        zero_order=ring.zero_order,
        on_cut=on_cut,
    )


def _zeros(ch: Characteristic, ring: Annulus, above: float) -> Zeros:
    """Return zeros over log s in the closed upper half of the principal sheet, and some more."""
    least = ring.inner if above <= 0.0 else max(ring.inner, float(np.log(above)))
    angle = np.pi if above < 0.0 else 0.5 * np.pi
    if least >= ring.outer:
        return Zeros(np.zeros(0, complex), np.zeros(0), np.zeros(0, dtype=int))
    problem: OnContourError | None = None
    for margin in _MARGINS:
        low, high = complex(least - margin, -margin), complex(ring.outer + margin, angle + margin)
        try:
            return zeros_in_rectangle(ch, low, high)
        except OnContourError as error:
            problem = error
    msg = f"the region of the characteristic roots cannot be bounded ({problem}); scale the model"
    raise ConvergenceError(msg)


def _unfolded(ch: Characteristic, zeros: Zeros) -> tuple[Complex, Array, np.ndarray, Array]:
    """Return roots s with errors and multiplicities, both of each pair, and those on the cut."""
    t, errors = zeros.t, zeros.errors
    slack = 1e2 * errors
    real = np.abs(t.imag) <= slack
    cut = np.abs(t.imag - np.pi) <= slack
    pairs = (t.imag > slack) & (t.imag < np.pi - slack)
    size = np.exp(t.real)
    on_cut = -size[cut]
    single = real | cut if ch.integer else real
    values = np.where(cut, -size, np.where(real, size, np.exp(t)))
    keep = np.concatenate([np.flatnonzero(single), np.repeat(np.flatnonzero(pairs), 2)])
    s = values[keep].astype(complex)
    s[single.sum() + 1 :: 2] = s[single.sum() + 1 :: 2].conj()
    if ch.integer:
        on_cut = np.zeros(0)
    return s, (errors * size)[keep], zeros.multiplicities[keep], np.sort(on_cut)[::-1]
