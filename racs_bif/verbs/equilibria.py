"""The branch of equilibria in one parameter, its special points checked on the exact model."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.continuation.settings import StepSettings
from racs_bif.continuation.trace import trace
from racs_bif.equilibria.branch_point import BranchPoint
from racs_bif.equilibria.fold import Fold
from racs_bif.equilibria.hopf import Hopf
from racs_bif.equilibria.problem import EquilibriumProblem
from racs_bif.errors import ConvergenceError, ParameterError, UsageError
from racs_bif.fractional.exact_form import exact_form
from racs_bif.fractional.exact_hopf import solve_hopf
from racs_bif.numerics.threads import single_threaded
from racs_bif.results.branch import Branch
from racs_bif.results.provenance import describe
from racs_bif.results.special import ExactPoint, SpecialPoint
from racs_bif.shelf.load import system_of
from racs_bif.symbolic.model import Model, find_parameter
from racs_bif.units import after, frequency_unit
from racs_bif.verbs import assemble
from racs_bif.verbs.bands import Remark, on_a_band_that_holds
from racs_bif.verbs.contradictions import contradicted, refused, without
from racs_bif.verbs.inertia import inertia_lost
from racs_bif.verbs.origin import Origin

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from racs_bif.continuation.points import Point, Trace
    from racs_bif.continuation.points import SpecialPoint as RawPoint
    from racs_bif.fractional.system import System
    from racs_bif.symbolic.field import Array

_NONE = Remark()
_SMALL = 1e-3
"""Share of the span below which a value of the parameter is no measure of its own shift."""


@single_threaded
def continue_equilibria(
    model: Model | System,
    parameter: str,
    span: tuple[float, float],
    *,
    at: Sequence[float] = (),
    settings: StepSettings | None = None,
    progress: Callable[[Point], None] | None = None,
) -> Branch:
    """Follow the equilibrium near the model's guess as one parameter moves through a span.

    Folds (LP), Hopf points (H) and branch points (BP) are located. Hopf points of a fractional
    model are solved again on its exact characteristic function, and the shift is reported. From a
    few hundred states on, where the Jacobian is sparse, the spectrum holds the eigenvalues that may
    be unstable and some near them; `stopped` says so where that search could not be complete.

    Parameters
    ----------
    model : Model or System
        What is followed; `load_model` gives a system.
    parameter : str
        Active parameter, base or derived.
    span : (float, float)
        Its interval, SI.
    at : sequence of float
        Values at which points are wanted exactly; they are labelled UZ.
    settings : StepSettings, optional
        Step control.
    progress : callable, optional
        Called with every new point.

    Returns
    -------
    Branch
        Named EQ1, of kind ``equilibrium``.

    Raises
    ------
    UsageError
        If the span is empty.
    ParameterError
        If the parameter is unknown or the span leaves the model's validity.
    ConvergenceError
        If no equilibrium is found to start from.

    Examples
    --------
    >>> import racs_bif as rb
    >>> branch = rb.continue_equilibria(rb.load_model("racs"), "u", (5, 30))
    >>> round(branch["H1"].exact.parameters["u"], 6), branch["H1"].criticality
    (10.2, 'supercritical')
    """
    system = system_of(model)
    low, high = check_span(system, parameter, span)
    wanted, chosen = tuple(at), settings or StepSettings()

    def work(system: System) -> tuple[EquilibriumProblem, Trace]:
        problem = equilibrium_problem(system, parameter)
        start = starting_point(system, parameter, (low, high))
        own = len(system.states)
        found = follow(problem, start, (low, high), chosen, own=own, at=wanted, progress=progress)
        return problem, found

    system, (problem, found), remark = on_a_band_that_holds(
        system, work, lambda _, followed: [followed]
    )
    return as_branch(system, problem, found, (low, high), remark)


def equilibrium_problem(system: System, parameter: str) -> EquilibriumProblem:
    """Return the equilibria of a system along one parameter, its outputs as measures."""
    return EquilibriumProblem(system.field, system.path(parameter), outputs_of(system))


def follow(
    problem: EquilibriumProblem,
    z: Array,
    span: tuple[float, float],
    settings: StepSettings,
    *,
    own: int | None = None,
    at: tuple[float, ...] = (),
    tangent: Array | None = None,
    progress: Callable[[Point], None] | None = None,
) -> Trace:
    """Trace the branch of equilibria through z with the detectors of its special points.

    Parameters
    ----------
    problem, z, span, settings, at, tangent, progress
        As for `racs_bif.continuation.trace.trace`.
    own : int, optional
        Number of the model's own states; all where left out.
    """
    detectors = [Fold(), BranchPoint(), Hopf(len(z) - 1 if own is None else own)]
    found = trace(
        problem,
        z,
        span,
        detectors,
        settings,
        targets=at,
        tangent=tangent,
        progress=progress,
    )
    if np.isfinite(problem.height):
        note = (
            f"Unstable eigenvalues were looked for up to an imaginary part of {problem.height:.4g} "
            "only, and those found are counted."
        )
        found.message = f"{found.message}\n{note}".strip()
    return found


def check_span(system: System, parameter: str, span: tuple[float, float]) -> tuple[float, float]:
    """Return the span as floats.

    Raises
    ------
    UsageError
        If it is empty or not finite.
    ParameterError
        If the parameter is unknown or the span leaves the model's validity.
    """
    find_parameter(parameter, [p.name for p in system.parameter_table])
    low, high = float(span[0]), float(span[1])
    if not (np.isfinite(low) and np.isfinite(high) and low < high):
        msg = f"the span {low:g} to {high:g} is empty; give a finite LOW below HIGH"
        raise UsageError(msg)
    valid = next(p.valid for p in system.parameter_table if p.name == parameter)
    if not (valid[0] < low and high < valid[1]):
        msg = (
            f"the span {low:g} to {high:g} of '{parameter}' leaves the model's validity, "
            f"{valid[0]:g} < {parameter} < {valid[1]:g}; narrow the span"
        )
        raise ParameterError(msg)
    return low, high


def outputs_of(system: System) -> Callable[[Array, Array], dict[str, float]]:
    """Return the outputs of a system as a function of states (n,) and base parameters (np,).

    Where a model has no states of its own, the outputs of its elements are among them.
    """

    def outputs(x: Array, p: Array) -> dict[str, float]:
        frame = system.field.frame(p)
        values = system.compiled.output_values(system.field.core_point(x, p), frame.P)
        named = {name: float(value) for name, value in values.items()}
        if not system.states:
            named |= zip(system.own, map(float, system.own_state(x, p)), strict=True)
        return named

    return outputs


def starting_point(system: System, parameter: str, span: tuple[float, float]) -> Array:
    """Return an equilibrium: at the parameter's own value, or an end or the middle of the span."""
    low, high = span
    own = system.parameters[parameter]
    places = [own] if low <= own <= high else []
    places += [low, high, 0.5 * (low + high)]
    path = system.path(parameter)
    for k, value in enumerate(places):
        try:
            return np.append(system.equilibrium(path.vector(value)), value)
        except ConvergenceError:
            if k == len(places) - 1:
                raise
    raise AssertionError  # the loop returns or raises


