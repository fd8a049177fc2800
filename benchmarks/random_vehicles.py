"""Random vehicles: what goes wrong with them that nobody explains.

Run ``python -m benchmarks.random_vehicles --count 10000``. Vehicle k is the same in every run; what
is done is in a file of one JSON line a vehicle, and a run goes on where the last one stopped.
``--only K`` does one vehicle and shows all that is known of it; ``--table`` of files prints what is
in them.

Of each vehicle equilibria are followed in the speed and certified on the exact equations, a small
chart is made in speed and stiffness, the first Hopf
point is followed there, and of one in ``--share`` the orbits from the first Hopf point
are followed. UNEXPECTED is: an exception that is not one of ours, a warning that reaches the user,
a Hopf point that the exact equations refuse, a stability that the argument principle contradicts,
an orbit that does not satisfy the exact equations.
"""

from __future__ import annotations

import argparse
import json
import signal
import time
import traceback
import warnings
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

import racs_bif as rb
from benchmarks._outcomes import read, table
from racs_bif.charts.settings import ChartSettings
from racs_bif.errors import ConvergenceError, RacsBifError
from racs_bif.fractional.argument import count_unstable
from racs_bif.fractional.characteristic import Characteristic
from racs_bif.fractional.polish import polish
from racs_bif.verbs.rebuild import rebuild

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from racs_bif.fractional.laws import Complex, Law
    from racs_bif.fractional.system import System
    from racs_bif.results.branch import Branch, Profile
    from racs_bif.results.certificate import Certificate
    from racs_bif.results.chart import Chart
    from racs_bif.results.special import SpecialPoint

VARIANTS: Final = ("paper", "restoring", "lagrange", "paper12", "printed", "printed12")
LIKELY: Final = (0.4, 0.2, 0.2, 0.1, 0.05, 0.05)
SPEEDS: Final = (3.0, 40.0)
METHODS: Final = ("collocation", "harmonic-balance")
ALLOWED: Final = 1e-2
"""Residual of the equations along an orbit, relative to its greatest rates."""
STARTS: Final = 100
LIKELY_STATE: Final = (10.0, 2.0, 0.5, 0.1)
"""Deviations of the random states (v, w, delta_c and its rate) that equilibria are looked for from,
and how many of them."""
DIFFERENCE: Final = 1e-4
"""The least share of its terms that a rate is compared with: they balance to 1e-6 at least."""
LEAST, MOST, FADED = 1 << 10, 1 << 14, 1e-6
"""Steps of a period that orbits are checked with, and how small their last harmonics must be."""
ON_AXIS: Final = 1e-6
"""By how much, relative, an exact root may differ from i omega of a Hopf curve."""
AT_REST: Final = 1e-9
"""By how much an equilibrium may miss the exact equations, relative to the terms."""
NAUGHT: Final = 1e-12
"""What a state at rest, as the rate of an angle, may be beside the others."""
FEW_CELLS: Final = ChartSettings(coarse=3, depth=5)
PLACES: Final = 4
"""Places of a chart at which roots are counted again."""
_UNEXPECTED: Final = "UNEXPECTED"


class TooLongError(BaseException):
    """A part took longer than it may; no `except Exception` keeps it."""


class Numbers:
    """Draws numbers from a generator."""

    def __init__(self, random: np.random.Generator) -> None:
        self._random = random

    def choice(self, names: tuple[str, ...], likely: tuple[float, ...]) -> str:
        """Return one of some names."""
        return str(self._random.choice(names, p=likely))

    def between(self, low: float, high: float) -> float:
        """Return a number, any as likely."""
        return float(self._random.uniform(low, high))


def draw(index: int) -> tuple[str, dict[str, float]]:
    """Return the variant and the parameters of a vehicle of the long run."""
    return vehicle(Numbers(np.random.default_rng([9, index])))


