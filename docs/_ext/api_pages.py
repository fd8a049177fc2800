"""The reference of the library: which public names stand on which page.

A name is put by where it is defined, so that a new one is on a page by itself; what else is passed
in or handed out is listed here.
"""

from __future__ import annotations

import inspect
from importlib import import_module
from typing import Final

import racs_bif

GROUPS: Final = (
    "models",
    "equilibria",
    "orbits",
    "time",
    "fractional",
    "charts",
    "control",
    "results",
    "settings",
    "errors",
)
_BY_HOME: Final = {
    "racs_bif.symbolic": "models",
    "racs_bif.shelf": "models",
    "racs_bif.equilibria": "equilibria",
    "racs_bif.verbs.equilibria": "equilibria",
    "racs_bif.verbs.all_equilibria": "equilibria",
    "racs_bif.verbs.curves": "equilibria",
    "racs_bif.verbs.cascade": "orbits",
    "racs_bif.verbs.orbit": "orbits",
    "racs_bif.verbs.orbits": "orbits",
    "racs_bif.verbs.phase_response": "orbits",
    "racs_bif.verbs.simulate": "time",
    "racs_bif.verbs.simulate_batch": "time",
    "racs_bif.verbs.spectrum": "fractional",
    "racs_bif.verbs.certify": "fractional",
    "racs_bif.verbs.chart": "charts",
    "racs_bif.interop": "control",
    "racs_bif.verbs": "results",
    "racs_bif.results": "results",
    "racs_bif.report": "results",
}
"""Where names of a module, or of those below it, are told; the longest that fits counts."""
FURTHER: Final = {
    "models": ("racs_bif.fractional.system.System",),
    "equilibria": ("racs_bif.equilibria.calibrate.CalibrationResult",),
    "orbits": ("racs_bif.orbits.phase_response.PhaseResponse",),
    "time": ("racs_bif.simulation.batch.BatchHistory",),
    "fractional": (
        "racs_bif.verbs.spectrum.Spectrum",
        "racs_bif.fractional.roots.Roots",
        "racs_bif.results.certificate.Certificate",
        "racs_bif.results.certificate.Check",
        "racs_bif.verbs.realisations.RealisationTable",
    ),
    "charts": (
        "racs_bif.results.chart.ChartBoundary",
        "racs_bif.results.chart.BoundaryPoint",
        "racs_bif.results.chart.ChartRegion",
        "racs_bif.results.chart_map.ChartMap",
        "racs_bif.results.chart_map.SweepMap",
        "racs_bif.results.chart_curve.ChartCurve",
    ),
    "control": (
        "racs_bif.interop.root_locus.RootLocus",
        "racs_bif.interop.loop.Margins",
        "racs_bif.plots.bode.draw",
        "racs_bif.plots.nyquist.draw",
    ),
    "results": (
        "racs_bif.results.special.SpecialPoint",
        "racs_bif.results.special.ExactPoint",
        "racs_bif.results.branch.Profile",
        "racs_bif.results.provenance.SystemInfo",
        "racs_bif.results.provenance.RealisationInfo",
    ),
    "settings": (
        "racs_bif.continuation.settings.StepSettings",
        "racs_bif.orbits.settings.OrbitSettings",
        "racs_bif.orbits.collocation_settings.CollocationSettings",
        "racs_bif.orbits.balance_settings.BalanceSettings",
        "racs_bif.charts.settings.ChartSettings",
        "racs_bif.verbs.chart_map.SweepSettings",
        "racs_bif.simulation.batch.BatchSettings",
    ),
    "errors": (
        "racs_bif.errors.RacsBifError",
        "racs_bif.errors.UsageError",
        "racs_bif.errors.ModelError",
        "racs_bif.errors.ParameterError",
        "racs_bif.errors.ConvergenceError",
        "racs_bif.errors.FileError",
    ),
}
"""Classes and functions that are not public names of the package but that its users meet."""


def group_of(name: str) -> str:
    """Return the page of a public name."""
    home = racs_bif._HOMES[name]
    fitting = [known for known in _BY_HOME if home == known or home.startswith(f"{known}.")]
    return _BY_HOME[max(fitting, key=len)] if fitting else "results"


def paths(group: str) -> list[str]:
    """Return what stands on a page, public names first."""
    public = [f"racs_bif.{name}" for name in racs_bif.__all__ if group_of(name) == group]
    return [*public, *FURTHER.get(group, ())]


def page(group: str) -> str:
    """Return a page: a directive for everything on it."""
    return "\n\n".join(_directive(path) for path in paths(group))


def _directive(path: str) -> str:
    module, _, name = path.rpartition(".")
    thing = getattr(import_module(module), name)
    lines = [f".. autofunction:: {path}"]
    if inspect.isclass(thing):
        lines = [f".. autoclass:: {path}", "   :members:", "   :exclude-members: __init__"]
    return "\n".join([f"## {name if name != 'draw' else path}", "", "```{eval-rst}", *lines, "```"])
