"""The hot paths whose cost is kept: each a function that sets out and returns what is measured.

A path is small enough to be measured in a second or two. Models come from the cache, as they do for
a user who has run them before.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Final

import numpy as np

import racs_bif as rb
from racs_bif.fractional.argument import count_unstable
from racs_bif.fractional.exact_hopf import solve_hopf
from racs_bif.verbs.equilibria import equilibrium_problem
from racs_bif.verbs.origin import Origin

if TYPE_CHECKING:
    from racs_bif.fractional.system import System
    from racs_bif.results.branch import Branch
    from racs_bif.results.special import SpecialPoint

Run = Callable[[], object]
"""What is measured; it may be called any number of times."""

MODELS: Final = ("racs", "brusselator")
"""Those that the paths load."""
SPEEDS: Final = (5.0, 30.0)
CHART: Final = ((0.02, 0.6), (5.0, 400.0))
"""Spans of c and m_c in a chart of the vehicle."""


@dataclass(frozen=True)
class HotPath:
    """A path.

    Attributes
    ----------
    name, title : str
        What it is called on the command line and in the baselines, and what it does.
    begin : callable
        Sets out and returns what is measured.
    runs : int
        How many times it is measured, the least counts: fewer where one run takes long.
    """

    name: str
    title: str
    begin: Callable[[], Run]
    runs: int = 7


def vehicle(u: float = 20.0) -> System:
    """Return the vehicle at a speed."""
    return rb.load_model("racs", parameters={"u": u})


def hopf_point() -> SpecialPoint:
    """Return where the vehicle begins to shimmy."""
    return rb.continue_equilibria(rb.load_model("racs"), "u", (9.0, 12.0))["H1"]


# ------------------------------------------------------------------------------------ one point


def load() -> Run:
    """Load a model that the cache has."""
    rb.load_model("racs")
    return lambda: rb.load_model("racs")


def core() -> Run:
    """Evaluate the compiled core at one point."""
    system = vehicle()
    X = system.exact_point(system.equilibrium(), system.values)
    P = system.field.frame(system.values).P
    return lambda: system.compiled.core(X, P)


def core_jacobian() -> Run:
    """Evaluate the compiled core's Jacobian at one point."""
    system = vehicle()
    X = system.exact_point(system.equilibrium(), system.values)
    P = system.field.frame(system.values).P
    return lambda: system.compiled.core_jacobian(X, P)


def core_many() -> Run:
    """Evaluate the core and its Jacobian at the 160 points of an orbit's mesh."""
    system = vehicle()
    X = system.exact_point(system.equilibrium(), system.values)
    P = system.field.frame(system.values).P
    rng = np.random.default_rng(1)
    many = X[:, None] * rng.uniform(0.5, 1.5, (len(X), 160))
    return lambda: (system.compiled.core(many, P), system.compiled.core_jacobian(many, P))


def realised_jacobian() -> Run:
    """Evaluate the realised field's Jacobian, memory states included."""
    system = vehicle()
    x = system.equilibrium()
    return lambda: system.field.f_x(x, system.values)


def eigenvalues() -> Run:
    """Solve for the eigenvalues at a point of a branch."""
    system = vehicle()
    problem = equilibrium_problem(system, "u")
    z = np.append(system.equilibrium(), 20.0)
    return lambda: problem.spectrum(z)


def exact_roots() -> Run:
    """Find all exact characteristic roots right of a line."""
    system = vehicle()
    return lambda: rb.spectrum(system)


def exact_count() -> Run:
    """Count the exact unstable roots by the argument principle."""
    system = vehicle()
    X = system.exact_point(system.equilibrium(), system.values)
    return lambda: count_unstable(system.exact, X, system.values)


def exact_hopf() -> Run:
    """Solve for the exact Hopf point from an estimate that is a little off."""
    hopf = hopf_point()
    assert isinstance(hopf.origin, Origin)  # it was computed here
    system, omega = hopf.origin.system, float(hopf.origin.raw.data["omega"])
    u, path = hopf.parameters["u"], system.path("u")
    p = path.vector(u)
    X = system.exact_point(system.equilibrium(p), p)
    return lambda: solve_hopf(system.exact, path, X, 1.01 * u, 0.99 * omega)


# ------------------------------------------------------------------------------------- equilibria


def equilibria() -> Run:
    """Follow the vehicle's equilibria with everything detected."""
    system = rb.load_model("racs")
    return lambda: rb.continue_equilibria(system, "u", SPEEDS)


def hopf_curve() -> Run:
    """Follow the exact Hopf curve in two parameters."""
    hopf = hopf_point()
    C_s = vehicle().parameters["C_s"]
    spans = ((8.0, 14.0), (0.5 * C_s, 2.0 * C_s))
    return lambda: rb.continue_curve(hopf, ("u", "C_s"), spans, operator="exact")


