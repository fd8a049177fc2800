"""From a name or a file to a system with numbers."""

from __future__ import annotations

import functools
import hashlib
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.equilibria.calibrate import calibrate
from racs_bif.errors import ModelError, RacsBifError, UsageError, nearest
from racs_bif.fractional.realisations import choose_realisation
from racs_bif.fractional.system import System
from racs_bif.shelf.closed import is_closed, rules
from racs_bif.shelf.folders import find, is_file_name
from racs_bif.shelf.modules import complaint, load_module
from racs_bif.shelf.tables import model_from_toml
from racs_bif.symbolic import cache
from racs_bif.symbolic.compiled import CompiledModel, compile_model, read_sources, write_sources
from racs_bif.symbolic.model import Calibration, Model, Parameter

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from racs_bif.fractional.filter import Realisation
    from racs_bif.symbolic.field import Array


def load_model(
    name: str,
    *,
    parameters: Mapping[str, float] | None = None,
    variant: str | None = None,
    realisation: str | Realisation | None = None,
    band: tuple[float, float] | None = None,
    order: int = 0,
) -> System:
    """Load a model by name or by the path of its file.

    Parameters
    ----------
    name : str
        A model on the shelf, or a path ending in ``.py`` or ``.toml``.
    parameters : mapping of str to float, optional
        Values, SI, of base or derived parameters other than the defaults.
    variant : str, optional
        Variant of the model.
    realisation : str or Realisation, optional
        How fractional elements are realised.
    band : (float, float), optional
        Band of the realisation [rad/s]; the model's own where left out.
    order : int
        Order (sections) of the realisation; 0 takes its default.

    Returns
    -------
    System
        Compiled, with parameter values.

    Raises
    ------
    UsageError
        If the model, variant or realisation is unknown.
    ModelError
        If the file fails or what it builds cannot be compiled.
    ParameterError
        If a parameter is unknown or outside the model's validity.

    Examples
    --------
    >>> load_model("racs", parameters={"c": 0.3}).parameters["c"]
    0.3
    """
    path = find("models", name)
    compiled = _compiled(path, {} if variant is None else {"variant": variant})

    def again(options: Mapping[str, str]) -> CompiledModel:
        return _compiled(path, dict(options))

    system = _system(compiled, again, parameters, realisation, band, order)
    return replace(system, loaded=str(path) if is_file_name("models", name) else name)


def system_at(
    name: str,
    values: Mapping[str, float],
    *,
    variant: str = "",
    realisation: Realisation | None = None,
) -> System:
    """Load a model with every base parameter given, bit for bit: nothing is calibrated or checked.

    Parameters
    ----------
    name : str
        As for `load_model`.
    values : mapping of str to float
        Values of all base parameters; others are passed over.
    variant : str
        Variant of the model, as it calls itself; empty where it has none.
    realisation : Realisation, optional
        How fractional elements are realised.

    Raises
    ------
    UsageError
        If the model is unknown.
    ModelError
        If the file fails, what it builds cannot be compiled, or a parameter has no value.
    """
    path = find("models", name)
    compiled = _compiled(path, {})
    if compiled.meta["variant"] != variant:
        compiled = _compiled(path, {"variant": variant})
    settings = realisation or choose_realisation(None, tuple(compiled.meta["band"]))
    loaded = str(path) if is_file_name("models", name) else name
    return System(compiled, base_values(compiled, values), settings, loaded)


def base_values(compiled: CompiledModel, values: Mapping[str, float]) -> Array:
    """Return all base parameters (np,) of a model, bit for bit.

    Raises
    ------
    ModelError
        If one has no value.
    """
    for parameter in compiled.parameters:
        if parameter.name not in values:
            msg = f"model '{compiled.name}' has a parameter '{parameter.name}' that has no value"
            raise ModelError(f"{msg} here; use the model that the result was computed with")
    return np.array([values[p.name] for p in compiled.parameters], dtype=float)


def system_of(
    model: Model | System,
    *,
    parameters: Mapping[str, float] | None = None,
    realisation: str | Realisation | None = None,
    band: tuple[float, float] | None = None,
    order: int = 0,
) -> System:
    """Return a system from a symbolic model; a system passes through.

    Parameters
    ----------
    model : Model or System
        What is to be computed with.
    parameters, realisation, band, order
        As in `load_model`; for a system only `parameters` may be given.
    """
    if isinstance(model, System):
        return model.with_parameters(parameters) if parameters else model
    compiled = compile_model(_checked(model))
    return _system(compiled, lambda _: compiled, parameters, realisation, band, order)


