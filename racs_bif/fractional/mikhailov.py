"""Counting unstable characteristic roots by the phase of det Delta on the imaginary axis alone.

For a degree E at infinity and a phase that turns by phi as omega goes from 0 to infinity there are
``E/2 - phi/pi`` roots right of the axis (A. W. Mikhailov, 1938, for polynomials). What the phase
does beyond the largest and before the smallest frequency is known exactly from the leading terms.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.fractional.argument import OnContourError, Piece, follow
from racs_bif.fractional.characteristic import Characteristic
from racs_bif.fractional.polish import polish
from racs_bif.fractional.radii import annulus, inner_phase, outer_phase

if TYPE_CHECKING:
    from racs_bif.fractional.exact import ExactModel
    from racs_bif.symbolic.field import Array

_QUARTER = 0.5 * np.pi
_TRUSTED = 0.05


@dataclass(frozen=True)
class MikhailovCount:
    """Number of roots with a positive real part, from the imaginary axis.

    Parameters
    ----------
    unstable : int or None
        The number, s = 0 left out; None where roots lie on the axis: move the parameters, or use
        `racs_bif.fractional.argument.count_unstable`.
    on_axis : tuple of float
        Frequencies of roots on the axis [rad/s].
    at_zero : bool
        Whether s = 0 is a root.
    distance : float
        How far the phase was from a whole number of half turns, as a number of roots.
    evaluations : int
        Number of determinants.
    """

    unstable: int | None
    on_axis: tuple[float, ...]
    at_zero: bool
    distance: float
    evaluations: int

    @property
    def stable(self) -> bool:
        """Whether all roots are left of the imaginary axis."""
        return self.unstable == 0 and not self.at_zero


def mikhailov_count(model: ExactModel, X: Array, p: Array) -> MikhailovCount:
    """Count the unstable roots of a model at an equilibrium X (size,), parameters p (np,).

    Raises
    ------
    ConvergenceError
        If the count cannot be trusted.
    """
    return mikhailov(Characteristic.of_model(model, X, p))


def mikhailov(ch: Characteristic) -> MikhailovCount:
    """Count the unstable roots of a characteristic matrix; see `mikhailov_count`."""
    ring = annulus(ch)
    axis = Piece(lambda x: np.asarray(x + 1j * _QUARTER), ring.inner, ring.outer)
    try:
        change = follow(ch, [axis])
    except OnContourError as error:
        t, _ = polish(ch, error.places)
        frequencies = tuple(sorted(float(x) for x in np.exp(t.real)))
        return MikhailovCount(None, frequencies, ring.at_zero, 0.0, 0)
    beyond = outer_phase(ch, _QUARTER, ring.outer)
    before = 0.0 if ring.at_zero else inner_phase(ch, _QUARTER, ring.inner)
    turns = 0.5 * (ring.degree - ring.zero_order)
    turns += (beyond - before - change.log.imag) / np.pi
    number = round(turns)
    if abs(turns - number) > _TRUSTED or number < 0:
        msg = (
            f"the phase on the imaginary axis gives {turns:.3f} unstable roots, which is no count; "
            "scale the model"
        )
        raise ConvergenceError(msg)
    distance = abs(turns - number)
    return MikhailovCount(number, (), ring.at_zero, distance, change.evaluations)
