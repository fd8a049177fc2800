"""Continuation and stability analysis of dynamical systems with fractional-order elements.

Names are imported when they are first used (PEP 562), so that ``import racs_bif`` costs nothing.

Examples
--------
>>> import racs_bif as rb
>>> "load_model" in dir(rb)
True
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from racs_bif.equilibria.calibrate import calibrate
    from racs_bif.interop.feedback import with_feedback
    from racs_bif.interop.from_control import from_control
    from racs_bif.interop.linear import to_control
    from racs_bif.interop.loop import loop_response, loop_transfer, margins
    from racs_bif.interop.response import element_response, element_transfer, frequency_response
    from racs_bif.interop.root_locus import root_locus
    from racs_bif.results.branch import Branch
    from racs_bif.results.cascade import Cascade
    from racs_bif.results.chart import Chart
    from racs_bif.results.chart_slices import ChartSlices
    from racs_bif.results.diagram import Diagram
    from racs_bif.results.files import load, save
    from racs_bif.results.history import TimeHistory
    from racs_bif.shelf.load import load_model
    from racs_bif.shelf.tables import model_from_toml
    from racs_bif.symbolic.functions import model_from_function
    from racs_bif.symbolic.model import (
        Calibration,
        DerivedParameter,
        FractionalElement,
        Model,
        Parameter,
    )
    from racs_bif.symbolic.strings import model_from_strings
    from racs_bif.verbs.all_equilibria import all_equilibria
    from racs_bif.verbs.cascade import period_doubling_cascade
    from racs_bif.verbs.certify import certify
    from racs_bif.verbs.chart import chart_slices, stability_chart
    from racs_bif.verbs.curves import continue_curve
    from racs_bif.verbs.equilibria import continue_equilibria
    from racs_bif.verbs.orbit import find_orbit, orbit_from_history
    from racs_bif.verbs.orbits import continue_orbits
    from racs_bif.verbs.phase_response import phase_response
    from racs_bif.verbs.simulate import simulate
    from racs_bif.verbs.simulate_batch import simulate_batch
    from racs_bif.verbs.spectrum import spectrum

__version__ = "0.1.0.dev0"

# The same names twice: above for type checkers, here for the interpreter. A test compares them.
_HOMES: Final = {
    "Branch": "racs_bif.results.branch",
    "Calibration": "racs_bif.symbolic.model",
    "Cascade": "racs_bif.results.cascade",
    "Chart": "racs_bif.results.chart",
    "ChartSlices": "racs_bif.results.chart_slices",
    "DerivedParameter": "racs_bif.symbolic.model",
    "Diagram": "racs_bif.results.diagram",
    "FractionalElement": "racs_bif.symbolic.model",
    "Model": "racs_bif.symbolic.model",
    "Parameter": "racs_bif.symbolic.model",
    "TimeHistory": "racs_bif.results.history",
    "all_equilibria": "racs_bif.verbs.all_equilibria",
    "calibrate": "racs_bif.equilibria.calibrate",
    "certify": "racs_bif.verbs.certify",
    "chart_slices": "racs_bif.verbs.chart",
    "continue_curve": "racs_bif.verbs.curves",
    "continue_equilibria": "racs_bif.verbs.equilibria",
    "continue_orbits": "racs_bif.verbs.orbits",
    "element_response": "racs_bif.interop.response",
    "element_transfer": "racs_bif.interop.response",
    "find_orbit": "racs_bif.verbs.orbit",
    "frequency_response": "racs_bif.interop.response",
    "from_control": "racs_bif.interop.from_control",
    "load": "racs_bif.results.files",
    "load_model": "racs_bif.shelf.load",
    "loop_response": "racs_bif.interop.loop",
    "loop_transfer": "racs_bif.interop.loop",
    "margins": "racs_bif.interop.loop",
    "model_from_function": "racs_bif.symbolic.functions",
    "model_from_strings": "racs_bif.symbolic.strings",
    "model_from_toml": "racs_bif.shelf.tables",
    "orbit_from_history": "racs_bif.verbs.orbit",
    "period_doubling_cascade": "racs_bif.verbs.cascade",
    "phase_response": "racs_bif.verbs.phase_response",
    "root_locus": "racs_bif.interop.root_locus",
    "save": "racs_bif.results.files",
    "simulate": "racs_bif.verbs.simulate",
    "simulate_batch": "racs_bif.verbs.simulate_batch",
    "spectrum": "racs_bif.verbs.spectrum",
    "stability_chart": "racs_bif.verbs.chart",
    "to_control": "racs_bif.interop.linear",
    "with_feedback": "racs_bif.interop.feedback",
}

__all__ = [
    "Branch",
    "Calibration",
    "Cascade",
    "Chart",
    "ChartSlices",
    "DerivedParameter",
    "Diagram",
    "FractionalElement",
    "Model",
    "Parameter",
    "TimeHistory",
    "all_equilibria",
    "calibrate",
    "certify",
    "chart_slices",
    "continue_curve",
    "continue_equilibria",
    "continue_orbits",
    "element_response",
    "element_transfer",
    "find_orbit",
    "frequency_response",
    "from_control",
    "load",
    "load_model",
    "loop_response",
    "loop_transfer",
    "margins",
    "model_from_function",
    "model_from_strings",
    "model_from_toml",
    "orbit_from_history",
    "period_doubling_cascade",
    "phase_response",
    "root_locus",
    "save",
    "simulate",
    "simulate_batch",
    "spectrum",
    "stability_chart",
    "to_control",
    "with_feedback",
]


def __getattr__(name: str) -> object:
    """Import a public name when it is first asked for."""
    if name not in _HOMES:
        msg = f"module 'racs_bif' has no attribute '{name}'"
        raise AttributeError(msg, name=name, obj=None)
    value = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """List the public names, imported or not."""
    return sorted({*globals(), *_HOMES})
