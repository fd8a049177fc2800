"""``racs-bif calibrate``: choose a parameter that puts an exact Hopf point where it is wanted."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from racs_bif.cli.options import (
    add_model_options,
    add_output_options,
    check_span,
    open_system,
)
from racs_bif.cli.parser import Parser, assignment, number
from racs_bif.units import after, frequency_unit

if TYPE_CHECKING:
    from argparse import Namespace

HELP: Final = "choose a parameter so that an exact Hopf point lies where wanted"
DESCRIPTION: Final = (
    "Choose the value of a parameter with which the exact model, without any realisation of its "
    "fractional elements, has a Hopf point at the given value of another parameter."
)


def configure(parser: Parser) -> None:
    """Add the verb's arguments."""
    parser.add_argument("parameter", metavar="PARAM", help="the parameter to choose")
    parser.add_argument(
        "--hopf",
        action="append",
        required=True,
        type=assignment,
        metavar="NAME=VALUE",
        help="where the Hopf point is wanted, for example u=10.2",
    )
    parser.add_argument(
        "--span",
        nargs=2,
        type=number,
        metavar=("LOW", "HIGH"),
        help="where to search; by default what the model suggests, or around the present value",
    )
    add_model_options(parser)
    add_output_options(parser)


def run(arguments: Namespace) -> int:
    """Calibrate, and print the value."""
    from racs_bif.equilibria.calibrate import calibrate
    from racs_bif.verbs.equilibria import check_span as check_validity

    wanted = dict(arguments.hopf)
    span = None
    if arguments.span is not None:
        span = (arguments.span[0], arguments.span[1])
        check_span(*span)
    system = open_system(arguments)
    if span is not None:
        check_validity(system, arguments.parameter, span)

    from racs_bif import __version__
    from racs_bif.cli.terminal import console, working

    with working(arguments, f"calibrating {arguments.parameter}"):
        result = calibrate(system, arguments.parameter, wanted, span=span)
    from racs_bif.results.summary import to_json, to_text

    if arguments.json:
        found = {
            "schema": 1,
            "version": __version__,
            "command": arguments.command,
            "model": system.name,
            "variant": system.variant,
            "parameter": arguments.parameter,
            "value": result.value,
            "sets": dict(result.sets),
            "hopf": wanted,
            "omega": result.omega,
            "residual": result.residual,
            "parameters": dict(result.parameters),
        }
        print(to_text({key: to_json(value) for key, value in found.items()}), end="")
    units = {parameter.name: parameter.unit for parameter in system.parameter_table}
    say = console(arguments).print
    say(f"{arguments.parameter} = {result.value:.10g} {units[arguments.parameter]}".rstrip())
    for name, value in result.sets.items():
        if name != arguments.parameter:
            say(f"  which sets {name} = {value:.10g} {units.get(name, '')}".rstrip())
    place = ", ".join(
        f"{name} = {value:g} {units[name]}".rstrip() for name, value in wanted.items()
    )
    unit = after(frequency_unit(system.time_unit))
    say(f"  exact Hopf point at {place}, omega = {result.omega:.8g}{unit}")
    say(f"  last relative correction {result.residual:.1e}")
    return 0