def _checked(model: object) -> Model:
    if not isinstance(model, Model):
        msg = f"{type(model).__name__} is no model; give a Model, or a name through load_model"
        raise UsageError(msg)
    return model


def _system(
    compiled: CompiledModel,
    again: Callable[[Mapping[str, str]], CompiledModel],
    parameters: Mapping[str, float] | None,
    realisation: str | Realisation | None,
    band: tuple[float, float] | None,
    order: int,
) -> System:
    low, high = band or compiled.meta["band"]
    chosen = choose_realisation(realisation, (low, high), order=order)
    values = _defaults(compiled, again)
    return System(compiled, values, chosen).with_parameters(parameters or {})


def _compiled(path: Path, options: dict[str, str]) -> CompiledModel:
    """Compile the model of a file, or take it from the cache.

    Only a file that cannot depend on anything but its own text is kept, and found, by its text; any
    other is run, and the equations that it builds are looked up.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeError) as error:
        msg = f"model file {path} cannot be read ({error}); write it in UTF-8"
        raise ModelError(msg) from error
    # A file in TOML may leave its name to that of the file.
    told = (text, path.name) if path.suffix == ".toml" else (text,)
    key = cache.key("file", rules(), *told, repr(sorted(options.items())))
    sources = read_sources(key)
    if sources is None:
        compiled = compile_model(_build(path, options))
        if compiled.external is None and is_closed(path, text):
            write_sources(key, compiled.sources)
        return compiled
    return CompiledModel(sources)


def _build(path: Path, options: dict[str, str]) -> Model:
    if path.suffix == ".toml":
        if options:
            msg = f"model '{path.stem}' has no variants; leave --variant out"
            raise UsageError(msg)
        return model_from_toml(path)
    function = getattr(load_module(path), "model", None)
    if not callable(function):
        msg = f"{path} defines no function 'model'; add 'def model() -> Model'"
        raise ModelError(msg)
    try:
        model = function(**options)
    except RacsBifError:
        raise
    except Exception as error:  # the file is the user's: anything may come out of it
        if isinstance(error, TypeError) and options and "unexpected keyword" in str(error):
            msg = f"model '{path.stem}' has no variants; leave --variant out"
            raise UsageError(msg) from error
        raise ModelError(complaint(path, error)) from error
    if not isinstance(model, Model):
        msg = f"'model()' in {path} returns {type(model).__name__}; return a racs_bif Model"
        raise ModelError(msg)
    return model


def _defaults(
    compiled: CompiledModel, again: Callable[[Mapping[str, str]], CompiledModel]
) -> Array:
    """Return default values, those that are calibrated computed or taken from the cache."""
    values = np.array([_number(p.default) for p in compiled.parameters])
    for k, parameter in enumerate(compiled.parameters):
        if isinstance(parameter.default, Calibration):
            basis = again(parameter.default.options)
            values[k] = _calibrated(basis, parameter, parameter.default)
    return values


def _number(default: float | Calibration) -> float:
    return float("nan") if isinstance(default, Calibration) else float(default)


def _calibrated(compiled: CompiledModel, parameter: Parameter, wanted: Calibration) -> float:
    key = cache.key("calibration", _package(), compiled.digest, parameter.name, repr(wanted))
    stored = cache.read(f"{key}.txt")
    if stored is not None:
        return float(stored)
    names = [p.name for p in compiled.parameters]
    start = np.array([_number(p.default) for p in compiled.parameters])
    low, high = compiled.meta["band"]
    system = System(compiled, start, choose_realisation(None, (low, high)))
    found = calibrate(system, wanted.parameter, wanted.hopf, span=wanted.span)
    if parameter.name not in {wanted.parameter, *found.sets}:
        hint = nearest(parameter.name, names)
        msg = f"calibrating '{wanted.parameter}' does not set '{parameter.name}'; {hint}"
        raise ModelError(msg)
    value = float(found.parameters[parameter.name])
    cache.write(f"{key}.txt", repr(value))
    return value


@functools.cache
def _package() -> str:
    """Return a digest of everything a computed default depends on: the whole package."""
    digest = hashlib.sha256()
    root = Path(__file__).parents[1]
    for file in sorted(root.rglob("*.py")):
        digest.update(str(file.relative_to(root)).encode())
        digest.update(file.read_bytes())
    return digest.hexdigest()
