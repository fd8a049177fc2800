"""Time integration of the exact fractional model by implicit steps of constant size.

``y' = g(X)`` by BDF2 and ``w = Z(s) e(X)`` by a memory, both for deviations from what was before
t = 0. Where a source (g, or the input of an element) jumps, at t = 0 or with a parameter, half the
jump is added to the step after it: without that the schemes are of first order, with it of their
own. Source: B. Jin, B. Li, Z. Zhou, *Correction of high-order BDF convolution quadrature for
fractional evolution equations*, SIAM J. Sci. Comput. 39 (2017) A3129-A3152.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.fractional.convolution_quadrature import BDF2
from racs_bif.simulation.memory import METHODS, TOLERANCE, Memory

if TYPE_CHECKING:
    from racs_bif.fractional.system import System
    from racs_bif.simulation.inputs import Inputs
    from racs_bif.simulation.start import Start
    from racs_bif.symbolic.field import Array

Progress = Callable[[float], None]
INTERRUPTED = "The user interrupted."
_NEWTON = 1e-6  # relative correction after which the next one is about its square, times the step
_ITERATIONS = 12
_REPORTS = 200


@dataclass(frozen=True)
class March:
    """What integration returns.

    Parameters
    ----------
    times : array (nt,)
        From 0, equidistant [s].
    X : array (n + ne, nt)
        States and outputs of elements.
    stopped : str
        Why it ended before its time; empty where it did not.
    """

    times: Array
    X: Array
    stopped: str = ""


class ExactStepper:
    """One time history of the exact model.

    Parameters
    ----------
    system : System
        The model.
    start : Start
        Where it begins.
    inputs : Inputs
        Its parameters as functions of time.
    count : int
        Number of steps.
    method : str
        A key of `METHODS`.
    tolerance : float
        Relative error of the fast memory's weights.
    """

    def __init__(
        self,
        system: System,
        start: Start,
        inputs: Inputs,
        count: int,
        method: str = "bdf2",
        *,
        tolerance: float = TOLERANCE,
    ) -> None:
        self.compiled = system.compiled
        self.ny = len(system.states)
        self.start = start
        self.inputs = inputs
        self.times = inputs.times(count)
        self.step = inputs.duration / count
        self.laws = system.exact.laws(system.values)
        self.memory: Memory = METHODS[method](self.laws, self.step, count, tolerance)
        self._jumps = set(inputs.jump_times)
        self._diagonal = np.concatenate(
            [np.full(self.ny, BDF2[0] / self.step), np.ones(len(start.w))]
        )
        self._gains = np.concatenate([np.ones(self.ny), self.memory.gain])
        self._scale = np.abs(start.X)

    def run(self, progress: Progress | None = None) -> March:
        """Integrate.

        Parameters
        ----------
        progress : callable, optional
            Called with the time now and then.

        Raises
        ------
        ConvergenceError
            If not even the first step can be made.
        """
        X = np.empty((len(self.times), self.compiled.size))
        X[0] = self.start.X
        every = max(1, len(self.times) // _REPORTS)
        half = self._jump(X[0], 0.0)
        n = 0
        try:
            for n in range(1, len(self.times)):
                half = self._advance(X, n, half)
                if progress is not None and n % every == 0:
                    progress(float(self.times[n]))
        except KeyboardInterrupt:
            return self._ended(X[:n], INTERRUPTED)
        except ConvergenceError as error:
            if n == 1:
                raise
            return self._ended(X[:n], f"{error}.")
        return self._ended(X, "")

    def _ended(self, X: Array, stopped: str) -> March:
        X[0, self.ny :] = self._first_outputs()
        return March(self.times[: len(X)], X.T.copy(), stopped)

    def _advance(self, X: Array, n: int, half: Array) -> Array:
        """Make step n, and return half the jump of the sources after it."""
        t, ny = float(self.times[n]), self.ny
        P = self.compiled.padded(self.inputs.values(t, before=True))
        # Deviations from the start, which are zero before it.
        one = X[n - 1, :ny] - X[0, :ny]
        two = X[n - 2, :ny] - X[0, :ny] if n > 1 else np.zeros(ny)
        past = np.concatenate([-(BDF2[1] * one + BDF2[2] * two) / self.step, self.memory.known()])
        offset = half.copy()
        offset[ny:] -= self.start.e
        guess = X[n - 1] if n < 4 else 3.0 * (X[n - 1] - X[n - 2]) + X[n - 3]
        X[n], source = self._solve(guess, P, past, offset)
        if not np.isfinite(X[n]).all():
            msg = f"the step to t = {t:g} s did not converge; take a smaller step"
            raise ConvergenceError(msg)
        np.maximum(self._scale, np.abs(X[n]), out=self._scale)
        self.memory.push(source[ny:] + offset[ny:], X[n, ny:] - self.start.w)
        return self._jump(X[n], t) if t in self._jumps else np.zeros(len(half))

    def _solve(self, X: Array, P: Array, past: Array, offset: Array) -> tuple[Array, Array]:
        """Return X of the step and its sources (g, e) by Newton's method, NaN if it fails."""
        from scipy.linalg.lapack import dgesv

        X, origin = X.copy(), self.start.X
        floor = 1e-8 * float(self._scale.max()) + 1e-30
        for _ in range(_ITERATIONS):
            source = self.compiled.core(X, P)
            jacobian = self.compiled.core_jacobian(X, P)
            residual = self._diagonal * (X - origin) - past - self._gains * (source + offset)
            matrix = -self._gains[:, None] * jacobian
            matrix.flat[:: len(X) + 1] += self._diagonal
            *_, change, singular = dgesv(matrix, residual)
            X -= change
            size = np.maximum(np.maximum(self._scale, np.abs(X)), floor)
            # Neither holds for NaN. Sources follow as exactly as X does: to second order.
            if not singular and (np.abs(change) <= _NEWTON * size).all():
                return X, source - jacobian @ change
            if singular or not np.isfinite(X).all():
                break
        return np.full_like(X, np.nan), np.full_like(X, np.nan)

    def _jump(self, X: Array, t: float) -> Array:
        """Return half the jump of the sources at a time, (g, e)."""
        core, padded = self.compiled.core, self.compiled.padded
        after = core(X, padded(self.inputs.values(t)))
        if t > 0.0:
            return np.asarray(0.5 * (after - core(X, padded(self.inputs.values(t, before=True)))))
        after[self.ny :] -= self.start.e
        return 0.5 * after

    def _first_outputs(self) -> Array:
        """Return the elements' outputs just after t = 0, NaN where they are infinite."""
        P, ny = self.compiled.padded(self.inputs.values(0.0)), self.ny
        X = self.start.X
        gains = [
            _sudden_gain(law.numerator.exponents, law.denominator.exponents) for law in self.laws
        ]
        last = [
            law.numerator.coefficients[law.numerator.exponents.argmax()]
            / law.denominator.coefficients[law.denominator.exponents.argmax()]
            for law in self.laws
        ]
        for _ in self.laws:  # elements with feedthrough feed each other in a chain at most
            jump = self.compiled.core(X, P)[ny:] - self.start.e
            for k, (gain, factor) in enumerate(zip(gains, last, strict=True)):
                known = jump[k] == 0.0 or gain == 0.0
                X[ny + k] = self.start.w[k] + (0.0 if known else gain * factor * jump[k])
        return X[ny:]


def _sudden_gain(numerator: Array, denominator: Array) -> float:
    """Return 0, 1 or NaN: whether Z vanishes at high frequency, is finite, or grows."""
    growth = float(numerator.max() - denominator.max())
    return float("nan") if growth > 0.0 else float(growth == 0.0)
