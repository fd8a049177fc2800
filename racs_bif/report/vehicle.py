"""What the top view of a vehicle needs: where its axles are, and how it swings."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.results.branch import Profile
    from racs_bif.results.provenance import SystemInfo

YAW_RATE: Final = "w"
REAR: Final = "delta_c"
FRONT: Final = "delta_f"
LENGTHS: Final = ("a", "b", "c")


def geometry(system: SystemInfo) -> dict[str, float] | None:
    """Return the lengths and the front steering angle of a vehicle with a steered rear axle.

    Parameters
    ----------
    system : SystemInfo
        Of any model.

    Returns
    -------
    dict or None
        ``a``, ``b``, ``c`` [m]: centre of gravity to the front axle, to the rear axle, and rear
        axle to its hinge; ``delta_f`` [rad]. None for a model without these parameters and the
        states ``w`` and ``delta_c``.
    """
    needed = (*LENGTHS, FRONT)
    if not {YAW_RATE, REAR} <= set(system.states) or not set(needed) <= set(system.parameters):
        return None
    return {name: float(system.parameters[name]) for name in needed}


def yaw_angle(profile: Profile) -> NDArray[np.float64]:
    """Return the yaw angle over one period about its mean, as seen by one who turns on average.

    Parameters
    ----------
    profile : Profile
        With the yaw rate ``w``.

    Returns
    -------
    array (nt,)
        rad, counter-clockwise; the integral of the yaw rate less its mean, by the trapezoidal rule.
    """
    times, rate = profile.times, profile.states[:, profile.names.index(YAW_RATE)]
    turned = _integral(times, rate)
    if times[-1] > times[0]:
        turned -= turned[-1] * (times - times[0]) / (times[-1] - times[0])
        turned -= _integral(times, turned)[-1] / (times[-1] - times[0])
    return turned


def _integral(times: NDArray[np.float64], values: NDArray[np.float64]) -> NDArray[np.float64]:
    pieces = 0.5 * (values[1:] + values[:-1]) * np.diff(times)
    return np.concatenate([[0.0], np.cumsum(pieces)])