def vehicle(numbers: Numbers) -> tuple[str, dict[str, float]]:
    """Return the variant and the parameters of a vehicle, of a wheelchair's size to a lorry's."""
    between = numbers.between

    def over(low: float, high: float) -> float:
        return float(np.exp(between(float(np.log(low)), float(np.log(high)))))

    variant = numbers.choice(VARIANTS, LIKELY)
    a, b, m, c = between(0.6, 2.5), between(0.6, 2.5), over(400, 8000), between(0.1, 0.6)
    m_c = m * between(0.02, 0.15)
    values = {
        "delta_f": between(-0.08, 0.08),
        "m": m,
        "I_z": m * a * b * between(0.6, 1.4),
        "a": a,
        "b": b,
        "m_c": m_c,
        "I_cs": m_c * over(0.1, 1.5),
        "e": c * between(0.1, 1.2),
        "c": c,
        "d": c + between(0.1, 0.8),
        "tau_eps": over(0.01, 100.0),
        "tau_sig": over(0.01, 100.0),
        "alpha": between(0.05, 0.95),
        "gamma": between(0.05, 0.95),
    }
    for axle in "fr":
        values |= {
            f"B_{axle}": between(4.0, 15.0),
            f"C_{axle}": between(1.1, 1.7),
            f"D_{axle}": -m * between(2.5, 5.0),
            f"E_{axle}": between(-3.0, 0.8),
        }
    return variant, values | {"C_s": m * over(3.0, 200.0)}


