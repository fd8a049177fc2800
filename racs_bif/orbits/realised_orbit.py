"""The realisation of a model on an orbit of the exact one: memory, monodromy, multipliers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.orbits.dense import ORDER
from racs_bif.orbits.floquet import floquet
from racs_bif.orbits.fourier import evaluated, sampled
from racs_bif.orbits.mesh import Mesh, equidistributed, rounded
from racs_bif.orbits.monodromy import transitions
from racs_bif.orbits.radau import ABSCISSAE

if TYPE_CHECKING:
    from racs_bif.fractional.realised import RealisedField
    from racs_bif.orbits.balance import Balanced
    from racs_bif.orbits.balance_settings import BalanceSettings
    from racs_bif.orbits.floquet import Floquet
    from racs_bif.orbits.fourier import Complex
    from racs_bif.symbolic.field import Array

_SEGMENTS: Final = 8
_CONSTANT: Final = 1.0 / 885.0
"""Largest value of the error function of the dense output of the Radau method."""


def multipliers_along(exact: Balanced, field: RealisedField, settings: BalanceSettings) -> Floquet:
    """Return the multipliers of the realisation's variational equation along an exact orbit.

    Parameters
    ----------
    exact : Balanced
        The orbit.
    field : RealisedField
        The realisation.
    settings : BalanceSettings
        How finely the equation is integrated.
    """
    spectrum = realised_states(exact, field)
    k = np.arange(len(spectrum))[:, None]
    # a model of elements only has no states of its own: their outputs tell how the orbit bends
    mesh = _mesh(exact.spectrum[:, : exact.balance.model.ny or None], settings)
    stages = evaluated(spectrum, mesh.times(ABSCISSAE).ravel())
    matrices = transitions(field.f_x(stages, exact.p), mesh, exact.period)
    velocities = evaluated(1j * k * spectrum, mesh.starts).T
    return floquet(matrices, velocities, _scales(spectrum))


def realised_states(exact: Balanced, field: RealisedField) -> Complex:
    """Return the spectrum of all states of the realised field (H + 1, n).

    The model's own are those of the exact orbit; the memory is in steady response to it.
    """
    frame = field.frame(exact.p)
    own = exact.balance.model.ny
    parts = [exact.spectrum[:, :own]]
    for k, law in enumerate(frame.filters, own):
        inputs, mean = exact.responses[:, k], exact.responses[0, k].real
        # the last row fixes the mean of an integrator, which A alone leaves free
        resting = np.vstack([law.A, law.C])
        output = exact.spectrum[0, k].real - law.D * mean
        rest = np.linalg.lstsq(resting, np.append(-law.B * mean, output), rcond=None)[0]
        matrix = exact.s[1:, None, None] * np.eye(len(law.B)) - law.A
        moving = np.linalg.solve(matrix, law.B[:, None] * inputs[1:, None, None])[:, :, 0]
        parts.append(np.concatenate((rest[None], moving)))
    return np.concatenate(parts, axis=1)


def _scales(spectrum: Complex) -> Array:
    """Return amplitudes (n,), none of them zero."""
    sizes = np.sqrt(np.sum(np.abs(2.0 * spectrum[1:]) ** 2, axis=0))
    floor = np.maximum(np.abs(spectrum[0]), sizes.max())
    return np.asarray(np.maximum(sizes, 1e-4 * floor + np.finfo(float).tiny))


def _mesh(spectrum: Complex, settings: BalanceSettings) -> Mesh:
    """Return steps that share out the fourth derivative of the orbit evenly.

    It decides the error of the dense output, as in shooting; the mesh depends on nothing else.
    """
    k = np.arange(len(spectrum))[:, None]
    count = rounded(max(settings.steps, 2 * len(spectrum)), _SEGMENTS)
    fourth = sampled(k**4 * spectrum, 2 * count) / _scales(spectrum)[:, None]
    bend = np.abs(fourth).max(axis=0).reshape(count, 2).max(axis=1)
    errors = _CONSTANT * (2.0 * np.pi / count) ** ORDER * bend
    needed = float(np.sum((errors / settings.multipliers) ** (1.0 / ORDER)))
    steps = min(max(int(np.ceil(1.25 * needed)), settings.steps), settings.most_steps)
    segments = _SEGMENTS * max(1, steps // 128)
    return equidistributed(Mesh.uniform(count, _SEGMENTS), errors, ORDER, steps, segments)
