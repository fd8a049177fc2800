"""Phase response curve: how far a small kick shifts the phase of a periodic orbit, and when.

The gradient z of the asymptotic phase along the orbit is the periodic solution of the adjoint
equation z' = -A(t)^T z with z . u' = 1 (I. G. Malkin, 1949; E. Brown, J. Moehlis and P. Holmes, *On
the phase reduction and response dynamics of neural oscillator populations*, Neural Comput. 16,
2004).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.orbits.critical_mode import along_starts
from racs_bif.orbits.critical_orbit import GaussOrbits, finer, orbit_mesh, sampled
from racs_bif.orbits.piecewise import Piecewise
from racs_bif.orbits.polishing import polished
from racs_bif.orbits.twisted_solver import kernel
from racs_bif.orbits.variational import Variational
from racs_bif.units import SECONDS

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd
    from matplotlib.axes import Axes

    from racs_bif.orbits.problem import OrbitProblem
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True, eq=False)
class PhaseResponse:
    """The phase response curve of an orbit.

    A kick that moves state j by a small dx at time t advances the orbit for good by
    ``profile[j] dx`` units of time: all that follows happens so much earlier.

    Attributes
    ----------
    states : tuple of str
        The n states.
    times : array (m,)
        From 0 to the period.
    profile : array (n, m)
        Advance in time over a kick of each state [time/state].
    orbit : array (n, m)
        The states along the orbit.
    period : float
        The period.
    error : float
        Largest change of the profile on a mesh of half as many intervals more, relative to the
        largest magnitude of each state's own curve, and largest distance of z . u' from 1.
    realised : bool
        Whether it is that of the realisation of a model with fractional elements. The exact model
        remembers a kick for ever, and has a phase response in this sense only as a limit.
    units : dict of str to str
        Units of the states, where they are known.
    time_unit : str
        Unit of the time; empty where it has none.
    """

    states: tuple[str, ...]
    times: Array
    profile: Array
    orbit: Array
    period: float
    error: float
    realised: bool = False
    units: Mapping[str, str] = field(default_factory=dict)
    time_unit: str = SECONDS

    @property
    def radians(self) -> Array:
        """The profile with the phase in radians (n, m), 2 pi for one period."""
        return np.asarray(self.profile * (2.0 * np.pi / self.period))

    def to_dataframe(self) -> pd.DataFrame:
        """Return profile and orbit as a table indexed by time: ``advance by x``, ``x``, ..."""
        import pandas as pd

        columns = {f"advance by {s}": row for s, row in zip(self.states, self.profile, strict=True)}
        columns |= dict(zip(self.states, self.orbit, strict=True))
        return pd.DataFrame(columns, index=pd.Index(self.times, name="time"))

    def plot(self, name: str | None = None, *, ax: Axes | None = None) -> Axes:
        """Draw the curve of one state; see `racs_bif.plots.phase_response.draw`."""
        from racs_bif.plots.phase_response import draw

        return draw(self, name, ax=ax)


def phase_response(problem: OrbitProblem, z: Array, samples: int = 401) -> PhaseResponse:
    """Compute the phase response curve of an orbit of any discretisation.

    The orbit is solved for again by collocation of degree 6, at the same value of the parameter, on
    a mesh made for it and on a finer one. An orbit of the exact fractional operator (harmonic
    balance) is replaced by that of the realisation.

    Parameters
    ----------
    problem : OrbitProblem
        The discretisation.
    z : array
        The orbit. It should be stable: otherwise the curve is that of the phase on its stable
        manifold alone.
    samples : int
        Number m of times, equally spaced.

    Raises
    ------
    ConvergenceError
        If the orbit is not found again, or the adjoint equation cannot be solved.
    """
    fractions = np.linspace(0.0, 1.0, samples)
    guess = sampled(problem, z, orbit_mesh(problem, z))
    period = problem.period(z)
    found = []
    for _ in range(2):
        orbits = GaussOrbits(problem.field, problem.path, guess, period, float(z[-1]))
        here = polished(orbits.problem, orbits.guess, orbits.held())
        curve, period = orbits.problem.curve(here), orbits.problem.period(here)
        response, deviation = _gradient(orbits, here)
        found.append(response(fractions).T)
        guess = finer(curve)
    highest = np.maximum(np.abs(found[1]).max(axis=1), np.finfo(float).tiny)
    moved = (np.abs(found[1] - found[0]).max(axis=1) / highest).max()
    return PhaseResponse(
        states=problem.field.states,
        times=fractions * period,
        profile=found[1],
        orbit=curve(fractions).T,
        period=period,
        error=float(max(moved, deviation)),
    )


def _gradient(orbits: GaussOrbits, z: Array) -> tuple[Piecewise, float]:
    """Return z along an orbit, and how far z . u' is from 1."""
    along = orbits.along(z)
    dual = Variational(along.field, along.p, along.curve, along.period, adjoint=True)
    solved = kernel(dual, 1.0)
    flat = np.sum(solved.stages[0] * along.rates, axis=2, keepdims=True)
    mean = float(np.sum(along.weights * flat) / along.period)
    nodes = along_starts(dual, solved.starts[0], solved.stages[0]) / mean
    return Piecewise(along.curve.mesh, nodes), float(np.abs(flat / mean - 1.0).max())
