"""Orbits that normal forms predict near points of codimension two."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from racs_bif.equilibria.hopf_form import Complex
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True, kw_only=True)
class OrbitGuess:
    """A periodic orbit at a bifurcation of its own, as a start for its curve.

    Parameters
    ----------
    label : str
        "LPC" or "NS".
    parameters : array (2,)
        The active parameters.
    period : float
        Its period [s].
    mean, first, second : array (n,)
        Fourier coefficients: x = mean + 2 Re(first e^(i phase) + second e^(2 i phase)).
    angle : float
        Angle of the critical multipliers [rad], zero at a fold.
    """

    label: str
    parameters: Array
    period: float
    mean: Array
    first: Complex
    second: Complex
    angle: float

    def states(self, phases: Array) -> Array:
        """Return the states (n, len(phases)) at phases [rad]."""
        turn = np.exp(1j * np.asarray(phases))
        wave = np.outer(self.first, turn) + np.outer(self.second, turn * turn)
        return np.asarray(self.mean[:, None] + 2.0 * wave.real)


@dataclass(frozen=True, kw_only=True)
class HomoclinicGuess:
    """A homoclinic orbit near a Bogdanov-Takens point.

    Parameters
    ----------
    parameters : array (2,)
        The active parameters.
    saddle, middle : array (n,)
        The saddle, and the fold point around which the orbit is laid.
    q0, q1 : array (n,)
        Eigenvector and generalised eigenvector.
    a : float
        Quadratic coefficient of the normal form.
    epsilon : float
        Size: the orbit is of size epsilon^2 / a, its rates are of size epsilon.
    """

    parameters: Array
    saddle: Array
    middle: Array
    q0: Array
    q1: Array
    a: float
    epsilon: float

    def states(self, times: Array) -> Array:
        """Return the states (n, len(times)) at times [s], zero at the point far from the saddle."""
        s = self.epsilon * np.asarray(times)
        bell = 1.0 / np.cosh(s) ** 2
        w0 = self.epsilon**2 / self.a * (2.0 - 6.0 * bell)
        w1 = self.epsilon**3 / self.a * 12.0 * bell * np.tanh(s)
        return self.middle[:, None] + np.outer(self.q0, w0) + np.outer(self.q1, w1)
