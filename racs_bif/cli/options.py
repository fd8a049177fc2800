"""Options that verbs share, and the system that they describe."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from racs_bif.cli.parser import Parser, assignment, count, number
from racs_bif.errors import UsageError, nearest

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Iterable

    from racs_bif.fractional.system import System

DEFAULT_MODEL: Final = "racs"
_REALISATIONS: Final = "diffusive (default), fitted, oustaloup, ...; see 'racs-bif realisations'"


def add_model_options(parser: Parser, *, positional: bool = False) -> None:
    """Add the options that choose a model, its variant and its parameters."""
    what = "a model's name, or a path that ends in .py or .toml"
    if positional:
        parser.add_argument("model", nargs="?", metavar="NAME|FILE.py", help=what)
    else:
        parser.add_argument(
            "--model",
            default=DEFAULT_MODEL,
            metavar="NAME|FILE.py",
            help=f"{what}; default {DEFAULT_MODEL}, see 'racs-bif models'",
        )
    parser.add_argument("--variant", help="a variant of the model, see 'racs-bif models NAME'")
    parser.add_argument(
        "--set",
        dest="values",
        action="append",
        default=[],
        type=assignment,
        metavar="NAME=VALUE",
        help="the value of a parameter, SI; may be given several times",
    )


def add_realisation_options(parser: Parser) -> None:
    """Add the options that say how fractional elements are realised."""
    parser.add_argument(
        "--realisation",
        metavar="NAME",
        help=f"how fractional elements are made integer-order: {_REALISATIONS}",
    )
    parser.add_argument(
        "--band",
        nargs=2,
        type=number,
        metavar=("LOW", "HIGH"),
        help="frequencies between which the realisation holds, rad/s; default the model's",
    )
    parser.add_argument(
        "--sections",
        type=count,
        metavar="N",
        help="sections of each realised power of s; default enough for the band",
    )


def add_output_options(parser: Parser) -> None:
    """Add the options that say how results are told."""
    parser.add_argument(
        "--json", action="store_true", help="print the result as JSON; the rest goes to stderr"
    )
    parser.add_argument(
        "--quiet", action="store_true", help="print nothing but errors (and what --json prints)"
    )


def open_system(arguments: Namespace) -> System:
    """Return the system that the options describe.

    Raises
    ------
    UsageError, ModelError, ParameterError
        If they cannot be used.
    """
    from racs_bif.cli.terminal import working
    from racs_bif.shelf.load import load_model

    band = getattr(arguments, "band", None)
    with working(arguments, f"loading {arguments.model}"):
        system = load_model(
            arguments.model,
            parameters=dict(arguments.values),
            variant=arguments.variant,
            realisation=getattr(arguments, "realisation", None),
            band=None if band is None else (band[0], band[1]),
            order=getattr(arguments, "sections", None) or 0,
        )
    # A model's file may take any word for a variant; only those that it lists are meant.
    variants = system.compiled.meta["variants"]
    if arguments.variant is not None and arguments.variant not in variants:
        hint = nearest(arguments.variant, variants)
        msg = f"unknown variant '{arguments.variant}' of model '{system.name}'; {hint}"
        raise UsageError(msg)
    return system


def check_span(low: float, high: float, values: Iterable[float] = ()) -> None:
    """Refuse an empty span, and values wanted outside it.

    Raises
    ------
    UsageError
        If LOW is not below HIGH, or a value is not between them.
    """
    if low >= high:
        msg = f"LOW must be below HIGH, here {low:g} and {high:g}; swap them or widen the span"
        raise UsageError(msg)
    for value in values:
        if not low <= value <= high:
            msg = f"--at {value:g} is outside the span {low:g} to {high:g}; widen the span"
            raise UsageError(msg)


def describe_range(name: str, low: float, high: float) -> str:
    """Return an open interval in words.

    Examples
    --------
    >>> describe_range("u", 0.0, float("inf")), describe_range("alpha", 0.0, 1.0)
    ('u > 0', '0 < alpha < 1')
    """
    above = "" if low == -float("inf") else f"{low:g} < "
    below = "" if high == float("inf") else f" < {high:g}"
    return f"{name} > {low:g}" if above and not below else f"{above}{name}{below}"
