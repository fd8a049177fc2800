"""Where branches of harmonic balance begin: at an exact Hopf point, or from a sampled orbit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.fractional.exact import ExactModel
from racs_bif.fractional.exact_hopf import solve_hopf
from racs_bif.fractional.rational import RationalField
from racs_bif.fractional.realised import RealisedField
from racs_bif.orbits.balance import Balance
from racs_bif.orbits.balance_settings import BalanceSettings
from racs_bif.orbits.diagonals import Diagonals
from racs_bif.orbits.exact_expansion import ExactExpansion, expand
from racs_bif.orbits.fourier import (
    amplitudes,
    analysed,
    points_for,
    sampled,
    to_real,
    turned,
)
from racs_bif.orbits.harmonic_balance import HarmonicBalanceProblem
from racs_bif.orbits.phase_reference import PhaseReference

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from racs_bif.equilibria.hopf_form import HopfForm
    from racs_bif.fractional.exact_hopf import ExactHopf
    from racs_bif.orbits.fourier import Complex
    from racs_bif.symbolic.field import Array, VectorField
    from racs_bif.symbolic.paths import ParameterPath

_REACH: Final = 0.05
"""Share of the parameter that the first scale of the amplitude moves it by."""
_BEND: Final = 0.5
"""Largest second order of the orbit over its first at that scale."""
_ZERO: Final = 1e-9
"""A parameter below it is zero but for rounding, and says nothing about its own magnitude."""
_STILL: Final = 1e-4
"""Unknowns that move less than this share of the others do not set a scale of their own."""


@dataclass(frozen=True, eq=False)
class BalanceStart:
    """All that the engine needs to follow a branch of orbits by harmonic balance.

    Attributes
    ----------
    problem : HarmonicBalanceProblem
        The equations.
    z : array ((2H + 1) m + 3,)
        The first point.
    tangent : array ((2H + 1) m + 3,) or None
        The direction in which to set off, where the start decides it.
    """

    problem: HarmonicBalanceProblem
    z: Array
    tangent: Array | None


def balanced_from_hopf(
    field: VectorField,
    path: ParameterPath,
    point: ArrayLike,
    omega: float,
    q: NDArray[np.complex128],
    *,
    form: HopfForm | None = None,
    settings: BalanceSettings | None = None,
) -> BalanceStart:
    """Start from a Hopf point of a realisation: the exact one near it is solved for.

    Parameters
    ----------
    field : RealisedField
        The realised model; harmonic balance uses the exact one behind it.
    path : ParameterPath
        Where the active parameter leads.
    point : array (n + 1,)
        The Hopf point, the active parameter last.
    omega : float
        Its frequency, rad per unit of time.
    q, form
        Of the realisation; the exact null vector and expansion take their place.
    settings : BalanceSettings, optional
        How orbits are resolved.

    Raises
    ------
    UsageError
        If the field does not come from a model.
    ConvergenceError
        If there is no exact Hopf point near it, or it is degenerate.
    """
    del q, form
    if not isinstance(field, RealisedField):
        raise UsageError(
            "harmonic balance needs a model, not a vector field alone: its elements have to be "
            "known exactly; take shooting or collocation"
        )
    model = operated(field, settings)
    state, value = np.split(np.asarray(point, dtype=float), [-1])
    active = float(value[0])
    frame = field.frame(path.vector(active))
    X = np.array(field.core_point(state, path.vector(active)))
    through = frame.P[len(frame.P) - (model.size - model.ny) :]
    X[model.ny :] += through * model.compiled.core(X, frame.P)[model.ny :]
    return from_exact_hopf(
        model, path, solve_hopf(model, path, X, active, omega), settings=settings
    )


def operated(field: RealisedField, settings: BalanceSettings | None) -> ExactModel:
    """Return the model that is balanced: of the exact operators or, as settings say, rational."""
    if settings is not None and settings.operator == "realised":
        field = RationalField(field.compiled, field.realisation)
    return ExactModel(field)


def from_exact_hopf(
    model: ExactModel,
    path: ParameterPath,
    hopf: ExactHopf,
    *,
    settings: BalanceSettings | None = None,
) -> BalanceStart:
    """Start the branch of orbits that is born at a Hopf point of the exact model.

    The first point is the equilibrium as an orbit of no amplitude and of period 2 pi / omega, and
    the branch leaves it along the null vector of Delta(i omega).

    Parameters
    ----------
    model : ExactModel
        The model.
    path : ParameterPath
        Where the active parameter leads.
    hopf : ExactHopf
        The Hopf point.
    settings : BalanceSettings, optional
        How orbits are resolved.

    Raises
    ------
    ConvergenceError
        If the Hopf point is degenerate.
    """
    settings = settings or BalanceSettings()
    balance = Balance(model, path, hopf.value)
    kept = list(balance.kept)
    expansion = expand(model, path, hopf)
    amplitude = _amplitude(hopf, expansion)
    spectrum = np.zeros((settings.harmonics + 1, len(kept)), dtype=complex)
    spectrum[0] = hopf.X[kept]
    still = to_real(spectrum)
    spectrum[0], spectrum[1] = 0.0, amplitude * hopf.q[kept]
    moving = to_real(spectrum)
    sizes = amplitudes(moving)
    # what the mode leaves at rest, as symmetry may have it, moves by its square
    bent = amplitude**2 * (np.abs(expansion.mean) + 2.0 * np.abs(expansion.second))[kept]
    scales = np.maximum(np.maximum(sizes, bent), _STILL * sizes.max())
    reference = PhaseReference(still, turned(moving), scales, degenerate=True)
    problem = HarmonicBalanceProblem(model, path, balance, reference, settings)
    z = problem.join(still, 2.0 * np.pi / hopf.omega, hopf.value)
    return BalanceStart(problem, z, problem.join(moving, 0.0, 0.0))


def small_orbit(
    start: BalanceStart, hopf: ExactHopf, amplitude: float, expansion: ExactExpansion
) -> Array:
    """Predict a small orbit to second order.

    Parameters
    ----------
    start : BalanceStart
        From `from_exact_hopf`.
    hopf : ExactHopf
        The Hopf point.
    amplitude : float
        a: the orbit is 2 a Re(q e^(i theta)) to first order.
    expansion : ExactExpansion
        From `racs_bif.orbits.exact_expansion.expand`.

    Returns
    -------
    array ((2H + 1) m + 3,)
        Unknowns, for Newton's method to correct.
    """
    problem = start.problem
    kept = list(problem.balance.kept)
    spectrum = np.zeros((problem.harmonics(start.z) + 1, len(kept)), dtype=complex)
    spectrum[0] = (hopf.X + amplitude**2 * expansion.mean)[kept]
    spectrum[1] = amplitude * hopf.q[kept]
    spectrum[2] = amplitude**2 * expansion.second[kept]
    omega = hopf.omega + amplitude**2 * expansion.frequency
    value = hopf.value + amplitude**2 * expansion.parameter
    return problem.join(to_real(spectrum), 2.0 * np.pi / omega, value)


def from_profile(
    model: ExactModel,
    path: ParameterPath,
    times: ArrayLike,
    profile: ArrayLike,
    value: float,
    *,
    settings: BalanceSettings | None = None,
) -> BalanceStart:
    """Start from an orbit known by samples: a simulation's tail, another method, a saved orbit.

    Parameters
    ----------
    model : ExactModel
        The model.
    path : ParameterPath
        Where the active parameter leads.
    times : array (m,)
        Rising times of the samples; the last is one period after the first.
    profile : array (ny, m)
        The model's own states there; memory states may follow and are not used.
    value : float
        The active parameter.
    settings : BalanceSettings, optional
        How orbits are resolved.

    Returns
    -------
    BalanceStart
        Problem and first guess, for Newton's method to correct; no tangent.

    Raises
    ------
    UsageError
        If the samples are too few, not finite, do not move, or do not fit the model.
    """
    settings = settings or BalanceSettings()
    balance = Balance(model, path, value)
    t, x = np.asarray(times, dtype=float), np.asarray(profile, dtype=float)
    states = _periodic(t, x, model, settings.harmonics)
    period = float(t[-1] - t[0])
    spectrum = _with_outputs(model, path.vector(value), states, period)
    series = to_real(spectrum[:, list(balance.kept)])
    sizes = amplitudes(series)
    scales = np.maximum(sizes, _STILL * sizes.max())
    reference = PhaseReference(series, turned(series), scales)
    problem = HarmonicBalanceProblem(model, path, balance, reference, settings)
    return BalanceStart(problem, problem.join(series, period, value), None)


def _periodic(t: Array, x: Array, model: ExactModel, harmonics: int) -> Complex:
    """Return the spectrum (H + 1, ny) of samples."""
    from scipy.interpolate import CubicSpline

    if t.ndim != 1 or len(t) < 5 or x.ndim != 2 or len(x) < model.ny or x.shape[1] != len(t):
        raise UsageError(
            f"an orbit of {model.ny} states is sampled as times (m,) and a profile "
            f"({model.ny}, m) with m of at least 5, not {t.shape} and {x.shape}"
        )
    x = x[: model.ny]
    if not (np.all(np.isfinite(x)) and np.all(np.isfinite(t)) and np.all(np.diff(t) > 0.0)):
        raise UsageError("the samples of an orbit must be finite and their times must rise")
    if np.ptp(x, axis=1).max() == 0.0:
        raise UsageError("the samples of an orbit must move, these are an equilibrium")
    s = (t - t[0]) / (t[-1] - t[0])
    closed = x - np.outer(x[:, -1] - x[:, 0], s)
    closed[:, -1] = closed[:, 0]
    points = points_for(harmonics)
    values = CubicSpline(s, closed.T, bc_type="periodic")(np.arange(points) / points)
    return analysed(np.ascontiguousarray(values.T), harmonics)


def _with_outputs(model: ExactModel, p: Array, states: Complex, period: float) -> Complex:
    """Return the spectrum with the elements' outputs, as far as their inputs are known."""
    harmonics = len(states) - 1
    spectrum = np.zeros((harmonics + 1, model.size), dtype=complex)
    spectrum[:, : model.ny] = states
    points = sampled(spectrum, points_for(harmonics))
    inputs = analysed(model.compiled.core(points, model.compiled.padded(p)), harmonics)
    diagonals = Diagonals.of(model, p)
    left, right = diagonals.at(np.asarray(2j * np.pi / period * np.arange(harmonics + 1)))
    for k in range(model.ny, model.size):
        gains = left[:, k] != 0.0
        spectrum[gains, k] = right[gains, k] * inputs[gains, k] / left[gains, k]
    return spectrum


def _amplitude(hopf: ExactHopf, expansion: ExactExpansion) -> float:
    """Return the amplitude a at which orbits are no longer small."""
    size = float(np.linalg.norm(hopf.q))
    bend = float(2.0 * np.linalg.norm(expansion.second) + np.linalg.norm(expansion.mean))
    curvature = abs(expansion.parameter)
    reach = _REACH * (abs(hopf.value) if abs(hopf.value) > _ZERO else 1.0)
    limits = [1.0 / size] if bend == curvature == 0.0 else []
    if bend > 0.0:
        limits.append(_BEND * size / bend)
    if curvature > 0.0:
        limits.append(float(np.sqrt(reach / curvature)))
    return min(limits)
