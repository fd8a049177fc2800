"""Lyapunov exponents of an ordinary differential equation, here of a realised model.

The equation is integrated together with its exact linearisation for the leading directions, which
are made orthonormal again after every interval; the logarithms of how much they grew, averaged,
are the exponents. Source: G. Benettin, L. Galgani, A. Giorgilli, J.-M. Strelcyn, *Lyapunov
characteristic exponents for smooth dynamical systems*, Meccanica 15 (1980) 9-30. Their standard
errors are estimated by batch means: averages over long pieces are nearly independent.

Memory states of a realisation add exponents of their own, negative and close to the rates of its
filters; the slowest may lie just below zero.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import ConvergenceError, UsageError

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array, VectorField

_BATCHES: Final = 16
_STUCK: Final = 1e-14  # a step smaller than this, over the interval, leads nowhere


@dataclass(frozen=True)
class LyapunovExponents:
    """The leading Lyapunov exponents.

    Parameters
    ----------
    exponents : array (k,)
        Largest first [1/s].
    errors : array (k,)
        Their standard errors [1/s].
    times : array (m,)
        Ends of the intervals after the transient [s].
    running : array (m, k)
        Averages up to those times [1/s].
    """

    exponents: Array
    errors: Array
    times: Array
    running: Array

    @property
    def dimension(self) -> float:
        """Kaplan and Yorke's dimension, NaN where more exponents are needed to tell."""
        sums = np.cumsum(self.exponents)
        if self.exponents[0] < 0.0:
            return 0.0
        below = np.flatnonzero(sums < 0.0)
        if not len(below):
            return float("nan")
        k = int(below[0])
        return float(k + sums[k - 1] / abs(self.exponents[k]))


def lyapunov_exponents(
    field: VectorField,
    x: Array,
    p: Array,
    duration: float,
    *,
    count: int = 1,
    transient: float = 0.0,
    interval: float | None = None,
    tolerance: float = 1e-8,
) -> LyapunovExponents:
    """Return the leading Lyapunov exponents along a trajectory.

    Parameters
    ----------
    field : VectorField
        The equation, for example ``system.field``.
    x : array (n,)
        Where the trajectory begins.
    p : array (np,)
        Base parameters.
    duration : float
        Over how long is averaged [s].
    count : int
        How many exponents.
    transient : float
        What is integrated before [s].
    interval : float, optional
        Time between orthonormalisations [s]; by default a four hundredth of the duration.
    tolerance : float
        Relative error of a step.

    Raises
    ------
    UsageError
        If a number cannot be used.
    ConvergenceError
        If the trajectory cannot be continued.
    """
    n = len(x)
    interval = duration / 400.0 if interval is None else interval
    if not (0.0 < interval <= duration / _BATCHES and 0.0 <= transient < np.inf):
        msg = f"give an interval up to a {_BATCHES}th of the duration, and no negative transient"
        raise UsageError(msg)
    if not 1 <= count <= n:
        msg = f"{count} exponents were asked for, the equation has {n}; give a count from 1 to {n}"
        raise UsageError(msg)
    joint = _Joint(field, p, n, count, tolerance)
    Q = np.linalg.qr(np.random.default_rng(0).normal(size=(n, count)))[0]
    for _ in range(int(np.ceil(transient / interval))):
        x, Q, _growth = joint.advance(x, Q, interval)
    rows = int(np.ceil(duration / interval))
    growth = np.empty((rows, count))
    for k in range(rows):
        x, Q, growth[k] = joint.advance(x, Q, interval)
    times = interval * np.arange(1, rows + 1, dtype=float)
    batches = [part.mean(axis=0) for part in np.array_split(growth / interval, _BATCHES)]
    return LyapunovExponents(
        exponents=growth.sum(axis=0) / times[-1],
        errors=np.std(batches, axis=0, ddof=1) / np.sqrt(_BATCHES),
        times=times,
        running=growth.cumsum(axis=0) / times[:, None],
    )


@dataclass(frozen=True)
class _Joint:
    """The equation and its linearisation, as one."""

    field: VectorField
    p: Array
    n: int
    count: int
    tolerance: float

    def advance(self, x: Array, Q: Array, interval: float) -> tuple[Array, Array, Array]:
        """Return state and directions after an interval, and the logarithms of their growth."""
        from scipy.integrate import LSODA

        z = np.concatenate([x, Q.T.ravel()])
        alive = bool(np.all(np.isfinite(self._rate(0.0, z))))
        if alive:
            solver = LSODA(
                self._rate,
                0.0,
                z,
                interval,
                rtol=self.tolerance,
                atol=1e-3 * self.tolerance,
                jac=self._jacobian,
            )
            while alive and solver.status == "running":
                with np.errstate(all="ignore"), warnings.catch_warnings():
                    warnings.simplefilter("ignore")  # a failure is told below
                    solver.step()
                alive = solver.status != "failed" and solver.t > solver.t_old + _STUCK * interval
                z = solver.y
        if not alive or not np.all(np.isfinite(z)):
            msg = "the trajectory cannot be continued; start elsewhere, or give a shorter duration"
            raise ConvergenceError(msg)
        end = np.asarray(z, dtype=float)
        Q, R = np.linalg.qr(end[self.n :].reshape(self.count, self.n).T)
        growth = np.log(np.abs(np.diag(R)))
        return end[: self.n], np.asarray(Q, dtype=float), growth

    def _rate(self, _t: float, z: Array) -> Array:
        x, V = z[: self.n], z[self.n :].reshape(self.count, self.n)
        return np.concatenate([self.field.f(x, self.p), (V @ self.field.f_x(x, self.p).T).ravel()])

    def _jacobian(self, _t: float, z: Array) -> Array:
        n, x = self.n, z[: self.n]
        V = z[n:].reshape(self.count, n).T
        single = self.field.f_x(x, self.p)
        whole: Array = np.kron(np.eye(self.count + 1), single).astype(np.float64)
        forms = np.asarray(self.field.f_xx_matrices(x, self.p, V)).real
        whole[n:, :n] = forms.reshape(self.count * n, n)
        return whole
