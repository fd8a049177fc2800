"""Models from TOML files: tables of expressions, parsed and never run."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from racs_bif.errors import ModelError, nearest
from racs_bif.symbolic.model import DerivedParameter, Model, Parameter
from racs_bif.symbolic.strings import check_name, number, parse, plain, read_element, read_table

if TYPE_CHECKING:
    import sympy as sp

    from racs_bif.symbolic.model import FractionalElement

_FIELDS: Final = ("unit", "description", "source", "valid")
"""What may be said of a parameter, apart from its value."""
_LARGEST = 5_000_000


def model_from_toml(path: str | Path) -> Model:
    """Build a model from a TOML file.

    The tables are ``[equations]`` (state to right-hand side; required), ``[parameters]`` (name to
    default, or to ``{default, unit, description, source, valid = [LOW, HIGH]}``), ``[guess]``,
    ``[elements.OUTPUT]`` (``input``, ``law``: a fractional element), ``[outputs]``, ``[terms]``
    (shared terms), ``[derived.NAME]`` (``expression``, ``sets``, and what a parameter may have),
    ``[units]`` and ``[descriptions]`` of states and outputs. Before them may stand ``name``,
    ``title``, ``source``, ``notes``, ``inputs``, ``band`` and ``mass`` (rows of expressions).
    Expressions are those of `model_from_strings`: they are parsed, never evaluated as Python.

    Parameters
    ----------
    path : str or Path
        The file.

    Returns
    -------
    Model

    Raises
    ------
    ModelError
        If the file cannot be read, holds an unknown key, or an expression cannot be understood.
    """
    file = Path(path)
    data = _read(file)
    try:
        return _model(file, data)
    except ModelError as inner:
        msg = f"{file.name}: {inner}"
        raise ModelError(msg) from None
    except RecursionError:
        msg = f"{file.name}: an expression is nested too deeply; split it"
        raise ModelError(msg) from None


def _read(file: Path) -> dict[str, Any]:
    import tomllib

    try:
        if file.stat().st_size > _LARGEST:
            msg = f"model file {file} is larger than {_LARGEST // 10**6} MB; split the model"
            raise ModelError(msg)
        return tomllib.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        msg = f"model file {file} cannot be read ({error.strerror or error}); check its path"
        raise ModelError(msg) from None
    except UnicodeDecodeError as error:
        why = f"{error.reason} at byte {error.start}"
        msg = f"model file {file} is no text in UTF-8: {why}; write it in UTF-8"
        raise ModelError(msg) from None
    except RecursionError:
        msg = f"model file {file} is nested too deeply; write flat tables"
        raise ModelError(msg) from None
    except ValueError as error:  # of the parser, which says where
        if isinstance(error, ModelError):
            raise
        msg = f"model file {file} is no TOML ({' '.join(str(error).split())}); mend the file"
        raise ModelError(msg) from None


def _model(file: Path, data: dict[str, Any]) -> Model:
    for key in data:
        _known(key, _KEYS, "key")
    name = data.get("name", file.stem)
    if not isinstance(name, str) or not name.strip():
        msg = f"the name is {name!r}; give a word in quotes"
        raise ModelError(msg)
    if "equations" not in data:
        msg = 'there is no table [equations]; give one, for example x = "-k*x"'
        raise ModelError(msg)
    found = {key: _KEYS[key](name, key, value) for key, value in data.items()}
    return Model(**{"name": name, "title": name, **found})


def _known(key: str, known: Mapping[str, object] | tuple[str, ...], what: str) -> None:
    if key not in known:
        msg = f"unknown {what} '{key}'; {nearest(key, known)}"
        raise ModelError(msg)


def _table(key: str, value: object) -> dict[str, Any]:
    if not isinstance(value, dict):
        msg = f"'{key}' is {_kind(value)}; make it a table, [{key}]"
        raise ModelError(msg)
    return value


def _kind(value: object) -> str:
    kinds: dict[type, str] = {bool: "true or false", str: "a text", int: "a number"}
    kinds |= {float: "a number", list: "a list", dict: "a table"}
    return kinds.get(type(value), "a date")


def _text(key: str, value: object) -> str:
    if not isinstance(value, str):
        msg = f"'{key}' is {_kind(value)}; put it in quotes"
        raise ModelError(msg)
    return value


def _word(name: str, key: str, value: object) -> str:
    del name
    return _text(key, value)


def _words(name: str, key: str, value: object) -> tuple[str, ...]:
    del name
    if not isinstance(value, list):
        msg = f"'{key}' is {_kind(value)}; make it a list of texts"
        raise ModelError(msg)
    return tuple(_text(key, entry) for entry in value)


def _texts(name: str, key: str, value: object) -> dict[str, str]:
    del name
    return {plain(k): _text(f"{key}.{k}", v) for k, v in _table(key, value).items()}


def _formula(key: str, value: object) -> str:
    """Return an expression, which may be written as a number."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return repr(value)
    return _text(key, value)


