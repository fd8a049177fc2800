"""``racs-bif models``: what models there are, and what one of them is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from racs_bif.cli.options import (
    add_model_options,
    add_output_options,
    describe_range,
    open_system,
)

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from rich.console import Console

    from racs_bif.cli.parser import Parser
    from racs_bif.fractional.system import System

HELP: Final = "list the models, or show one: equations, parameters, units, sources"
DESCRIPTION: Final = (
    "List the models, or show one of them: its equations, parameters with their units and sources, "
    "variants, and which of its values are calibrated."
)
_SHOWN: Final = (
    *("title", "source", "variant", "variants", "notes", "states", "units", "descriptions"),
    *("equations", "mass", "elements", "outputs", "band", "guess"),
)
_INFINITE: Final = float("inf")


def configure(parser: Parser) -> None:
    """Add the verb's arguments."""
    add_model_options(parser, positional=True)
    add_output_options(parser)


def run(arguments: Namespace) -> int:
    """List the models or show one."""
    if arguments.model is None:
        return _list(arguments)
    return _show(arguments)


def _list(arguments: Namespace) -> int:
    from racs_bif.cli.terminal import console
    from racs_bif.shelf import names

    if arguments.variant is not None or arguments.values:
        from racs_bif.errors import UsageError

        msg = "--variant and --set need a model; write racs-bif models NAME"
        raise UsageError(msg)
    files = names("models")
    if arguments.json:
        _print_json(
            [{"name": n, "title": _title(path), "file": str(path)} for n, path in files.items()]
        )
    from rich.table import Table

    table = Table(box=None, pad_edge=False, show_header=False)
    table.add_column(no_wrap=True, style="bold")
    table.add_column()
    for name, path in files.items():
        table.add_row(name, _title(path))
    screen = console(arguments)
    screen.print(table)
    screen.print("\nracs-bif models NAME shows one of them.")
    return 0


def _title(path: Path) -> str:
    """Return the first line of a file's docstring; the file is not run."""
    import ast

    try:
        words = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8")))
    except (SyntaxError, UnicodeDecodeError):
        return "(cannot be read as Python)"
    return (words or "").partition("\n")[0]


def _show(arguments: Namespace) -> int:
    system = open_system(arguments)
    if arguments.json:
        _print_json(describe_model(system))
    from racs_bif.cli.terminal import console

    screen = console(arguments)
    meta = system.compiled.meta
    screen.print(f"{system.name}: {system.title}", style="bold")
    if meta["source"]:
        screen.print(f"Source: {meta['source']}")
    _print_equations(meta, screen.print)
    _print_parameters(system, screen)
    if meta["variants"]:
        screen.print("\nVariants (--variant NAME)", style="bold")
        for name, line in meta["variants"].items():
            mark = "*" if name == system.variant else " "
            screen.print(f" {mark} {name}: {line}")
    for note in system.notes:
        screen.print(f"\nNote: {note}")
    return 0


def describe_model(system: System) -> dict[str, Any]:
    """Return what ``--json`` prints of a model."""
    from racs_bif import __version__

    meta = system.compiled.meta
    shown = {key: meta[key] for key in _SHOWN}
    entries = [*meta["parameters"], *meta["derived"]]
    values = [entry | {"value": system.parameters[entry["name"]]} for entry in entries]
    return {
        "schema": 1,
        "version": __version__,
        "name": system.name,
        **shown,
        "parameters": values,
    }


def _print_equations(meta: Mapping[str, Any], say: Callable[..., None]) -> None:
    from racs_bif.cli.equations import named_equations

    equations, outputs = named_equations(meta)
    names = list(equations)
    say("\nStates", style="bold")
    for name in names:
        unit = f" [{meta['units'][name]}]" if meta["units"].get(name) else ""
        say(f"  {name}{unit}: {meta['descriptions'].get(name, '')}".rstrip(": "))
    say("\nEquations", style="bold")
    rates = [f"{name}'" for name in names]
    if meta["mass"] is None:
        for rate, right in zip(rates, equations.values(), strict=True):
            say(f"  {rate} = {right}")
    else:
        for row, right in zip(meta["mass"], equations.values(), strict=True):
            say(f"  {_left(row, rates)} = {right}")
    for element in meta["elements"]:
        say(f"  {element['output']} = Z(s) ({element['input']}),  Z(s) = {element['law']}")
    for name, expression in (meta["terms"] | outputs).items():
        say(f"  {name} = {expression}")


def _left(row: list[str], rates: list[str]) -> str:
    terms = []
    for factor, rate in zip(row, rates, strict=True):
        if factor == "1":
            terms.append(rate)
        elif factor != "0":
            terms.append(f"({factor}) {rate}")
    return " + ".join(terms) or "0"


def _print_parameters(system: System, screen: Console) -> None:
    from rich.table import Table

    meta = system.compiled.meta
    table = Table(box=None, pad_edge=False, title="\nParameters", title_justify="left")
    for title in ("name", "value", "unit", "meaning, source"):
        table.add_column(title, overflow="fold", no_wrap=title != "meaning, source")
    for entry in [*meta["parameters"], *meta["derived"]]:
        value = f"{system.parameters[entry['name']]:.8g}"
        table.add_row(entry["name"], value, entry["unit"], _meaning(entry))
    screen.print(table)


def _meaning(entry: Mapping[str, Any]) -> str:
    words = [entry["description"], entry["source"]]
    low, high = entry["valid"]
    if low is not None or high is not None:
        bounds = (-_INFINITE if low is None else low, _INFINITE if high is None else high)
        words.append(f"valid {describe_range(entry['name'], *bounds)}")
    default = entry.get("default")
    if isinstance(default, dict):
        hopf = ", ".join(f"{name} = {value:g}" for name, value in default["hopf"].items())
        words.append(f"calibrated: {default['parameter']} puts the exact Hopf point at {hopf}")
    if "expression" in entry:
        words.append(f"= {entry['expression']}, sets {entry['sets']}")
    return "; ".join(word for word in words if word)


def _print_json(value: object) -> None:
    import json

    print(json.dumps(value, indent=1, ensure_ascii=False, allow_nan=False))
