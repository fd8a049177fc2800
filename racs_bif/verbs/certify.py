"""Certificates: saved special points and stability checked on the exact model, up to a proof."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

from racs_bif.errors import ConvergenceError, UsageError, nearest
from racs_bif.fractional.certificates import Resolved, resolve
from racs_bif.fractional.intervals import flint
from racs_bif.fractional.proofs import OMEGA, prove_fold, prove_hopf
from racs_bif.numerics.threads import single_threaded
from racs_bif.results.branch import Branch
from racs_bif.results.certificate import Bounds, Certificate, Check
from racs_bif.results.chart import Chart
from racs_bif.results.chart_slices import ChartSlices
from racs_bif.results.files import load
from racs_bif.results.history import TimeHistory
from racs_bif.verbs.completeness import complete
from racs_bif.verbs.rebuild import rebuild
from racs_bif.verbs.subject import Subject

if TYPE_CHECKING:
    from collections.abc import Iterator

    from racs_bif.fractional.krawczyk import Box
    from racs_bif.fractional.system import System
    from racs_bif.results.diagram import Diagram
    from racs_bif.results.special import SpecialPoint
    from racs_bif.symbolic.model import Model

STRENGTHS: Final = ("newton", "complete", "proof")
_SOLVED: Final = ("H", "LP")
_SAME: Final = 1e-8


@single_threaded
def certify(
    result: Branch | Diagram | Sequence[Branch] | str | Path,
    strength: str = "complete",
    *,
    model: Model | System | str | None = None,
    tolerance: float = 0.01,
) -> Certificate:
    """Certify branches of equilibria on the exact model, without any realisation.

    Each strength includes those before it:

    ``newton``
        Every Hopf point and fold is solved again on the exact equations, and the shift reported.
    ``complete``
        The number of exact unstable roots, by the argument principle, agrees with the stability
        reported at every point of a branch and on both sides of its special points, and changes
        nowhere else. Roots that cross twice between two neighbouring points are not seen.
    ``proof``
        Interval arithmetic proves that exactly one Hopf point, or fold, lies in a box.

    Of a model without fractional elements the exact equations are those of its differential
    equations.

    Parameters
    ----------
    result : Branch, Diagram, sequence of Branch, or path
        What to certify; a path is loaded.
    strength : {"newton", "complete", "proof"}
        How.
    model : Model, System or str, optional
        The model where the result cannot tell it: one made in Python, or one that has moved.
    tolerance : float
        Largest relative shift from the realisation's point to the exact one that is accepted.

    Returns
    -------
    Certificate

    Raises
    ------
    UsageError
        If there are no equilibria, the model is not known, or python-flint is missing for a proof.
    FileError
        If the file cannot be loaded.
    ModelError
        If the model's equations are not those of the result.

    Examples
    --------
    >>> import racs_bif as rb
    >>> branch = rb.continue_equilibria(rb.load_model("racs"), "u", (9, 12))
    >>> rb.certify(branch, "newton").holds
    True
    """
    if strength not in STRENGTHS:
        msg = f"unknown strength '{strength}'; {nearest(strength, STRENGTHS)}"
        raise UsageError(msg)
    if not 0.0 < tolerance < float("inf"):
        msg = f"tolerance {tolerance:g} cannot be used; give a positive number such as 0.01"
        raise UsageError(msg)
    if strength == "proof":
        flint()
    branches = _branches(result)
    chosen = [b for b in branches if b.kind == "equilibrium"]
    if not chosen:
        msg = "this result has no branch of equilibria to certify; give one that 'continue' saved"
        raise UsageError(msg)
    checks: list[Check] = []
    for branch in chosen:
        checks += _certified(Subject(branch, rebuild(branch, model)), strength, tolerance)
    others = ", ".join(b.name for b in branches if b.kind != "equilibrium")
    first = chosen[0]
    return Certificate(
        checks=tuple(checks),
        strength=strength,
        parameter=first.parameters[0],
        system=first.system,
        notes=(f"not certified, being no branches of equilibria: {others}",) if others else (),
    )


def _branches(result: Branch | Diagram | Sequence[Branch] | str | Path) -> list[Branch]:
    found = load(result) if isinstance(result, str | Path) else result
    if isinstance(found, Branch):
        return [found]
    return [] if isinstance(found, TimeHistory | Chart | ChartSlices) else list(found)


def _certified(subject: Subject, strength: str, tolerance: float) -> Iterator[Check]:
    """Yield the checks of one branch."""
    found: dict[str, Resolved] = {}
    for point in subject.branch.special:
        if point.label in _SOLVED:
            check, exact = _solved(subject, point, tolerance)
            yield check
            if exact is not None:
                found[point.name] = exact
    if strength != "newton":
        yield from complete(subject, found)
    if strength == "proof":
        for name, exact in found.items():
            yield _proved(subject, subject.branch[name], exact)


def _solved(
    subject: Subject, point: SpecialPoint, tolerance: float
) -> tuple[Check, Resolved | None]:
    """Solve a special point again."""
    name = subject.parameter
    exact = None
    try:
        place = subject.special_place(point)
        omega = _omega(point)
        exact = resolve(
            subject.exact,
            subject.path,
            place,
            omega,
            width=subject.width,
            tolerance=tolerance,
        )
        _check_reported(point, exact, name)
    except ConvergenceError as error:
        reported = point.parameters.get(name, float("nan"))
        return subject.check(point.name, "newton", (reported, reported), str(error)), None
    finding = f"exact {name} = {exact.value:.9g}"
    finding += f", omega = {exact.omega:.8g} rad/s" if omega else ""
    finding += f"; shift {exact.shift:.1e}, last correction {exact.correction:.0e}"
    numbers = {"value": exact.value, "shift": exact.shift, "correction": exact.correction}
    numbers |= {"omega": exact.omega} if omega else {}
    interval = (min(place.value, exact.value), max(place.value, exact.value))
    check = subject.check(point.name, "newton", interval, finding, holds=True, numbers=numbers)
    return check, exact


def _omega(point: SpecialPoint) -> float:
    """Return the frequency of a Hopf point, 0 for a fold."""
    if point.label != "H":
        return 0.0
    omega = point.data.get("omega")
    if not isinstance(omega, float) or not 0.0 < omega < float("inf"):
        msg = f"{point.name} is reported without a frequency; compute it again"
        raise ConvergenceError(msg)
    return omega


def _check_reported(point: SpecialPoint, exact: Resolved, name: str) -> None:
    """Refuse an exact point in the result that is not the one found again."""
    if point.exact is None:
        return
    reported = point.exact.parameters.get(name, exact.value)
    size = max(abs(exact.value), 1e-3)
    if abs(reported - exact.value) <= _SAME * size and (
        abs(point.exact.omega - exact.omega) <= _SAME * exact.omega
    ):
        return
    msg = (
        f"reported exact {name} = {reported:.9g}, omega = {point.exact.omega:.9g} rad/s, but the "
        f"exact point is at {name} = {exact.value:.9g}, omega = {exact.omega:.9g} rad/s; "
        "compute it again"
    )
    raise ConvergenceError(msg)


def _proved(subject: Subject, point: SpecialPoint, exact: Resolved) -> Check:
    """Prove that exactly one point lies in a box around a point that was solved again."""
    model, path, name = subject.exact, subject.path, subject.parameter
    try:
        if exact.omega:
            box = prove_hopf(model, path, exact.X, exact.value, exact.omega)
        else:
            box = prove_fold(model, path, exact.X, exact.value)
    except ConvergenceError as error:
        return subject.check(point.name, "proof", (exact.value, exact.value), str(error))
    bounds = _bounds(box)
    side = bounds[name]
    finding = f"exactly one {point.title} with {name} = {side.centre:.8g} +- {side.radius:.1e}"
    if exact.omega:
        turn = bounds[OMEGA]
        finding += f", omega = {turn.centre:.8g} +- {turn.radius:.1e} rad/s"
    finding += f"; {name} is known to {box.width(name):.0e}"
    return subject.check(
        point.name,
        "proof",
        (side.centre - side.radius, side.centre + side.radius),
        finding,
        holds=True,
        box=bounds,
    )


def _bounds(box: Box) -> dict[str, Bounds]:
    columns = zip(box.names, box.centre, box.radii, box.lower, box.upper, strict=True)
    return {
        name: Bounds(centre=float(c), radius=float(r), lower=float(low), upper=float(high))
        for name, c, r, low, high in columns
    }