def _formulas(name: str, key: str, value: object) -> dict[str, sp.Expr]:
    table = _table(key, value)
    for k in table:
        check_name(name, k)
    return read_table({k: _formula(f"{key}.{k}", v) for k, v in table.items()})


def _float(name: str, key: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        msg = f"'{key}' is {_kind(value)}; give a number"
        raise ModelError(msg)
    return number(name, key, value)


def _numbers(name: str, key: str, value: object) -> dict[str, float]:
    return {plain(k): _float(name, f"{key}.{k}", v) for k, v in _table(key, value).items()}


def _pair(name: str, key: str, value: object) -> tuple[float, float]:
    if not isinstance(value, list) or len(value) != 2:
        msg = f"'{key}' is {_kind(value)}; give two numbers, [LOW, HIGH]"
        raise ModelError(msg)
    low, high = (_float(name, key, bound) for bound in value)
    if not low < high or math.isnan(low + high):
        msg = f"'{key}' is {low:g} to {high:g}; give LOW below HIGH"
        raise ModelError(msg)
    return low, high


def _about(name: str, key: str, entry: Mapping[str, Any]) -> dict[str, Any]:
    """Return what is said of a parameter: unit, description, source, validity."""
    told: dict[str, Any] = {k: _text(f"{key}.{k}", entry[k]) for k in _FIELDS[:3] if k in entry}
    if "valid" in entry:
        told["valid"] = _pair(name, f"{key}.valid", entry["valid"])
    return told


def _parameters(name: str, key: str, value: object) -> tuple[Parameter, ...]:
    found = []
    for k, given in _table(key, value).items():
        check_name(name, k)
        place = f"{key}.{k}"
        entry = given if isinstance(given, dict) else {"default": given}
        for part in entry:
            _known(part, ("default", *_FIELDS), f"key in [{place}]:")
        if "default" not in entry:
            msg = f"'{place}' has no default; give one"
            raise ModelError(msg)
        default = _float(name, place, entry["default"])
        found.append(Parameter(plain(k), default, **_about(name, place, entry)))
    return tuple(found)


def _parts(place: str, given: object, needed: tuple[str, ...], more: tuple[str, ...]) -> Any:  # noqa: ANN401
    """Return a table that must have some keys and may have others."""
    entry = _table(place, given)
    for part in entry:
        _known(part, (*needed, *more), f"key in [{place}]:")
    for part in needed:
        if part not in entry:
            msg = f"[{place}] has no '{part}'; give one"
            raise ModelError(msg)
    return entry


def _elements(name: str, key: str, value: object) -> tuple[FractionalElement, ...]:
    if isinstance(value, list):  # [[elements]], each with its output
        entries = [_parts(key, entry, ("output", "input", "law"), ()) for entry in value]
        entries = [(_text(f"{key}.output", entry["output"]), entry) for entry in entries]
    else:
        table = _table(key, value)
        entries = [(k, _parts(f"{key}.{k}", v, ("input", "law"), ())) for k, v in table.items()]
    found = []
    for output, entry in entries:
        source, law = (_formula(f"{key}.{output}.{k}", entry[k]) for k in ("input", "law"))
        found.append(read_element(name, (output, source, law)))
    return tuple(found)


def _derived(name: str, key: str, value: object) -> tuple[DerivedParameter, ...]:
    found = []
    for k, given in _table(key, value).items():
        check_name(name, k)
        place = f"{key}.{k}"
        entry = _parts(place, given, ("expression", "sets"), _FIELDS)
        expression = parse(_formula(f"{place}.expression", entry["expression"]))
        sets = plain(_text(f"{place}.sets", entry["sets"]))
        found.append(DerivedParameter(plain(k), expression, sets, **_about(name, place, entry)))
    return tuple(found)


def _mass(name: str, key: str, value: object) -> sp.Matrix:
    import sympy as sp

    del name
    rows = value if isinstance(value, list) else []
    if not rows or not all(isinstance(row, list) and len(row) == len(rows) for row in rows):
        msg = "'mass' is no square matrix; write it as a list of rows, [[\"m\", 0], [0, 1]]"
        raise ModelError(msg)
    return sp.Matrix([[parse(_formula(key, entry)) for entry in row] for row in rows])


_KEYS: Final[dict[str, Callable[[str, str, object], Any]]] = {
    "name": _word,
    "title": _word,
    "source": _word,
    "notes": _words,
    "inputs": _words,
    "time_unit": _word,
    "band": _pair,
    "mass": _mass,
    "equations": _formulas,
    "parameters": _parameters,
    "guess": _numbers,
    "elements": _elements,
    "outputs": _formulas,
    "terms": _formulas,
    "derived": _derived,
    "units": _texts,
    "descriptions": _texts,
}
"""The keys of a file, and how each is read."""
