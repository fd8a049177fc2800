"""What a result was computed from: the model, its values, how its elements were realised."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING

from racs_bif.units import SECONDS, frequency_unit

if TYPE_CHECKING:
    from collections.abc import Mapping

    from racs_bif.fractional.system import System


@dataclass(frozen=True, kw_only=True)
class RealisationInfo:
    """How the fractional elements were made integer-order.

    Parameters
    ----------
    name : str
        Name of the method.
    states : int
        Number of states that it adds.
    band : (float, float)
        Frequencies between which it is meant to hold, rad/s.
    error : float
        Largest relative error of the frequency response over the band.
    settings : dict of str to int or float
        Its other settings, by the names of the method's class: order, sections, omega, ...
    """

    name: str
    states: int
    band: tuple[float, float]
    error: float
    settings: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class SystemInfo:
    """The system behind a result, in words and numbers; enough to build it again.

    Parameters
    ----------
    model, title, variant : str
        Which model.
    states : tuple of str
        The model's own states, without those of a realisation; the outputs of its elements where it
        is made of elements only.
    parameters : dict of str to float
        Every parameter, derived ones too, where it is not an active one; SI.
    units : dict of str to str
        Units of states, outputs and parameters.
    shown : str
        What to plot unless the user chooses; empty for the first state.
    realisation : RealisationInfo, optional
        Absent for a model without fractional elements.
    notes : tuple of str
        What a user must be told whenever the result is shown.
    version : str
        The racs_bif that computed it.
    loaded : str
        Where `load_model` finds the model again: a name on the shelf, or the path of its file;
        empty for one that was made in Python.
    equations : str
        Digest of the model's equations, by which one that was changed since is known.
    time_unit : str
        Unit of the time; empty where it has none.
    """

    model: str
    title: str = ""
    variant: str = ""
    states: tuple[str, ...] = ()
    parameters: Mapping[str, float] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    shown: str = ""
    realisation: RealisationInfo | None = None
    notes: tuple[str, ...] = ()
    version: str = ""
    loaded: str = ""
    equations: str = ""
    time_unit: str = SECONDS

    @property
    def frequency_unit(self) -> str:
        """Unit of angular frequencies; empty where the time has no unit."""
        return frequency_unit(self.time_unit)

    def unit(self, quantity: str) -> str:
        """Return the unit of a state, output, parameter or measure; empty where there is none."""
        if quantity == "period":
            return self.time_unit
        return self.units.get(quantity.removeprefix("max ").removeprefix("min "), "")


def describe(system: System) -> SystemInfo:
    """Return what every result says of the system that it was computed from."""
    from racs_bif import __version__

    meta = system.compiled.meta
    how = system.realisation
    inputs = [name for name in meta["input_states"] if name]
    return SystemInfo(
        model=system.name,
        title=system.title,
        variant=system.variant,
        states=tuple(system.own),
        parameters=dict(system.parameters),
        units=system.state_units | {p.name: p.unit for p in system.parameter_table},
        shown=inputs[0] if inputs else "",
        realisation=RealisationInfo(
            name=how.name,
            states=how.states,
            band=how.band,
            error=float(how.error),
            settings={
                f.name: value
                for f in fields(system.settings)
                if isinstance(value := getattr(system.settings, f.name), int | float)
            },
        )
        if system.fractional
        else None,
        notes=tuple(system.notes),
        version=__version__,
        loaded=system.loaded,
        equations=equations_digest(system),
        time_unit=system.time_unit,
    )


def equations_digest(system: System) -> str:
    """Return a digest of what a model means: its equations, elements and derived parameters.

    Titles, units, notes and default values leave it as it is.
    """
    meta = system.compiled.meta
    told = {key: meta[key] for key in ("states", "equations", "mass", "elements")}
    told["parameters"] = [p["name"] for p in meta["parameters"]]
    told["derived"] = [(d["name"], d["expression"], d["sets"]) for d in meta["derived"]]
    for key in ("terms", "external"):  # left out where there are none, as before there were any
        if meta[key]:
            told[key] = meta[key]
    return hashlib.sha256(repr(told).encode()).hexdigest()
