"""``racs-bif new``: begin a model of one's own."""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Final

from racs_bif.cli.options import add_output_options
from racs_bif.errors import FileError, UsageError

if TYPE_CHECKING:
    from argparse import Namespace

    from racs_bif.cli.parser import Parser

HELP: Final = "write the file of a model of your own, ready to run and to change"
DESCRIPTION: Final = (
    "Write a commented file with a small model that runs at once, and say how to run it. What is "
    "there already is never overwritten."
)
_NAME: Final = re.compile(r"[^\W\d]\w*")
_PARAMETER, _LOW, _HIGH = "mu", "-1", "1"
_PYTHON: Final = '''\
"""{title}.

Say here what the model is and where its equations are from. This one is an oscillator with negative
damping, a variant of Van der Pol's:

    x' = v
    v' = (mu - x**2) v - x{force}

{result}

    {command}
"""

import numpy as np

import racs_bif as rb


def rates(state, p{argument}):
    """Return the rates of the states: plain Python, `math` and numpy.

    `state` holds the states in the order of `states` below; p.mu and its like are the parameters.
    """
    x, v = state
    friction = p.mu - x**2
    return np.array([v, friction * v - x{term}])


def model():
    """Return the model; racs-bif looks for this function."""
    return rb.model_from_function(
        "{name}",
        rates,
        states=["x", "v"],
        parameters=[
            rb.Parameter("mu", -0.5, unit="1/s", description="growth rate of small oscillations"),
{parameters}        ],
        guess={{"x": 0.0, "v": 0.0}},  # where to look for an equilibrium
        outputs={{"energy": "(x**2 + v**2)/2"}},  # further quantities, as expressions
{elements}    )
'''
_TOML: Final = """\
# {title}.
#
# Say here what the model is and where its equations are from. This one is an oscillator with
# negative damping, a variant of Van der Pol's.
#
# {result}
#
#     {command}
#
# Expressions hold numbers, names, + - * / ^, "a if x > 0 else b", and functions such as sin, exp,
# sqrt, abs, max. They are read, never run as a program.

name = "{name}"
title = "{title}"
source = ""

[equations] # of each state its rate
x = "v"
v = "(mu - x^2)*v - x{term}"

[parameters]
mu = {{ default = -0.5, unit = "1/s", description = "growth rate of small oscillations" }}
{parameters}
[guess] # where to look for an equilibrium
x = 0.0
v = 0.0

[outputs] # further quantities
energy = "(x^2 + v^2)/2"
{elements}"""
_PLAIN_RESULT: Final = "It starts to oscillate at mu = 0, a supercritical Hopf point. Run it:"
_FRACTIONAL_RESULT: Final = "It starts to oscillate at mu = 0.3259981216, a Hopf point. Run it:"
_PYTHON_ELEMENT: Final = (
    'elements=[("w", "x", "s**a")],  # a fractional element: w is the derivative of x of order a'
)
_TOML_ELEMENT: Final = (
    "[elements] # fractional elements: w is the derivative of x of order a\n"
    'w = { input = "x", law = "s^a" }\n'
)


def configure(parser: Parser) -> None:
    """Add the verb's arguments."""
    parser.add_argument(
        "name", metavar="NAME", help="the model's name; its file is NAME.py or NAME.toml"
    )
    parser.add_argument(
        "--toml", action="store_true", help="write a TOML file, a model without any Python"
    )
    parser.add_argument(
        "--fractional", action="store_true", help="give the model a fractional element"
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        metavar="DIR",
        help="where the file goes; default here",
    )
    add_output_options(parser)


def run(arguments: Namespace) -> int:
    """Write the file and say how to run it."""
    from racs_bif.cli.terminal import console

    path = _path(arguments)
    words = ["continue", _PARAMETER, _LOW, _HIGH, "--model", str(path)]
    command = shlex.join(["racs-bif", *words])
    text = _text(path, command, fractional=arguments.fractional)
    _write(path, text)
    if arguments.json:
        import json

        print(json.dumps({"schema": 1, "file": str(path), "command": words}, indent=1))
    screen = console(arguments)
    screen.print(f"Wrote {path}", soft_wrap=True, highlight=False, markup=False)
    screen.print(f"Run it: {command}", soft_wrap=True, highlight=False, markup=False)
    return 0


def _path(arguments: Namespace) -> Path:
    """Return the file that is meant; the name may have its ending already."""
    name = Path(arguments.name)
    wanted = ".toml" if arguments.toml or name.suffix == ".toml" else ".py"
    stem = name.name.removesuffix(wanted)
    if not _NAME.fullmatch(stem):
        msg = f"'{arguments.name}' cannot be a model's name; use letters, digits and _"
        raise UsageError(msg)
    folder: Path = arguments.out
    return folder / name.parent / f"{stem}{wanted}"


def _text(path: Path, command: str, *, fractional: bool) -> str:
    python = path.suffix == ".py"
    element = _PYTHON_ELEMENT if python else _TOML_ELEMENT
    if python:
        margin = " " * 8
        parameters = (
            f'    {margin}rb.Parameter("c", 0.5, description="stiffness of the element"),\n'
            f'    {margin}rb.Parameter("a", 0.5, description="order of the element",'
            " valid=(0, 1)),\n"
        )
        shown = f"{margin}{element}\n"
        hint = (
            f"{margin}# A fractional element takes one line more, and w in the equations, as in\n"
            f"{margin}# 'def rates(state, p, w)' and '- p.c * w':\n"
            f"{margin}# {_PYTHON_ELEMENT.partition('  #')[0]}\n"
        )
    else:
        parameters = (
            'c = { default = 0.5, description = "stiffness of the element" }\n'
            'a = { default = 0.5, description = "order of the element", valid = [0, 1] }\n'
        )
        shown = f"\n{element}"
        hint = (
            "\n# A fractional element takes a line more, and w in the equations, as in '- c*w':\n"
            + "".join(f"# {line}\n" for line in element.splitlines())
        )
    return (_PYTHON if python else _TOML).format(
        title=f"{path.stem}: an oscillator",
        name=path.stem,
        command=command,
        result=_FRACTIONAL_RESULT if fractional else _PLAIN_RESULT,
        force=" - c D^a x" if fractional else "",
        argument=", w" if fractional and python else "",
        term=(" - p.c * w" if python else " - c*w") if fractional else "",
        parameters=parameters if fractional else "",
        elements=shown if fractional else hint,
    )


def _write(path: Path, text: str) -> None:
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        msg = f"{path} is there already and is not overwritten; choose another name"
        raise UsageError(msg) from None
    except OSError as error:
        msg = f"{path} cannot be written: {error.strerror or error}; choose another folder"
        raise FileError(msg) from None
