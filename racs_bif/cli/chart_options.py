"""The arguments of ``racs-bif chart``."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Final

from racs_bif.cli.curve import Spans
from racs_bif.cli.options import add_model_options, add_output_options
from racs_bif.cli.parser import Parser, assignment, choice, count, count_or_none, number

SIMULATED: Final = ("amplitude", "lyapunov", "periods")
"""Maps that need a simulation in every cell."""
MAPS: Final = ("count", "damping", *SIMULATED)


def configure(parser: Parser) -> None:
    """Add the verb's arguments."""
    parser.add_argument("first", metavar="PARAM1", help="the parameter along the axis")
    parser.add_argument("second", metavar="PARAM2", help="the parameter up the axis")
    parser.add_argument(
        "--span",
        dest="spans",
        nargs=3,
        action=Spans,
        default={},
        metavar=("NAME", "LOW", "HIGH"),
        help="the interval of a parameter, SI; default a tenth to ten times its value",
    )
    parser.add_argument(
        "--mark",
        dest="marks",
        action="append",
        default=[],
        type=assignment,
        metavar="NAME=VALUE",
        help="a value of PARAM1 or PARAM2 at which boundary points are wanted exactly; may be "
        "given several times",
    )
    parser.add_argument(
        "--slices",
        type=slices,
        metavar="NAME=V1,V2,...",
        help="a chart for each of these values of a third parameter, on one figure",
    )
    parser.add_argument(
        "--l1",
        dest="lyapunov",
        action="store_true",
        help="the first Lyapunov coefficient along Hopf boundaries, and where it changes sign (GH)",
    )
    parser.add_argument(
        "--operator",
        type=choice("exact", "realised"),
        default="exact",
        help="whose characteristic equation: the 'exact' fractional one, the default, or that of "
        "its realisation",
    )
    parser.add_argument(
        "--curve",
        dest="curves",
        action="append",
        default=[],
        type=Path,
        metavar="FILE.nc",
        help="a curve in this plane to draw over it, as 'racs-bif curve' saved it, such as the "
        "folds of cycles within which orbits exist; may be given several times",
    )
    parser.add_argument(
        "--map",
        dest="quantity",
        type=choice(*MAPS),
        help="a map besides: 'count' of unstable roots, 'damping' of the rightmost root; or, by "
        "simulating every cell, 'amplitude' of what it settles on, largest 'lyapunov' exponent, "
        "or 'periods' after which it repeats on a Poincare section",
    )
    parser.add_argument(
        "--cells",
        nargs=2,
        type=count,
        metavar=("N1", "N2"),
        help="cells of the map; default 200 200, or 40 40 where each is simulated",
    )
    parser.add_argument(
        "--duration",
        type=number,
        metavar="SECONDS",
        help="of the simulation in every cell; default 60 periods of the slowest oscillation on a "
        "boundary",
    )
    parser.add_argument(
        "--watch",
        metavar="STATE",
        help="the state whose amplitude, or crossings, are meant; default what the model suggests",
    )
    parser.add_argument(
        "--start",
        action="append",
        default=[],
        type=assignment,
        metavar="STATE=VALUE",
        help="where simulations begin; states that are not given begin at the cell's equilibrium. "
        "Default a small displacement of all; may be given several times",
    )
    parser.add_argument(
        "--depth",
        type=count,
        default=7,
        metavar="N",
        help="cells that may hide an island are searched down to 1/2**N of a span; default 7",
    )
    parser.add_argument(
        "--workers",
        type=count_or_none,
        default=0,
        metavar="N",
        help="processes that compute the map, or the slices; default 0, this one",
    )
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="a Dask scheduler that computes them, tcp://host:port (pip install "
        "'racs-bif[cluster]')",
    )
    parser.add_argument(
        "--resume", action="store_true", help="go on with the map of a run that was ended early"
    )
    add_model_options(parser)
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("racs_bif_out"),
        metavar="DIR",
        help="where the files go; default ./racs_bif_out",
    )
    add_output_options(parser)


def slices(text: str) -> tuple[str, tuple[float, ...]]:
    """Return the name and the values of ``NAME=V1,V2,...``.

    Raises
    ------
    argparse.ArgumentTypeError
        If the text is not of this form.
    """
    name, equals, values = text.partition("=")
    if not equals or not name.strip() or not values.strip():
        msg = f"'{text}' is not NAME=V1,V2,...; write for example u=10,15,20"
        raise argparse.ArgumentTypeError(msg)
    return name.strip(), tuple(number(value.strip()) for value in values.split(","))
