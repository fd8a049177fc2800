"""Where vehicles end that begin anywhere: on the orbit, spun out to one side or the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif import all_equilibria, load_model
from racs_bif.simulation.batch import BatchSettings
from racs_bif.verbs.simulate_batch import simulate_batch

if TYPE_CHECKING:
    from collections.abc import Callable

    from racs_bif.symbolic.field import Array

BAND: Final = (0.01, 50.0)
BOX: Final = {"v": (-8.0, 8.0), "w": (-1.2, 1.2)}
"""Initial lateral velocity [m/s] and yaw rate [rad/s]; delta_c and its rate are zero."""
OUTCOMES: Final = ("straight", "orbit", "right", "left", "unsettled")
"""Straight running; shimmy; spun out with delta_c > 0; with delta_c < 0; none of these yet."""
_LATE: Final = 15.0
"""The last stretch, by which a vehicle is judged [s]: longer than any period of the orbits."""
_STRAIGHT: Final = 0.3
"""Share of the spun-out |delta_c| within which a vehicle counts as running straight."""
_STILL: Final = 0.15
"""Range over the last stretch, relative to the spun-out |delta_c|, of a vehicle at rest."""


@dataclass(frozen=True, eq=False)
class Places:
    """Equilibria at one speed.

    Parameters
    ----------
    spun : float
        Mean |delta_c| of the spun-out equilibria; where there is none, of those at other speeds.
    stable : dict of str to int
        How many stable equilibria are ``straight``, ``right`` and ``left``.
    """

    spun: float
    stable: dict[str, int]


def places(speeds: Array) -> list[Places]:
    """Return the equilibria at each speed."""
    low, high = float(np.min(speeds)), float(np.max(speeds))
    asked = sorted({float(u) for u in speeds})
    diagram = all_equilibria(load_model("racs"), "u", (0.98 * low, 1.02 * high), at=tuple(asked))
    at: dict[float, list[tuple[float, bool]]] = {u: [] for u in asked}
    for branch in diagram:
        for point in branch.special:
            if point.label == "UZ":
                nearest = int(np.argmin(np.abs(np.array(asked) - point.parameters["u"])))
                at[asked[nearest]].append(
                    (point.state["delta_c"], bool(branch.stable[point.index]))
                )
    rows = [at[float(u)] for u in speeds]
    far = [abs(d) for row in rows for d, _ in row]
    limit = 0.5 * max(far)
    general = float(np.mean([d for d in far if d > limit]))
    found = []
    for row in rows:
        spun = [abs(d) for d, _ in row if abs(d) > limit]
        found.append(
            Places(
                float(np.mean(spun)) if spun else general,
                {
                    "straight": sum(s for d, s in row if abs(d) <= limit),
                    "right": sum(s for d, s in row if d > limit),
                    "left": sum(s for d, s in row if d < -limit),
                },
            )
        )
    return found


def outcomes(
    speed: Array,
    v: Array,
    w: Array,
    spun: Array,
    duration: float,
    progress: Callable[[float], None] | None = None,
) -> Array:
    """Return the number in `OUTCOMES` of each vehicle (N,).

    Parameters
    ----------
    speed, v, w, spun : array (N,)
        Its speed, where it begins, and |delta_c| of the spun-out equilibria at its speed.
    duration : float
        Of the simulation [s].
    progress : callable, optional
        Told the share that is done.
    """
    late = min(_LATE, 0.5 * duration)
    done = simulate_batch(
        load_model("racs", band=BAND),
        duration,
        values={"u": speed},
        initial={"v": v, "w": w},
        settings=BatchSettings(
            tolerance=1e-4, estimate=False, after=duration - late, samples=int(20 * late) + 1
        ),
        progress=None if progress is None else lambda t: progress(t / duration),
    )
    angle = done.column("delta_c")
    low, high = angle.min(axis=1) / spun, angle.max(axis=1) / spun
    still = high - low < _STILL
    straight = still & (high < _STRAIGHT) & (low > -_STRAIGHT)
    result = np.full(len(speed), OUTCOMES.index("unsettled"))
    result[~still & (low < 0.0) & (high > 0.0)] = OUTCOMES.index("orbit")
    result[still & (low > _STRAIGHT)] = OUTCOMES.index("right")
    result[still & (high < -_STRAIGHT)] = OUTCOMES.index("left")
    result[straight] = OUTCOMES.index("straight")
    result[done.failed] = OUTCOMES.index("unsettled")
    return result


def wilson(count: int, total: int) -> tuple[float, float]:
    """Return a 95 % confidence interval of a share (E. B. Wilson, JASA 22 (1927) 209-212).

    Parameters
    ----------
    count, total : int
        Successes and trials.

    Examples
    --------
    >>> [round(x, 4) for x in wilson(0, 100)]
    [0.0, 0.037]
    """
    z = 1.959963984540054
    share = count / total
    middle = (share + 0.5 * z * z / total) / (1.0 + z * z / total)
    half = z * np.sqrt(share * (1.0 - share) / total + 0.25 * (z / total) ** 2)
    half /= 1.0 + z * z / total
    low = 0.0 if count == 0 else float(middle - half)
    return low, 1.0 if count == total else float(middle + half)