def examine(index: int, *, share: int = 4, seconds: float = 60.0) -> dict[str, Any]:
    """Do everything with one vehicle of the long run and return its row.

    Parameters
    ----------
    index : int
        Which vehicle.
    share : int
        Orbits are followed of one vehicle in so many.
    seconds : float
        The most CPU time that each part may take.
    """
    variant, values = draw(index)
    method = "" if index % share else METHODS[index // share % 2]
    row = done_with(variant, values, places=index, method=method, seconds=seconds)
    return {"index": index} | row


def done_with(
    variant: str, values: dict[str, float], *, places: int, method: str = "", seconds: float = 60.0
) -> dict[str, Any]:
    """Do everything with a vehicle and return what came of it.

    Parameters
    ----------
    variant : str
        Of the model.
    values : dict of str to float
        Its parameters.
    places : int
        Seed of the places of its chart where roots are counted.
    method : str
        How its orbits are followed; not at all by default.
    seconds : float
        The most CPU time that each part may take.
    """
    began = time.process_time()
    told: dict[str, tuple[str, str]] = {}
    tracebacks: list[str] = []

    def part(name: str, work: Callable[[], tuple[Any, str, str]]) -> Any:  # noqa: ANN401
        result, outcome, detail, trace = _guarded(work, seconds)
        told[name] = outcome, detail
        if trace:
            tracebacks.append(trace)
        return result

    system = rb.load_model("racs", parameters=values, variant=variant)
    branch = part("continue", lambda: _continue(system))
    if branch is not None:
        part("certify", lambda: _certify(branch))
        hopf = [point for point in branch.special if point.label == "H"]
        if hopf:
            part("curve", lambda: _curve(system, hopf[0]))
        if hopf and method:
            part(f"orbits by {method}", lambda: _orbits(system, branch, method))
    part("chart", lambda: _chart(system, places))
    row: dict[str, Any] = {"variant": variant, "parts": told}
    row["seconds"] = round(time.process_time() - began, 2)
    return row | ({"tracebacks": tracebacks} if tracebacks else {})


def _guarded(work: Callable[[], tuple[Any, str, str]], seconds: float) -> tuple[Any, str, str, str]:
    """Return what a part made, its outcome, what is to be said of it, and a traceback."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            with _limited(seconds):
                result, outcome, detail = work()
        except RacsBifError as error:
            result, outcome, detail = None, "error", str(error)
        except TooLongError:
            result, outcome, detail = None, "too long", f"more than {seconds:g} s"
        except Exception as error:  # noqa: BLE001 - that is what is looked for
            told = f"{type(error).__name__}: {error}"
            return None, _UNEXPECTED, told, traceback.format_exc()
    if caught:
        first = caught[0]
        where = f"{Path(first.filename).name}:{first.lineno}"
        return result, _UNEXPECTED, f"warning at {where}: {first.message}", ""
    return result, outcome, detail, ""


@contextmanager
def _limited(seconds: float) -> Iterator[None]:
    def stop(_number: int, _frame: object) -> None:
        raise TooLongError

    # CPU time: on a busy machine nothing has taken too long that has only waited
    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def _continue(system: System) -> tuple[Branch, str, str]:
    branch = rb.continue_equilibria(system, "u", SPEEDS)
    return branch, "early" if branch.early else "ok", branch.stopped


def _certify(branch: Branch) -> tuple[Certificate, str, str]:
    certificate = rb.certify(branch, "complete")
    if certificate.holds:
        return certificate, "ok", ""
    told = ("no stability is reported", "-1 reported")
    left_out = all(any(text in check.finding for text in told) for check in certificate.failures)
    if "No wider band" in branch.stopped and left_out:
        return certificate, "early", "no band settles it"
    findings = "; ".join(f"{check.subject}: {check.finding}" for check in certificate.failures)
    return certificate, _UNEXPECTED, findings


def _curve(system: System, hopf: SpecialPoint) -> tuple[Branch, str, str]:
    """Follow the exact Hopf point in speed and stiffness; some exact roots are solved for again."""
    stiffness = system.parameters["C_s"]
    spans = {"u": SPEEDS, "C_s": (0.5 * stiffness, 2.0 * stiffness)}
    curve = rb.continue_curve(hopf, ("u", "C_s"), spans, operator="exact")
    for k in np.unique(np.linspace(0, len(curve) - 1, PLACES).astype(int)):
        place = dict(zip(curve.parameters, map(float, curve.values[k]), strict=True))
        at, omega = system.with_parameters(place), float(curve.measures["omega"][k])
        where = ", ".join(f"{name} = {value:.6g}" for name, value in place.items())
        X = _at_rest(at, curve.states[k, : len(system.states)])
        left = np.abs(at.exact.residual(X, at.values))
        sizes = np.maximum(np.abs(X), NAUGHT * np.abs(X).max())
        if np.any(left > AT_REST * (np.abs(at.exact.jacobian(X, at.values)) @ sizes)):
            return curve, _UNEXPECTED, f"no exact equilibrium at {where}"
        ch = Characteristic.of_model(at.exact, X, at.values)
        root = np.exp(polish(ch, np.log(np.array([1j * omega])))[0])[0]
        if not (curve.measures["neutral"][k] or abs(root - 1j * omega) < ON_AXIS * omega):
            return curve, _UNEXPECTED, f"no exact root at i {omega:.6g} at {where}"
    return curve, "early" if curve.early else "ok", curve.stopped


def _at_rest(system: System, y: np.ndarray) -> np.ndarray:
    """Return states and the outputs that elements have at rest.

    Nothing is solved: beside a fold Newton's method could not better it.
    """
    ny, p = len(y), system.values
    X = np.append(y, np.zeros(system.exact.size - ny))
    inputs = system.compiled.core(X, system.compiled.padded(p))[ny:]
    gains = [law.static_gain for law in system.exact.laws(p)]
    X[ny:] = gains * inputs
    return X


def _orbits(system: System, branch: Branch, method: str) -> tuple[Branch, str, str]:
    hopf = next(point for point in branch.special if point.label == "H")
    u = hopf.parameters["u"]
    span = max(SPEEDS[0], 0.9 * u), min(SPEEDS[1], 1.1 * u)
    orbits = rb.continue_orbits(hopf, span, method=method)
    # the library says itself that it no longer resolves what it ends with
    resolved = {p.name for p in orbits.special if p.label != "MX"} & orbits.profiles.keys()
    realised = rebuild(orbits) if method == "collocation" and orbits.system.realisation else None
    slowest = realised.realisation.band[0] if realised is not None else 0.0
    left_out = []
    for name in sorted(resolved):
        profile = orbits.profiles[name]
        # and that the realisation's orbits beyond its band are not to be trusted
        if 2.0 * np.pi / (profile.times[-1] - profile.times[0]) < slowest:
            continue
        place = orbits[name].parameters
        # and, by the last harmonics, how well the series are known
        data = orbits[name].data
        tail, harmonics = (float(data.get(what, 0.0)) for what in ("tail", "harmonics"))  # type: ignore[arg-type]
        error = tail, tail * harmonics
        at = (realised or system).with_parameters(place)
        law_error = 0.0 if realised is None else realised.realisation.error
        residuals = {"exact": exact_residual(at, profile, error, law_error)}
        if realised is not None:
            residuals["realised"] = realised_residual(at, profile)
        for which, residual in residuals.items():
            if residual is not None and residual > ALLOWED:
                told = f"{name} leaves the {which} equations a residual of {residual:.2g}"
                return orbits, _UNEXPECTED, told
        if None in residuals.values():
            left_out.append(name)
    told = f" Too sharp to be checked: {', '.join(left_out)}." if left_out else ""
    return orbits, "early" if orbits.early or left_out else "ok", orbits.stopped + told


def exact_residual(
    system: System,
    profile: Profile,
    error: tuple[float, float] = (0.0, 0.0),
    law_error: float = 0.0,
) -> float | None:
    """Return by how much an orbit misses the exact equations, over its greatest rates.

    None where so many equal steps as are taken at most do not resolve it.

    A rate that is a far smaller difference of terms, as accelerations of slow orbits are of forces,
    is known by the samples to a share of these terms only; and to the orbit's own errors, relative,
    of them and of its rates, over a turn. An orbit of a realisation is that of the exact equations
    but for what its elements' outputs are wrong by: that error of each of their harmonics.

    Samples of one period are Fourier transformed; element k answers ``exp(i omega t)`` by its law
    at ``i omega``. Nothing of the library's orbit methods is used.
    """

    def answers(law: Law, rates: Complex) -> Complex:
        return np.array([law.numerator.at_zero / law.denominator.at_zero, *law(rates[1:])])

    laws = [partial(answers, law) for law in system.exact.laws(system.values)]
    return _residual(system, profile, laws, error, law_error)


def realised_residual(system: System, profile: Profile) -> float | None:
    """Return by how much an orbit misses the realised equations, as `exact_residual`.

    Elements answer by the transfer functions of their filters.
    """
    return _residual(system, profile, system.field.frame(system.values).filters)


def _residual(
    system: System,
    profile: Profile,
    laws: Sequence[Callable[[Complex], Complex]],
    error: tuple[float, float] = (0.0, 0.0),
    law_error: float = 0.0,
) -> float | None:
    states, times = profile.states, profile.times
    if np.ptp(states, axis=0).max() < 1e-9:
        return 0.0  # the Hopf point: no orbit yet
    period = times[-1] - times[0]
    y = _samples(times, np.vstack([states[:-1], states[:1]]))
    if y is None:
        return None
    count = len(y)
    rates = 2j * np.pi / period * np.fft.rfftfreq(count, 1.0 / count)
    slopes = np.fft.irfft(rates[:, None] * np.fft.rfft(y, axis=0), count, axis=0)

    padded = system.compiled.padded(system.values)
    w, wrong = np.zeros((count, len(laws))), np.zeros(y.shape[1] + len(laws))
    e = _core(system, y, w, padded)[:, y.shape[1] :]
    for k, law in enumerate(laws):
        harmonics = law(rates) * np.fft.rfft(e[:, k])
        w[:, k] = np.fft.irfft(harmonics, count)
        wrong[y.shape[1] + k] = law_error * 2.0 / count * np.abs(harmonics[1:]).sum()
    miss = slopes - _core(system, y, w, padded)[:, : y.shape[1]]
    jacobian = system.compiled.core_jacobian(np.append(y.mean(axis=0), w.mean(axis=0)), padded)
    spread = np.ptp(np.hstack([y, w]), axis=0)
    terms, allowed = (np.abs(jacobian) @ np.column_stack([spread, error[0] * spread + wrong])).T
    allowed[: y.shape[1]] += error[1] * 2.0 * np.pi / period * spread[: y.shape[1]]
    sizes = np.maximum(np.abs(slopes).max(axis=0), DIFFERENCE * terms[: y.shape[1]])
    beyond = np.maximum(np.abs(miss).max(axis=0) - allowed[: y.shape[1]], 0.0)
    return float((beyond / sizes).max())


def _samples(times: np.ndarray, states: np.ndarray) -> np.ndarray | None:
    """Return an orbit at enough equal steps, None if that would be too many."""
    from scipy.interpolate import CubicSpline

    steps, period = np.diff(times), times[-1] - times[0]
    if np.ptp(steps) < 1e-9 * period and len(steps) < LEAST:
        # known at equal steps already: its own harmonics are exact
        return np.asarray(np.fft.irfft(np.fft.rfft(states[:-1], axis=0), LEAST, axis=0)) * (
            LEAST / len(steps)
        )
    through, count = CubicSpline(times, states, bc_type="periodic"), LEAST
    while count <= MOST:
        y = np.asarray(through(times[0] + period * np.arange(count) / count))
        sizes = np.abs(np.fft.rfft(y, axis=0))[1:]
        if np.all(sizes[-len(sizes) // 8 :].max(axis=0) <= FADED * sizes.max(axis=0)):
            return y
        count *= 2
    return None


def _core(system: System, y: np.ndarray, w: np.ndarray, padded: np.ndarray) -> np.ndarray:
    core = system.compiled.core
    return np.array([core(np.append(one, out), padded) for one, out in zip(y, w, strict=True)])


def _chart(system: System, seed: int) -> tuple[Chart, str, str]:
    """Make a chart on few cells; where a count refuses it, on as many as by default."""
    stiffness = system.parameters["C_s"]
    spans = (SPEEDS, (0.5 * stiffness, 2.0 * stiffness))
    random = np.random.default_rng([10, seed])
    low, high = np.array(spans).T
    places = low + random.random((PLACES, 2)) * (high - low)
    chart = rb.stability_chart(system, "u", "C_s", spans, settings=FEW_CELLS)
    wrong = _contradiction(system, chart, places)
    if not wrong:
        return chart, "early" if chart.early else "ok", " | ".join(chart.troubles)
    finer = _contradiction(system, rb.stability_chart(system, "u", "C_s", spans), places)
    if finer:
        return chart, _UNEXPECTED, finer
    return chart, "early", f"{wrong}; not on the default's cells"


def _contradiction(system: System, chart: Chart, places: np.ndarray) -> str:
    for place, told in zip(places, chart.unstable_on(places), strict=True):
        at = system.with_parameters(dict(zip(("u", "C_s"), place, strict=True)))
        counted = set[int]()
        for count in _counts(at) if told >= 0 else ():
            counted.add(count)
            if told in counted:
                break
        if counted and told >= 0 and told not in counted:
            where = f"u = {place[0]:.6g}, C_s = {place[1]:.6g}"
            return f"at {where} the chart says {told} unstable roots, counted are {counted}"
    return ""


def _counts(system: System) -> Iterator[int]:
    """Yield the numbers of unstable roots of the equilibria there, as they are found.

    The chart's equilibrium is continued from elsewhere; it need not be the one that Newton's
    method finds from the model's guess.
    """
    p, random = system.values, np.random.default_rng(11)
    found: list[np.ndarray] = []
    for _ in range(STARTS):
        guess = random.standard_normal(system.exact.size) * np.append(LIKELY_STATE, 0.5)
        with suppress(ConvergenceError):
            X = system.exact.equilibrium(random.uniform(0.0, 1.5) * guess, p)
            if not any(np.abs(X - Y).max() < 1e-6 for Y in found):
                found.append(X)
                yield count_unstable(system.exact, X, p).unstable


def _bad(row: dict[str, Any]) -> bool:
    return any(
        outcome in {_UNEXPECTED, "error", "too long"} for outcome, _ in row["parts"].values()
    )


def main() -> None:
    """Examine vehicles and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=10_000, help="how many vehicles, from 0")
    parser.add_argument("--share", type=int, default=4, help="orbits of one vehicle in so many")
    parser.add_argument(
        "--limit", type=float, default=60.0, help="CPU seconds that a part may take"
    )
    parser.add_argument("--file", type=Path, default=Path("random_vehicles.jsonl"))
    parser.add_argument(
        "--part", type=int, nargs=2, default=(0, 1), metavar=("K", "OF"), help="every OF-th, from K"
    )
    parser.add_argument(
        "--again",
        action="store_true",
        help="examine again what went wrong or took too long",
    )
    parser.add_argument("--only", type=int, help="examine this vehicle alone")
    parser.add_argument("--table", type=Path, nargs="+", help="print what is in these files")
    options = parser.parse_args()
    if options.table:
        print(table(read(options.table)))
        return
    if options.only is not None:
        print(draw(options.only))
        row = examine(options.only, share=1, seconds=options.limit)
        print(json.dumps(row, indent=1), *row.get("tracebacks", ()), sep="\n")
        return
    done = {row["index"] for row in read([options.file]) if not (options.again and _bad(row))}
    with options.file.open("a", encoding="utf-8") as file:
        file.write("\n" if done else "")  # after a line that was cut off
        for index in range(options.part[0], options.count, options.part[1]):
            if index not in done:
                row = examine(index, share=options.share, seconds=options.limit)
                file.write(json.dumps(row) + "\n")
                file.flush()
    print(table(read([options.file])))


if __name__ == "__main__":
    main()
