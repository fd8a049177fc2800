"""``racs-bif curve``: a curve of special points in two parameters."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from racs_bif.cli.options import (
    add_model_options,
    add_output_options,
    add_realisation_options,
    check_span,
    open_system,
)
from racs_bif.cli.parser import Parser, choice, count_or_none, number
from racs_bif.errors import UsageError
from racs_bif.markup import with_unit

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Sequence

    from rich.console import Console

    from racs_bif.fractional.system import System
    from racs_bif.results.branch import Branch
    from racs_bif.results.special import SpecialPoint

HELP: Final = "a curve of special equilibria or cycles in two parameters"
DESCRIPTION: Final = (
    "Find a special point as PARAM1 moves through its span, then follow it in the plane of PARAM1 "
    "and PARAM2, with its points of codimension two. hopf, fold and bp are equilibria (BT, GH, ZH, "
    "HH, CP); with fractional elements they are followed on the exact characteristic equation "
    "unless told otherwise. lpc, pd and ns are cycles, followed by collocation on the realisation "
    "(CPC, GPD, CH, R1 to R4, LPPD, LPNS, PDNS, NSNS); homoclinic is an orbit of one long period "
    "near a homoclinic one. Writes branches.nc, diagram.png, diagram.svg and summary.json."
)
FILES: Final = ("branches.nc", "diagram.png", "diagram.svg", "summary.json")
KINDS: Final = {
    "hopf": "H",
    "fold": "LP",
    "bp": "BP",
    "lpc": "LPC",
    "pd": "PD",
    "ns": "NS",
    "homoclinic": "EP",
}
CYCLES: Final = ("lpc", "pd", "ns", "homoclinic")


class Spans(argparse.Action):
    """Collect ``--span NAME LOW HIGH`` by name."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: Namespace,
        values: Any,  # noqa: ANN401 - as argparse has it
        *_: object,
    ) -> None:
        """Add a span."""
        try:
            span = number(values[1]), number(values[2])
        except argparse.ArgumentTypeError as error:
            parser.error(f"--span: {error}")
        setattr(namespace, self.dest, {**getattr(namespace, self.dest), values[0]: span})


def configure(parser: Parser) -> None:
    """Add the verb's arguments."""
    parser.add_argument(
        "kind", metavar="LABEL", type=choice(*KINDS), help=f"what is followed: {', '.join(KINDS)}"
    )
    parser.add_argument("first", metavar="PARAM1", help="the parameter in which the point is found")
    parser.add_argument("second", metavar="PARAM2", help="the other parameter of the plane")
    parser.add_argument(
        "--span",
        dest="spans",
        nargs=3,
        action=Spans,
        default={},
        metavar=("NAME", "LOW", "HIGH"),
        help="the interval of a parameter; default a tenth to ten times its value",
    )
    parser.add_argument(
        "--point", metavar="NAME", help="where to start if there are several, for example H2"
    )
    parser.add_argument(
        "--branches",
        type=count_or_none,
        default=0,
        metavar="N",
        help="how many times orbits are followed on from period doublings and branch points in the "
        "search for a cycle to start from; default 0",
    )
    parser.add_argument(
        "--through",
        action="append",
        default=[],
        metavar="POINT[:KIND]",
        help="follow another curve through a point of codimension two as well, for example "
        "BT1:fold, HH1:hopf2, GH1:lpc; by default the kind that the point was not found on",
    )
    parser.add_argument(
        "--operator",
        type=choice("exact", "realised"),
        help="exact equation (default with fractional elements) or realisation",
    )
    add_model_options(parser)
    add_realisation_options(parser)
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("racs_bif_out"),
        metavar="DIR",
        help="where the files go; default ./racs_bif_out",
    )
    add_output_options(parser)


def run(arguments: Namespace) -> int:
    """Find the point, follow its curve, write the files and tell what was found."""
    from racs_bif.cli.curve_start import starting_point
    from racs_bif.cli.terminal import progress
    from racs_bif.results.atomic import check_writable
    from racs_bif.verbs.curves import continue_curve

    check_writable(arguments.out, FILES)
    system = open_system(arguments)
    names = (arguments.first, arguments.second)
    for name in arguments.spans:
        if name not in names:
            msg = f"--span {name}: the plane is that of {names[0]} and {names[1]}; name one of them"
            raise UsageError(msg)
        check_span(*arguments.spans[name])
    with progress(arguments) as task:
        spans = {name: arguments.spans.get(name) or default_span(system, name) for name in names}
        start = starting_point(system, arguments, KINDS[arguments.kind], spans[names[0]], task)
        exact = system.fractional and arguments.kind not in CYCLES
        operator = arguments.operator or ("exact" if exact else "realised")
        report = task(f"{arguments.kind} curve from {start.name}", spans[names[1]])
        curve = continue_curve(
            start, names, spans, kind=arguments.kind, operator=operator, progress=report
        )
        curves = [curve]
        for wanted in arguments.through:
            name, _, kind = wanted.partition(":")
            point = _codimension_two(curves, name)
            report = task(f"{kind or 'other'} curve through {name}", spans[names[1]])
            curves.append(continue_curve(point, names, spans, kind=kind or None, progress=report))
    return _finish(curves, arguments)