def as_branch(
    system: System,
    problem: EquilibriumProblem,
    found: Trace,
    span: tuple[float, float],
    remark: Remark = _NONE,
) -> Branch:
    """Return a traced branch as a result, its Hopf points checked on the exact model.

    On a band that leaves contradictions stability is not told where these are, and Hopf points that
    the exact equations do not have are left out.
    """
    sentence, early = assemble.stopped(found)
    gone = [] if remark.settled else list(refused(system, problem, found))
    found = without(found, gone)
    sentence += inertia_lost(system, problem, found) + _beyond_band(system, found) + remark.text
    columns = assemble.columns(found.points)
    if not remark.settled:
        early, wrong = True, contradicted(system, problem, found, gone)
        columns["stable"] = columns["stable"] & ~wrong
        columns["unstable"] = np.where(wrong, -1, columns["unstable"])
        if wrong.any():
            sentence += f" Stability is left out at {np.count_nonzero(wrong)} points."
    if gone:
        names = ", ".join(f"{p.name} at {problem.parameter} = {p.z[-1]:.6g}" for p in gone)
        sentence += f" Left out, as the exact equations have no such Hopf point: {names}."
    named = [(raw, _special(system, problem, raw, span)) for raw in found.special]
    states = np.array([p.z[:-1] for p in found.points])
    return Branch(
        name="EQ1",
        kind="equilibrium",
        parameters=problem.path.names,
        state_names=system.field.states,
        states=states,
        measures=assemble.measures(found.points),
        special=tuple(point for _, point in named),
        stopped=sentence,
        early=early,
        system=describe(system),
        method="pseudo-arclength",
        origin=system,
        **columns,
    )


def _beyond_band(system: System, found: Trace) -> str:
    """Say which Hopf points lie where the realisation is not meant to be good."""
    if not system.fractional:
        return ""
    low, high = system.settings.band
    out = [p for p in found.special if p.label == "H" and not low <= p.data["omega"] <= high]
    if not out:
        return ""
    unit = after(frequency_unit(system.time_unit))
    names = ", ".join(f"{p.name} ({p.data['omega']:.4g}{unit})" for p in out)
    return (
        f" The frequency of {names} is outside the realisation's band, {low:g} to {high:g}{unit}: "
        "trust the exact values only, or give another --band."
    )


def _special(
    system: System, problem: EquilibriumProblem, raw: RawPoint, span: tuple[float, float]
) -> SpecialPoint:
    data: dict[str, Any] = assemble.numbers(raw.data)
    exact = None
    if raw.label == "H" and system.fractional:
        try:
            exact = _exact_hopf(system, problem, raw, span[1] - span[0])
        except ConvergenceError as error:
            data["refused"] = str(error)
        law = system.field.frame(problem.path.vector(raw.z[-1]))
        s = np.array([1j * raw.data["omega"]])
        errors = [abs(f(s)[0] / z(s)[0] - 1.0) for f, z in zip(law.filters, law.laws, strict=True)]
        data["realisation_error"] = float(max(errors))
    own = system.own_state(raw.z[:-1], problem.path.vector(raw.z[-1]))
    return SpecialPoint(
        label=raw.label,
        name=raw.name,
        branch="EQ1",
        parameters={problem.parameter: raw.z[-1]},
        state=dict(zip(system.own, own, strict=True)),
        data=data,
        exact=exact,
        index=raw.index,
        origin=Origin(system, problem, raw, span),
    )


def _exact_hopf(
    system: System, problem: EquilibriumProblem, raw: RawPoint, width: float
) -> ExactPoint:
    value, omega = float(raw.z[-1]), float(raw.data["omega"])
    X = system.exact_point(raw.z[:-1], problem.path.vector(value))
    exact = solve_hopf(system.exact, problem.path, X, value, omega)
    # beside zero a relative shift says nothing: there the span is the measure
    size = abs(exact.value) if abs(exact.value) > _SMALL * width else width
    form = exact_form(system.exact, problem.path, exact)
    return ExactPoint(
        l1=form.l1,
        parameters={problem.parameter: exact.value},
        omega=exact.omega,
        shift={
            problem.parameter: (value - exact.value) / size,
            "omega": (omega - exact.omega) / exact.omega,
        },
    )
