"""Memory states of an orbit that is known by the model's own states only."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.fractional.exact import ExactModel
from racs_bif.fractional.realised import RealisedField
from racs_bif.orbits.balance_settings import BalanceSettings
from racs_bif.orbits.balance_start import from_profile
from racs_bif.orbits.fourier import evaluated
from racs_bif.orbits.realised_orbit import realised_states

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array, VectorField
    from racs_bif.symbolic.paths import ParameterPath

_HARMONICS: Final = 200


def with_memory(
    field: VectorField, path: ParameterPath, times: Array, profile: Array, value: float
) -> Array:
    """Return an orbit with the memory states of the realisation.

    Memory is not saved, and a simulation of the exact operator has none: every harmonic of an
    element's input is passed through the filter that realises it, so that the memory is in steady
    response to the orbit. It is a guess, for Newton's method to correct.

    Parameters
    ----------
    field : VectorField
        The realised right-hand side.
    path : ParameterPath
        Where the active parameter leads.
    times : array (m,)
        Rising times of the samples; the last is one period after the first.
    profile : array (ny or more, m)
        The model's own states there.
    value : float
        The active parameter.

    Returns
    -------
    array (n, m)
        All states; `profile` itself where there is no memory.
    """
    if len(profile) == len(field.states) or not isinstance(field, RealisedField):
        return profile
    settings = BalanceSettings(harmonics=min(_HARMONICS, max(20, len(times) // 8)))
    start = from_profile(ExactModel(field), path, times, profile, value, settings=settings)
    spectrum = realised_states(start.problem.solution(start.z), field)
    full = evaluated(spectrum, (times - times[0]) / (times[-1] - times[0]))
    full[: len(profile)] = profile
    return np.asarray(full)