def default_span(system: System, name: str) -> tuple[float, float]:
    """Return a tenth to ten times a parameter's value, within the model's validity.

    Raises
    ------
    UsageError
        If the parameter is zero.
    ParameterError
        If it is unknown.
    """
    from racs_bif.symbolic.model import find_parameter

    table = {p.name: p.valid for p in system.parameter_table}
    low, high = table[find_parameter(name, table)]
    value = system.parameters[name]
    if value == 0.0:
        msg = f"'{name}' is 0, which gives no interval; give --span {name} LOW HIGH"
        raise UsageError(msg)
    ends = sorted((0.1 * value, 10.0 * value))
    margin = 1e-3 * abs(value)
    return max(ends[0], low + margin), min(ends[1], high - margin)


def _codimension_two(curves: list[Branch], name: str) -> SpecialPoint:
    """Return a point of codimension two by name.

    Raises
    ------
    UsageError
        If no curve has it; the message says which there are and what they start.
    """
    points = [p for curve in curves for p in curve.special if p.label not in {"EP", "MX", "UZ"}]
    for point in points:
        if point.name == name:
            return point
    there = ", ".join(f"{p.name} ({p.data.get('starts', p.title)})" for p in points) or "none"
    msg = f"--through {name}: no such point on the curve; there are: {there}"
    raise UsageError(msg)


def _finish(curves: list[Branch], arguments: Namespace) -> int:
    from racs_bif import __version__
    from racs_bif.cli.terminal import warn
    from racs_bif.plots.curve import picture
    from racs_bif.plots.style import save_picture
    from racs_bif.results.atomic import staged
    from racs_bif.results.diagram import Diagram
    from racs_bif.results.files import save
    from racs_bif.results.summary import curve_points, summarise, to_text, write_summary

    diagram = Diagram(*curves)
    summary = summarise(diagram, arguments.command, __version__)
    summary |= {"points": [point for curve in diagram for point in curve_points(curve)]}
    figure = picture(diagram.branches)
    with staged(arguments.out) as folder:
        save(diagram, folder / FILES[0])
        save_picture(figure, folder / FILES[1])
        save_picture(figure, folder / FILES[2])
        write_summary(summary, folder / FILES[3])
    if arguments.json:
        print(to_text(summary), end="")
    _tell(diagram.branches, arguments)
    early = " | ".join(f"{curve.name}: {curve.stopped}" for curve in diagram if curve.early)
    if early:
        warn(f"ended early, saved what there is in {arguments.out}: {early}")
    return int(bool(early))


def _tell(curves: Sequence[Branch], arguments: Namespace) -> None:
    from racs_bif.cli.tables import heading
    from racs_bif.cli.terminal import console

    screen = console(arguments)
    screen.print(heading(curves[0].system))
    for curve in curves:
        _tell_curve(curve, screen)
    for note in curves[0].system.notes:
        screen.print(f"\nNote: {note}")
    screen.print(f"\nWrote {', '.join(FILES)} to {arguments.out.resolve()}", soft_wrap=True)


def _tell_curve(curve: Branch, screen: Console) -> None:
    from rich.table import Table

    a, b = curve.parameters
    screen.print(f"\n{curve.name}: {curve.method}, {len(curve)} points. {curve.stopped}")
    table = Table(box=None, pad_edge=False, collapse_padding=True)
    table.add_column("", no_wrap=True)
    shown = _shown(curve)
    for title in (a, b, *shown.values()):
        table.add_column(title, justify="right", no_wrap=True)
    table.add_column("")
    rows = [("first", 0, ""), ("last", len(curve) - 1, "")]
    for axis, name in enumerate((a, b)):
        column = curve.values[:, axis]
        inner = column[1:-1]
        extremes = {"least": int(inner.argmin()) + 1, "largest": int(inner.argmax()) + 1}
        for extreme, k in extremes.items():
            if min(column[0], column[-1]) <= column[k] <= max(column[0], column[-1]):
                continue
            rows.append((f"{extreme} {name}", k, "among the points"))
    for p in curve.special:
        if p.label not in {"EP", "MX"}:
            starts = p.data.get("starts")
            rows.append((p.name, p.index, f"{p.title}; starts {starts}" if starts else p.title))
    for name, k, told in rows:
        numbers = [*curve.values[k], *(_at(curve, measure, k) for measure in shown)]
        table.add_row(name, *("-" if math.isnan(n) else f"{n:.7g}" for n in numbers), told)
    screen.print(table)


def _shown(curve: Branch) -> dict[str, str]:
    """Return the measures of a curve that its table shows, and their headings."""
    if "period" not in curve.measures:
        return {"omega": curve.system.frequency_unit or "omega", "l1": "l1"}
    others = {"angle": "angle, rad", "c": "c", "Re d": "Re d", "shift": "shift"}
    return {"period": with_unit("period", curve.system.time_unit)} | {
        k: v for k, v in others.items() if k in curve.measures
    }


def _at(curve: Branch, measure: str, k: int) -> float:
    column = curve.measures.get(measure)
    return float("nan") if column is None else float(column[k])
