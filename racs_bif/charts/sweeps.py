"""Maps by simulation: what every cell settles on, from its own equilibrium displaced."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import UsageError, nearest
from racs_bif.simulation.attractors import NOWHERE, SETTLED, Attractors, amplitudes, periods
from racs_bif.simulation.batch_field import BatchField
from racs_bif.simulation.batch_lyapunov import largest_exponents

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.charts.plane import Plane
    from racs_bif.fractional.system import System
    from racs_bif.symbolic.field import Array

SWEEPS: Final = ("amplitude", "lyapunov", "periods")
"""Maps that need simulations."""
KICK: Final = 0.05


@dataclass(frozen=True, kw_only=True)
class Sweep:
    """What is simulated in every cell of a map.

    Parameters
    ----------
    duration : float
        For how long [s]; the second half counts.
    watch : str
        The state whose amplitude, or crossings, are meant.
    start : mapping of str to float
        States at t = 0, SI. The others begin at the cell's equilibrium; where none is given all are
        displaced from it, by `KICK` times one plus their magnitude. The memory is that of a model
        that had always been at the equilibrium.
    tolerance : float
        Relative error of a step.

    Raises
    ------
    UsageError
        If a number is out of its range.
    """

    duration: float
    watch: str
    start: Mapping[str, float] = field(default_factory=dict)
    tolerance: float = 1e-5

    def __post_init__(self) -> None:
        """Check the numbers."""
        if not 0.0 < self.duration < np.inf:
            msg = f"the duration of a map's simulations is {self.duration:g} s; give a positive one"
            raise UsageError(msg)
        if not 0.0 < self.tolerance <= 0.01:
            msg = f"the tolerance of a map's simulations is {self.tolerance:g}; give up to 0.01"
            raise UsageError(msg)

    def check(self, system: System) -> None:
        """Refuse states that the system does not have.

        Raises
        ------
        UsageError
            With its name, and the nearest that there is.
        """
        for name in (self.watch, *self.start):
            if name not in system.states:
                msg = f"unknown state '{name}'; {nearest(name, system.states)}"
                raise UsageError(msg)


def swept(
    plane: Plane, quantity: str, sweep: Sweep, X: Array, P: Array
) -> tuple[dict[str, Array], NDArray[np.int8], NDArray[np.int64]]:
    """Simulate cells.

    Parameters
    ----------
    plane : Plane
        Where they are.
    quantity : str
        One of `SWEEPS`.
    sweep : Sweep
        What is simulated.
    X, P : arrays (size, N) and (np, N)
        Equilibria and base parameters.

    Returns
    -------
    dict of arrays (N,)
        ``value`` and ``error``, NaN where unknown.
    int array (N,)
        As of `racs_bif.simulation.attractors.Attractors`.
    int array (N,)
        Steps that were made.
    """
    system = plane.system
    equations = BatchField(system, np.ascontiguousarray(P))
    ny = equations.ny
    rest = [system.field.rest(x[:ny], x[ny:], p) for x, p in zip(X.T, P.T, strict=True)]
    begin = np.array(rest).T
    if sweep.start:
        for name, value in sweep.start.items():
            begin[system.states.index(name)] = value
    else:
        begin[:ny] += KICK * (1.0 + np.abs(begin[:ny]))
    x = equations.from_states(begin)
    row = system.states.index(sweep.watch)
    compute: dict[str, Callable[[], Attractors]] = {
        "amplitude": lambda: amplitudes(equations, x, sweep.duration, row, sweep.tolerance),
        "periods": lambda: periods(equations, x, sweep.duration, row, sweep.tolerance),
        "lyapunov": lambda: largest_exponents(equations, x, sweep.duration, sweep.tolerance),
    }
    found = compute[quantity]()
    return {"value": found.value, "error": found.error}, found.status, found.steps


def nothing(shape: tuple[int, ...]) -> dict[str, NDArray[np.generic]]:
    """Return the arrays of a map of which nothing is known."""
    return {
        "value": np.full(shape, np.nan),
        "error": np.full(shape, np.nan),
        "status": np.full(shape, NOWHERE, dtype=np.int8),
    }


def unknown(status: NDArray[np.int8]) -> int:
    """Return the number of cells that are not certain."""
    return int(np.count_nonzero(status != SETTLED))
