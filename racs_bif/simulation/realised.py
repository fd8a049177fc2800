"""Time integration of the realised, ordinary model: scipy's integrators, exact Jacobians."""

from __future__ import annotations

import warnings
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.simulation.exact import INTERRUPTED, March, Progress

if TYPE_CHECKING:
    from racs_bif.fractional.system import System
    from racs_bif.simulation.inputs import Inputs
    from racs_bif.simulation.start import Start
    from racs_bif.symbolic.field import Array

SOLVERS: Final = {"lsoda": "LSODA", "radau": "Radau"}
"""Integrators, by scipy's names."""
_SMALL = 1e-3  # states smaller than this, SI, are held to an absolute tolerance
_EVALUATIONS = 500  # between two reports of progress


class RealisedStepper:
    """One time history of the realised model.

    Parameters
    ----------
    system : System
        The model.
    start : Start
        Where it begins; the filters are then at rest with the history's input and output.
    inputs : Inputs
        Its parameters as functions of time.
    count : int
        Number of intervals between the times that are kept.
    method : str
        A key of `SOLVERS`.
    tolerance : float
        Relative error of a step.
    """

    def __init__(
        self,
        system: System,
        start: Start,
        inputs: Inputs,
        count: int,
        method: str = "lsoda",
        *,
        tolerance: float = 1e-8,
    ) -> None:
        self.system = system
        self.field = system.field
        self.start = start
        self.inputs = inputs
        self.times = inputs.times(count)
        self.method = SOLVERS[method]
        self.tolerance = tolerance

    def run(self, progress: Progress | None = None) -> March:
        """Integrate.

        Parameters
        ----------
        progress : callable, optional
            Called with the time now and then.

        Raises
        ------
        ConvergenceError
            If nothing can be integrated.
        """
        x = self.initial_states()
        edges = [0.0, *self.inputs.jump_times, float(self.times[-1])]
        pieces, stopped = [x[:, None]], ""
        for low, high in pairwise(edges):
            try:
                piece, stopped = self._piece(x, low, high, progress)
            except KeyboardInterrupt:
                stopped = INTERRUPTED
                break
            pieces.append(piece)
            if stopped:
                break
            x = piece[:, -1]
        states = np.concatenate(pieces, axis=1)
        if states.shape[1] == 1:
            msg = f"model '{self.system.name}': {stopped} Nothing was integrated"
            raise ConvergenceError(msg)
        times = self.times[: states.shape[1]]
        return March(times, self._core_states(times, states), stopped)

    def initial_states(self) -> Array:
        """Return the states (n,) of model and filters at t = 0."""
        parts = [self.start.y]
        filters = self.field.frame(self.system.values).filters
        for f, e, w in zip(filters, self.start.e, self.start.w, strict=True):
            # The last row fixes the state of an integrator, which A alone leaves free.
            matrix = np.vstack([f.A, f.C])
            right = np.append(-f.B * e, w - f.D * e)
            parts.append(np.linalg.lstsq(matrix, right, rcond=None)[0])
        return np.concatenate(parts)

    def _piece(
        self, x: Array, low: float, high: float, progress: Progress | None
    ) -> tuple[Array, str]:
        """Return the states at the kept times in (low, high], and why it ended early."""
        from scipy.integrate import solve_ivp

        at = self.times[(self.times > low) & (self.times <= high)]
        constant = self.inputs.values(low) if self.inputs.constant else None
        calls = 0

        def parameters(t: float) -> Array:
            if constant is not None:
                return constant
            return self.inputs.values(t, before=t >= high)

        def rate(t: float, x: Array) -> Array:
            nonlocal calls
            calls += 1
            if progress is not None and calls % _EVALUATIONS == 0:
                progress(t)
            return self.field.f(x, parameters(t))

        def jacobian(t: float, x: Array) -> Array:
            return self.field.f_x(x, parameters(t))

        settings = {"rtol": self.tolerance, "atol": _SMALL * self.tolerance, "jac": jacobian}
        kept, reached = np.empty((len(x), 0)), low
        if np.all(np.isfinite(self.field.f(x, parameters(low)))):
            # What overflows on the way is refused by the integrator, which says so by a warning.
            with np.errstate(all="ignore"), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                try:
                    found = solve_ivp(rate, (low, high), x, self.method, at, **settings)
                    kept = found.y[:, np.all(np.isfinite(found.y), axis=0)]
                except ValueError:  # a matrix that is not finite
                    pass
            if kept.shape[1] == len(at):
                return kept, ""
            reached = at[kept.shape[1] - 1] if kept.shape[1] else low
        return kept, f"The integrator gave up after t = {reached:g} s."

    def _core_states(self, times: Array, states: Array) -> Array:
        """Return states and outputs of elements (n + ne, nt)."""
        ny = len(self.system.states)
        X = self.field.core_point(states, self.system.values).copy()
        if not self.system.fractional:
            return X
        through = np.array([f.D for f in self.field.frame(self.system.values).filters])
        p = np.stack([self.inputs.values(float(t), before=bool(t > 0.0)) for t in times], axis=1)
        P = np.concatenate([p, np.broadcast_to(through[:, None], (len(through), len(times)))])
        X[ny:] += through[:, None] * self.system.compiled.core(X, P)[ny:]
        return X
