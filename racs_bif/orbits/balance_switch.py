"""Branches of harmonic balance that begin on another: doubled, crossing, another parameter's."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.fractional.realised import RealisedField
from racs_bif.orbits.balance import Balance
from racs_bif.orbits.balance_start import BalanceStart, from_profile, operated
from racs_bif.orbits.fourier import doubled, harmonics_of, odd, turned
from racs_bif.orbits.harmonic_balance import HarmonicBalanceProblem
from racs_bif.orbits.phase_reference import PhaseReference
from racs_bif.orbits.switching import leave, null_direction

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from racs_bif.orbits.balance_settings import BalanceSettings
    from racs_bif.symbolic.field import Array, VectorField
    from racs_bif.symbolic.paths import ParameterPath

_SINGULAR: Final = 0.05
"""How nearly singular the equations of two turns must be.

Multipliers, and with them the doubling, are those of the realisation: the exact equations are
singular near it.
"""


def balanced_from_samples(
    field: VectorField,
    path: ParameterPath,
    times: ArrayLike,
    profile: ArrayLike,
    value: float,
    *,
    settings: BalanceSettings | None = None,
) -> BalanceStart:
    """Start from an orbit of a realised model known by samples; see `from_profile`.

    Raises
    ------
    UsageError
        If the field does not come from a model, or as `from_profile`.
    """
    if not isinstance(field, RealisedField):
        raise UsageError("harmonic balance needs a model, not a vector field alone")
    return from_profile(operated(field, settings), path, times, profile, value, settings=settings)


def balanced_through(
    problem: HarmonicBalanceProblem,
    z: Array,
    path: ParameterPath,
    value: float,
    settings: BalanceSettings | None = None,
    scales: Array | None = None,
) -> BalanceStart:
    """Start at an orbit of another branch, with a parameter of one's own.

    Parameters
    ----------
    problem : HarmonicBalanceProblem
        The problem that the orbit is a solution of.
    z : array ((2H + 1) m + 3,)
        The orbit.
    path : ParameterPath
        Where the active parameter leads, which may be another.
    value : float
        Its value at the orbit.
    settings : BalanceSettings, optional
        How orbits are resolved; by default as on the other branch.
    scales : array, optional
        Scales of the unknown states; by default as on the other branch.
    """
    balance = Balance(problem.model, path, value)
    if balance.kept != problem.balance.kept:
        # what is an affine law at one parameter need not be one at another
        fractions = np.linspace(0.0, 1.0, 8 * problem.harmonics(z) + 1)
        times, profile = fractions * problem.period(z), problem.sample(z, fractions)
        return from_profile(problem.model, path, times, profile, value, settings=settings)
    series = problem.series(z).copy()
    scales = problem.reference(z).scales if scales is None else scales
    reference = PhaseReference(series, turned(series), scales)
    chosen = settings or problem.settings
    own = HarmonicBalanceProblem(problem.model, path, balance, reference, chosen)
    return BalanceStart(own, own.join(series, problem.period(z), value), None)


def balanced_doubled(problem: HarmonicBalanceProblem, z: Array, tangent: Array) -> BalanceStart:
    """Start the branch of orbits of twice the period: the subharmonics of the series.

    Parameters
    ----------
    problem : HarmonicBalanceProblem
        The problem whose branch the doubling lies on.
    z, tangent : array ((2H + 1) m + 3,)
        The period doubling and the direction of its branch.

    Raises
    ------
    UsageError
        If the equations of two turns are far from singular there.
    """
    series = doubled(problem.series(z))

    def twice(scales: Array) -> tuple[HarmonicBalanceProblem, Array]:
        reference = PhaseReference(series, turned(series), scales, degenerate=True)
        longer = HarmonicBalanceProblem(
            problem.model, problem.path, problem.balance, reference, problem.settings, turns=2
        )
        return longer, longer.join(series, 2.0 * problem.period(z), float(z[-1]))

    longer, start = twice(problem.reference(z).scales)
    along = doubled(problem.series(tangent))
    known = longer.join(along, 2.0 * float(tangent[-3]), float(tangent[-1]))
    mode = longer.series(null_direction(longer, start, known, _SINGULAR)).copy()
    mode[~odd(harmonics_of(mode))] = 0.0
    found = leave(longer, start, longer.join(mode, 0.0, 0.0), twice)
    assert isinstance(found.problem, HarmonicBalanceProblem)
    return BalanceStart(found.problem, found.z, found.direction)
