"""From a result, also one loaded from a file, back to the system that it was computed from."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from racs_bif.errors import ModelError, UsageError, nearest
from racs_bif.fractional.realisations import REALISATIONS
from racs_bif.fractional.system import System
from racs_bif.results.provenance import equations_digest
from racs_bif.shelf.load import base_values, system_at, system_of
from racs_bif.verbs.origin import Origin

if TYPE_CHECKING:
    from racs_bif.fractional.filter import Realisation
    from racs_bif.results.branch import Branch
    from racs_bif.results.provenance import SystemInfo
    from racs_bif.symbolic.model import Model


def rebuild(branch: Branch, model: Model | System | str | None = None) -> System:
    """Return the system that a branch was computed from.

    Parameters
    ----------
    branch : Branch
        The branch; its parameter values and realisation are taken.
    model : Model, System or str, optional
        The model, for one that was made in Python or has moved: itself, its name on the shelf or
        the path of its file.

    Raises
    ------
    UsageError
        If the model or its realisation is not known.
    ModelError
        If its equations are not those that the branch was computed with.
    """
    system = _system(branch, model)
    info = branch.system
    if info.equations and equations_digest(system) != info.equations:
        msg = (
            f"the equations of model '{system.name}' are not those that {branch.name} was computed "
            "with; compute it again, or give the model that it was computed with"
        )
        raise ModelError(msg)
    if branch.state_names and branch.state_names != system.field.states:
        how = "none" if info.realisation is None else info.realisation.name
        msg = f"the states of {branch.name} are not those of realisation '{how}'; compute it again"
        raise UsageError(msg)
    return system


def rebuild_from(info: SystemInfo, model: Model | System | str | None = None) -> System:
    """Return the system that a result without special points, such as a history, tells of.

    Raises
    ------
    UsageError, ModelError
        As `rebuild`.
    """
    system = _from_info(info, model, f"model '{info.model}'")
    if info.equations and equations_digest(system) != info.equations:
        msg = (
            f"the equations of model '{system.name}' are not those that this result was computed "
            "with; compute it again, or give the model that it was computed with"
        )
        raise ModelError(msg)
    return system


def _system(branch: Branch, model: Model | System | str | None) -> System:
    info = branch.system
    if model is None:
        known = getattr(branch.origin, "system", branch.origin)
        model = known if isinstance(known, System) else None
    if model is None:
        for point in branch.special:
            if isinstance(point.origin, Origin):
                model = point.origin.system
                break
    return _from_info(info, model, f"model '{info.model}' of {branch.name}")


def _from_info(info: SystemInfo, model: Model | System | str | None, what: str) -> System:
    if isinstance(model, System):
        return _with_values(model, info)
    if model is not None and not isinstance(model, str):
        return _with_values(system_of(model, realisation=_realisation(info)), info)
    name = model or info.loaded
    if not name:
        msg = f"{what} was made in Python, so that no file tells its equations; give the model"
        raise UsageError(msg)
    return system_at(name, info.parameters, variant=info.variant, realisation=_realisation(info))


def _with_values(system: System, info: SystemInfo) -> System:
    return replace(system, values=base_values(system.compiled, info.parameters))


def _realisation(info: SystemInfo) -> Realisation | None:
    how = info.realisation
    if how is None:
        return None
    known = REALISATIONS.get(how.name)
    if known is None:
        msg = f"unknown realisation '{how.name}'; {nearest(how.name, REALISATIONS)}"
        raise UsageError(msg)
    return known(band=how.band, **how.settings)
