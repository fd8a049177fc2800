"""Four problems of the textbooks, what is known of them, and what a program found of that.

Equations are texts in Python's notation, from which every program is given its own.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

NEAR: Final = 1e-3
"""Relative distance within which a point found is the one known, far below their distances."""
CELLS: Final = 15
BIFURCATIONS: Final = frozenset({"H", "LP", "BP", "LPC", "BPC", "PD", "NS"})


@dataclass(frozen=True, kw_only=True)
class Problem:
    """One problem.

    Attributes
    ----------
    name, title : str
        What it is called on the command line and in the table.
    model : str
        Our model of it.
    equations : dict of str to str
        The same equations by state; texts of other names are abbreviations (`given`).
    parameter : str
        The active parameter.
    span : (float, float)
        The equilibria go from its low end to its high end; orbits start at the first Hopf point.
    guess : dict of str to float
        The equilibrium where they begin.
    orbits : (float, float)
        Span of the orbits.
    points : tuple of (str, float)
        The special points: label and value of the parameter.
    homoclinic : float, optional
        Value of the parameter at the homoclinic orbit in which the orbits end.
    cycle : bool
        Whether the orbits are those of one Brusselator, up to the end of the span.
    steps : dict of str to float
        For AUTO and what is built on it: first and longest step of equilibria (`ds`, `dsmax`) and
        of orbits (`orbit_ds`, `orbit_dsmax`), and the most points of orbits (`nmx`).
    """

    name: str
    title: str
    model: str
    equations: dict[str, str]
    parameter: str
    span: tuple[float, float]
    guess: dict[str, float]
    orbits: tuple[float, float]
    points: tuple[tuple[str, float], ...]
    steps: dict[str, float]
    given: dict[str, str] = field(default_factory=dict)
    homoclinic: float | None = None
    cycle: bool = False


@dataclass(frozen=True, kw_only=True)
class Found:
    """What a program found: points of both branches, special points by our labels, and the last.

    Attributes
    ----------
    version : str
        Of the program.
    points : int
        Points of the branches.
    special : list of (str, float)
        Special points: label and value of the parameter.
    end : (float, float)
        Parameter and period of the last orbit.
    limit : float, optional
        Where it says that the homoclinic orbit is.
    seconds : list of float
        CPU time of each run in the process.
    """

    version: str
    points: int
    special: list[tuple[str, float]]
    end: tuple[float, float]
    limit: float | None = None
    seconds: list[float] = field(default_factory=list)


@dataclass(frozen=True)
class Score:
    """How many of the known things were found and missed, what is wrong, and the largest error."""

    found: int
    missed: tuple[str, ...]
    wrong: tuple[str, ...]
    error: float


def chain(cells: int) -> dict[str, str]:
    """Return the equations of a chain of Brusselators."""
    equations = {}
    for j in range(1, cells + 1):
        a, b = max(j - 1, 1), min(j + 1, cells)
        reaction = f"x{j}**2*y{j}"
        equations[f"x{j}"] = f"1-(B+1)*x{j}+{reaction}+5*(x{a}-2*x{j}+x{b})"
        equations[f"y{j}"] = f"B*x{j}-{reaction}+5*(y{a}-2*y{j}+y{b})"
    return equations


_BRUSSELATOR: Final = Problem(
    name="brusselator",
    title="Brusselator",
    model="brusselator",
    equations={"x": "1-(B+1)*x+x**2*y", "y": "B*x-x**2*y"},
    parameter="B",
    span=(1.0, 4.0),
    guess={"x": 1.0, "y": 1.0},
    orbits=(1.0, 4.0),
    points=(("H", 2.0),),
    cycle=True,
    steps={"ds": 0.02, "dsmax": 0.2, "orbit_ds": 0.02, "orbit_dsmax": 2.0, "nmx": 300},
)
_LORENZ: Final = Problem(
    name="lorenz",
    title="Lorenz",
    model="lorenz",
    equations={"x": "10*(y-x)", "y": "r*x-y-x*z", "z": "x*y-8*z/3"},
    parameter="r",
    span=(10.0, 30.0),
    guess={"x": 4.898979485566356, "y": 4.898979485566356, "z": 9.0},
    orbits=(10.0, 30.0),
    points=(("H", 470.0 / 19.0),),
    homoclinic=13.926557407520,
    steps={"ds": 0.05, "dsmax": 1.0, "orbit_ds": -0.1, "orbit_dsmax": 2.0, "nmx": 32},
)
_AXON: Final = Problem(
    name="hodgkin_huxley",
    title="Hodgkin-Huxley",
    model="hodgkin_huxley",
    equations={
        "V": "I-120*m**3*h*(V-115)-36*n**4*(V+12)-0.3*(V-10.599)",
        "m": "am*(1-m)-4*exp(-V/18)*m",
        "h": "0.07*exp(-V/20)*(1-h)-h/(exp((30-V)/10)+1)",
        "n": "an*(1-n)-0.125*exp(-V/80)*n",
    },
    given={
        "am": "((25-V)/10)/(exp((25-V)/10)-1)",
        "an": "0.1*((10-V)/10)/(exp((10-V)/10)-1)",
    },
    parameter="I",
    span=(0.0, 200.0),
    guess={"V": 2.0329993e-5, "m": 0.05293, "h": 0.59612, "n": 0.31768},
    orbits=(0.0, 200.0),
    points=(
        ("H", 9.779637995393126),
        ("H", 154.526633665808),
        ("LPC", 7.84654712003),
        ("PD", 7.8495374),
        ("PD", 7.9219777),
        ("LPC", 7.9219854929),
        ("LPC", 6.26452127451),
    ),
    steps={"ds": 0.1, "dsmax": 5.0, "orbit_ds": 0.1, "orbit_dsmax": 5.0, "nmx": 70},
)
_CHAIN: Final = Problem(
    name="chain",
    title=f"{CELLS} Brusselators",
    model="brusselator_chain",
    equations=chain(CELLS),
    parameter="B",
    span=(1.5, 4.0),
    guess={f"{name}{j}": v for j in range(1, CELLS + 1) for name, v in (("x", 1.0), ("y", 1.5))},
    orbits=(1.5, 4.0),
    points=tuple(("H", 2.0 + 40.0 * float(np.sin(np.pi * k / (2 * CELLS)) ** 2)) for k in range(3)),
    cycle=True,
    steps={"ds": 0.1, "dsmax": 0.5, "orbit_ds": 0.5, "orbit_dsmax": 20.0, "nmx": 16},
)
PROBLEMS: Final = {p.name: p for p in (_BRUSSELATOR, _LORENZ, _AXON, _CHAIN)}


def score(problem: Problem, found: Found) -> Score:
    """Compare what was found with what is known.

    A point that is met again counts once, at its first meeting; what a branch of orbits shows at
    its own end at a Hopf point counts neither for it nor against it.
    """
    errors, missed = [], []
    for label, value in problem.points:
        met = [v for name, v in found.special if name == label and _near(v, value)]
        if met:
            errors.append(abs(met[0] / value - 1.0))
        else:
            missed.append(f"{label} at {value:.6g}")
    hopf = [value for label, value in problem.points if label == "H"]
    wrong = tuple(
        f"{label} at {value:.6g}"
        for label, value in found.special
        if label in BIFURCATIONS
        and not any(name == label and _near(value, v) for name, v in problem.points)
        and not (label in {"LPC", "BPC"} and any(_near(value, v) for v in hopf))
    )
    kind, error = _end(problem, found)
    if error is not None:
        errors.append(error)
    elif kind:
        missed.append(kind)
    return Score(len(errors), tuple(missed), wrong, max(errors, default=float("nan")))


def _near(a: float, b: float) -> bool:
    return abs(a - b) <= NEAR * abs(b)


def _end(problem: Problem, found: Found) -> tuple[str, float | None]:
    """Return what the orbits should come to, and the error; None where they do not."""
    value, period = found.end
    if problem.homoclinic is not None:
        limit = found.end[0] if found.limit is None else found.limit
        off = abs(limit / problem.homoclinic - 1.0)
        return "the homoclinic orbit", off if off < NEAR else None
    if problem.cycle:
        told = f"orbits up to {problem.orbits[1]:g} (they end at {value:.4g})"
        reached = value >= problem.orbits[1] * (1.0 - 1e-9)
        return told, abs(period / brusselator_period(value) - 1.0) if reached else None
    return "", None


def brusselator_period(B: float) -> float:
    """Return the period of the cycle of A = 1, by simulation from section to section."""
    from scipy.integrate import solve_ivp

    def field_(_: float, u: Any) -> list[float]:  # noqa: ANN401 - an array of scipy's
        x, y = u
        return [1.0 - (B + 1.0) * x + x * x * y, B * x - x * x * y]

    def section(_: float, u: Any) -> float:  # noqa: ANN401 - the same
        return float(u[0] - 1.0)

    section.direction = 1.0  # type: ignore[attr-defined]
    run = solve_ivp(
        field_, (0.0, 150.0), (1.0, B + 1.0), "DOP853", events=section, rtol=1e-12, atol=1e-13
    )
    return float(np.diff(run.t_events[0])[-1])