def chart() -> Run:
    """Draw up a stability chart, its boundaries and regions."""
    system = vehicle()
    return lambda: rb.stability_chart(system, "c", "m_c", CHART)


def chart_map() -> Run:
    """Paint a map of damping over a stability chart, 60 by 60 cells."""
    system = vehicle()
    return lambda: rb.stability_chart(system, "c", "m_c", CHART, quantity="damping", shape=(60, 60))


def certify() -> Run:
    """Certify a branch on the exact equations."""
    branch = rb.continue_equilibria(rb.load_model("racs"), "u", SPEEDS)
    return lambda: rb.certify(branch)


# ----------------------------------------------------------------------------------------- orbits


def short(method: str) -> Branch:
    """Return the vehicle's orbits shortly beyond their birth."""
    return rb.continue_orbits(hopf_point(), (9.0, 12.0), method=method)


def orbits(method: str) -> Callable[[], Run]:
    """Return the path that follows a short branch of orbits with everything detected."""

    def begin() -> Run:
        hopf = hopf_point()
        return lambda: rb.continue_orbits(hopf, (9.0, 12.0), method=method)

    return begin


def correction(method: str) -> Callable[[], Run]:
    """Return the path that makes one Newton correction of an orbit."""

    def begin() -> Run:
        last = short(method).special[-1]
        assert isinstance(last.origin, Origin)  # it was computed here
        problem, z = last.origin.problem, last.origin.raw.z
        row = last.origin.raw.tangent
        right = np.append(np.zeros(len(z) - 1), 1.0)[:, None]
        # a problem may keep what it has at the last point: the points alternate
        places = itertools.cycle((z, z * (1.0 + 1e-9)))

        def correct() -> object:
            at = next(places)
            right[:-1, 0] = problem.residual(at)
            return problem.bordered(at, row)(right)

        return correct

    return begin


def brusselator() -> Run:
    """Follow the Brusselator's equilibria, and its orbits by collocation."""
    system = rb.load_model("brusselator")

    def follow() -> Branch:
        hopf = rb.continue_equilibria(system, "B", (1.0, 4.0))["H1"]
        return rb.continue_orbits(hopf, (1.0, 3.0), method="collocation")

    return follow


# ------------------------------------------------------------------------------------------ others


def simulation() -> Run:
    """Integrate the exact fractional vehicle in time, 1000 steps."""
    system = vehicle(12.0)
    return lambda: rb.simulate(system, 5.0, initial={"delta_c": 0.01}, step=0.005)


def saved() -> Run:
    """Save a branch and load it again."""
    branch = rb.continue_equilibria(rb.load_model("racs"), "u", SPEEDS)
    folder = TemporaryDirectory()

    def there_and_back(folder: TemporaryDirectory[str] = folder) -> object:
        return rb.load(rb.save(branch, Path(folder.name) / "branch.nc"))

    return there_and_back


PATHS: Final = {
    path.name: path
    for path in (
        HotPath("load", "load_model, cache hit", load),
        HotPath("core", "compiled core, one point", core),
        HotPath("core_jacobian", "its Jacobian", core_jacobian),
        HotPath("core_many", "both at 160 points", core_many),
        HotPath("realised_jacobian", "Jacobian of the realisation", realised_jacobian),
        HotPath("eigenvalues", "eigenvalues at a point", eigenvalues),
        HotPath("exact_roots", "exact roots right of -1", exact_roots),
        HotPath("exact_count", "exact count of unstable roots", exact_count),
        HotPath("exact_hopf", "exact Hopf point", exact_hopf),
        HotPath("equilibria", "equilibria, u from 5 to 30", equilibria),
        HotPath("hopf_curve", "exact Hopf curve in (u, C_s)", hopf_curve),
        HotPath("chart", "stability chart", chart),
        HotPath("chart_map", "chart with a map of 60 x 60", chart_map),
        HotPath("certify", "certify the equilibria", certify),
        HotPath("collocation_step", "Newton step, collocation", correction("collocation")),
        HotPath("shooting_step", "Newton step, shooting", correction("shooting")),
        HotPath("balance_step", "Newton step, harmonic balance", correction("harmonic-balance")),
        HotPath("collocation", "orbits to u = 12, collocation", orbits("collocation")),
        HotPath("shooting", "orbits to u = 12, shooting", orbits("shooting")),
        HotPath("balance", "orbits to u = 12, balance", orbits("harmonic-balance")),
        HotPath("brusselator", "Brusselator with its orbits", brusselator),
        HotPath("simulation", "1000 exact fractional steps", simulation),
        HotPath("saved", "a branch saved and loaded", saved),
    )
}
