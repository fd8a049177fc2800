"""Storage and loss modulus of a transfer law."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import UsageError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from racs_bif.fractional.laws import Law
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True)
class Moduli:
    """What a law does in steady harmonic motion.

    Parameters
    ----------
    omega : array
        Frequencies [rad/s].
    storage, loss : array
        Re Z(i omega) and Im Z(i omega), in the law's unit.
    """

    omega: Array
    storage: Array
    loss: Array

    @property
    def loss_factor(self) -> Array:
        """The tangent of the loss angle, loss over storage."""
        return self.loss / self.storage


def moduli(law: Law, omega: ArrayLike) -> Moduli:
    """Return storage and loss modulus.

    Parameters
    ----------
    law : Law
        The law in numbers.
    omega : array_like
        Frequencies [rad/s].

    Raises
    ------
    UsageError
        If a frequency is not positive and finite.
    """
    omega = np.asarray(omega, dtype=float)
    if not np.all((omega > 0.0) & np.isfinite(omega)):
        msg = "moduli need frequencies above zero"
        raise UsageError(msg)
    response = law(1j * omega)
    return Moduli(omega, response.real, response.imag)
