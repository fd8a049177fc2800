"""Time integration of the realised, ordinary model: scipy's integrators, exact Jacobians."""

from __future__ import annotations

import warnings
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final

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
_REPORT = 100  # steps between two reports of progress
_STUCK = 1e-14  # a step smaller than this, over the time, leads nowhere


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
        states = np.full((len(x), len(self.times)), np.nan)
        states[:, 0] = x
        stopped = ""
        for low, high in pairwise(edges):
            try:
                stopped = self._piece(states, low, high, progress)
            except KeyboardInterrupt:
                stopped = INTERRUPTED
            if stopped:
                break
        kept = int(np.all(np.isfinite(states), axis=0).cumprod().sum())
        if kept < 2:
            msg = f"model '{self.system.name}': nothing was integrated ({stopped}); start elsewhere"
            raise ConvergenceError(msg)
        times = self.times[:kept]
        return March(times, self._core_states(times, states[:, :kept]), stopped)

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

    def _piece(self, states: Array, low: float, high: float, progress: Progress | None) -> str:
        """Fill in the states at the kept times in (low, high]; return why it ended early."""
        solver = self._solver(states[:, np.searchsorted(self.times, low)], low, high)
        steps = 0
        while solver is not None and solver.status == "running":
            # What overflows is refused by the integrator, which may say so by a warning too.
            with np.errstate(all="ignore"), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                try:
                    solver.step()
                except ValueError:  # a matrix that is not finite
                    break
            moved = solver.t - solver.t_old if solver.t_old is not None else 0.0
            if solver.status == "failed" or moved <= _STUCK * high:
                break
            places = np.flatnonzero((self.times > solver.t_old) & (self.times <= solver.t))
            if len(places):
                states[:, places] = solver.dense_output()(self.times[places])
            steps += 1
            if progress is not None and steps % _REPORT == 0:
                progress(float(solver.t))
        if solver is not None and solver.status == "finished":
            return ""
        reached = low if solver is None else float(solver.t)
        return f"The integrator gave up at t = {reached:g} s."

    def _solver(self, x: Array, low: float, high: float) -> Any | None:  # noqa: ANN401 - scipy's
        """Return the integrator, None where the equations are not finite."""
        from scipy import integrate

        constant = self.inputs.values(low) if self.inputs.constant else None

        def parameters(t: float) -> Array:
            return self.inputs.values(t, before=t >= high) if constant is None else constant

        if not np.all(np.isfinite(self.field.f(x, parameters(low)))):
            return None
        return getattr(integrate, self.method)(
            lambda t, x: self.field.f(x, parameters(t)),
            low,
            x,
            high,
            rtol=self.tolerance,
            atol=_SMALL * self.tolerance,
            jac=lambda t, x: self.field.f_x(x, parameters(t)),
        )

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
