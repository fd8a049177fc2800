"""``racs-bif continue``: the diagram in one parameter, from equilibria to the orbits they shed."""

from __future__ import annotations

import signal
import threading
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Final

from racs_bif.cli.following import (
    Run,
    follow_on,
    follow_orbits,
    more_branches,
    targets,
    tell_note,
    wanted,
)
from racs_bif.cli.journal import Journal
from racs_bif.cli.options import (
    add_model_options,
    add_output_options,
    add_realisation_options,
    check_span,
    open_system,
)
from racs_bif.cli.parser import Parser, choice, count_or_none, number
from racs_bif.errors import UsageError

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Iterator

    from racs_bif.fractional.system import System
    from racs_bif.results.diagram import Diagram

HELP: Final = "the diagram in one parameter: equilibria, special points, orbits"
DESCRIPTION: Final = (
    "Follow the equilibria of a model as one parameter goes from LOW to HIGH, locate their special "
    "points, check Hopf points on the exact fractional operator, and follow the periodic orbits "
    "born there. Writes branches.nc, diagram.png, diagram.svg and summary.json; while orbits are "
    "followed, what is done so far is in unfinished.nc, and --resume goes on with it."
)
FILES: Final = ("branches.nc", "diagram.png", "diagram.svg", "summary.json")
DEFAULT_OUT: Final = "racs_bif_out"
METHODS: Final = ("shooting", "collocation", "harmonic-balance", "none")


def configure(parser: Parser) -> None:
    """Add the verb's arguments."""
    parser.add_argument("parameter", metavar="PARAM", help="the parameter that is varied")
    parser.add_argument("low", metavar="LOW", type=number, help="where it begins, SI")
    parser.add_argument("high", metavar="HIGH", type=number, help="where it ends, SI")
    parser.add_argument(
        "--at",
        nargs="+",
        action="extend",
        default=[],
        type=wanted,
        metavar="VALUE",
        help="values of PARAM at which a point is wanted exactly, or of another quantity of the "
        "orbits: period=0.8",
    )
    parser.add_argument(
        "--orbits",
        type=choice(*METHODS),
        default=METHODS[0],
        metavar="METHOD",
        help="how periodic orbits are followed: shooting (default), collocation, "
        "harmonic-balance on the exact operator, or none to leave them out",
    )
    parser.add_argument(
        "--branches",
        type=count_or_none,
        default=0,
        metavar="N",
        help="how many times orbits are followed on from period doublings (PD) and branch points "
        "(BPC); default 0, the output says where there is more",
    )
    parser.add_argument(
        "--cascade",
        type=count_or_none,
        default=0,
        metavar="N",
        help="follow the period-doubling cascade from the first PD of every branch of orbits, N "
        "doublings deep",
    )
    parser.add_argument(
        "--probes",
        type=count_or_none,
        default=6,
        metavar="N",
        help="values of PARAM at which equilibria are looked for that nothing leads to; default 6, "
        "0 to follow only what is connected to the first",
    )
    add_model_options(parser)
    add_realisation_options(parser)
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(DEFAULT_OUT),
        metavar="DIR",
        help=f"where the files go; default ./{DEFAULT_OUT}",
    )
    parser.add_argument(
        "--state",
        metavar="NAME",
        help="what the picture shows on its vertical axis; default what the model suggests",
    )
    parser.add_argument(
        "--resume",
        action="store_true",
        help="go on with a run that was interrupted or killed: branches of orbits that it finished "
        "are taken from DIR",
    )
    add_output_options(parser)


def run(arguments: Namespace) -> int:
    """Compute the diagram, write its files and tell what was found."""
    from racs_bif.results.atomic import check_writable

    span = (arguments.low, arguments.high)
    check_span(*span, targets(arguments).get(arguments.parameter, ()))
    check_writable(arguments.out, FILES)
    system = open_system(arguments)
    _check_names(arguments, system)
    if arguments.realisation == "fitted":
        from racs_bif.verbs.realisations import fitted

        system = fitted(system, arguments.parameter, span)

    done = Run()
    if arguments.orbits != "none":
        done.journal = Journal(arguments.out, arguments)
        if arguments.resume:
            done.journal.take_up(system)
    try:
        _compute(arguments, system, done)
    except Exception as error:  # raised again when what is there has been saved
        if not done.branches:
            raise
        done.failure = error
    if not done.branches:
        raise KeyboardInterrupt

    from racs_bif.results.diagram import Diagram

    diagram = Diagram(*done.branches)
    done.troubles += [f"{b.name}: {b.stopped}" for b in diagram if b.early]
    with _uninterrupted():
        summary = _write(diagram, arguments)
        if done.journal is not None and not (done.interrupted or done.failure):
            done.journal.close()
    _tell(diagram, arguments, summary)
    for note in [*done.notes, *more_branches(diagram, arguments)]:
        tell_note(note, arguments)
    status = _close(done, arguments)
    if done.failure is not None:
        raise done.failure
    return status


def _check_names(arguments: Namespace, system: System) -> None:
    """Refuse what would be found out only after computing."""
    if arguments.resume and arguments.orbits == "none":
        msg = f"--orbits {arguments.orbits} leaves nothing to go on with; leave out --resume"
        raise UsageError(msg)
    if arguments.parameter in dict(arguments.values):
        name = arguments.parameter
        msg = f"--set {name} contradicts following {name} from LOW to HIGH; leave it out"
        raise UsageError(msg)
    known = (*system.own, *system.outputs)
    if arguments.state is not None and arguments.state not in known:
        from racs_bif.errors import nearest

        msg = f"unknown state '{arguments.state}'; {nearest(arguments.state, known)}"
        raise UsageError(msg)


def _compute(arguments: Namespace, system: System, done: Run) -> None:
    """Fill `done` with branches, until all are there or the user interrupts."""
    from racs_bif.cli.terminal import progress
    from racs_bif.verbs.all_equilibria import all_equilibria

    name, span = arguments.parameter, (arguments.low, arguments.high)
    at = tuple(targets(arguments).get(name, ()))
    with _interruptible(done), progress(arguments) as task:
        report = task("equilibria", span)
        found = all_equilibria(system, name, span, at=at, probes=arguments.probes, progress=report)
        with done.step("equilibria"):
            done.branches.extend(found)
        if arguments.orbits == "none":
            return
        leads_on = bool(arguments.branches or arguments.cascade)
        for branch in found:
            hopf = [point for point in branch.special if point.label == "H"]
            if branch.connected:
                for point in hopf:
                    if not done.interrupted:
                        follow_orbits(point, arguments, done, task, leads_on=leads_on)
            else:
                done.apart.extend(point.name for point in hopf)
        follow_on(arguments, done, task)


@contextmanager
def _interruptible(done: Run) -> Iterator[None]:
    """Note Ctrl-C, end the block at it, and keep what is there.

    A branch that is interrupted ends and keeps its points; the note says that no other is begun.
    """

    def note(_number: int, _frame: object) -> None:
        done.interrupted = True
        raise KeyboardInterrupt

    main = threading.current_thread() is threading.main_thread()
    before = signal.signal(signal.SIGINT, note) if main else None
    try:
        yield
    except KeyboardInterrupt:
        done.interrupted = True
    finally:
        if main:
            signal.signal(signal.SIGINT, before)


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Let nobody's Ctrl-C keep from disk what has been computed."""
    main = threading.current_thread() is threading.main_thread()
    before = signal.signal(signal.SIGINT, signal.SIG_IGN) if main else None
    try:
        yield
    finally:
        if main:
            signal.signal(signal.SIGINT, before)


def _write(diagram: Diagram, arguments: Namespace) -> str:
    """Write all files, whole or not at all, and return the summary's text."""
    from racs_bif import __version__
    from racs_bif.plots.diagram import picture
    from racs_bif.plots.style import save_picture
    from racs_bif.results.atomic import staged
    from racs_bif.results.files import save
    from racs_bif.results.summary import summarise, to_text, write_summary

    summary = summarise(diagram, arguments.command, __version__)
    figure = picture(diagram, arguments.state)
    with staged(arguments.out) as folder:
        save(diagram, folder / FILES[0])
        save_picture(figure, folder / FILES[1])
        save_picture(figure, folder / FILES[2])
        write_summary(summary, folder / FILES[3])
    return to_text(summary)


def _tell(diagram: Diagram, arguments: Namespace, summary: str) -> None:
    from racs_bif.cli.tables import branch_table, heading, operating_table, special_table
    from racs_bif.cli.terminal import console

    if arguments.json:
        print(summary, end="")
    screen = console(arguments)
    system = diagram.branches[0].system
    screen.print(heading(system))
    special = special_table(diagram)
    if not special.row_count:
        screen.print("\nNo special point in this span.")
    for table in (special, operating_table(diagram), branch_table(diagram)):
        if table.row_count:
            screen.print(table)
    for note in system.notes:
        screen.print(f"\nNote: {note}")
    screen.print(f"\nWrote {', '.join(FILES)} to {arguments.out.resolve()}", soft_wrap=True)


def _tell_apart(done: Run, arguments: Namespace) -> None:
    """Say which Hopf points no orbits were followed from."""
    if done.apart:
        from racs_bif.cli.terminal import console

        names = ", ".join(done.apart)
        console(arguments).print(
            f"\nOrbits were not followed from {names}: no branch leads there from the first "
            "equilibrium. In Python: continue_orbits(point)."
        )


def _close(done: Run, arguments: Namespace) -> int:
    """Say what went wrong and return the exit status."""
    from racs_bif.cli.terminal import warn

    if done.interrupted:
        kept = done.journal is not None and done.journal.steps
        goes_on = "; the same command with --resume goes on" if kept else ""
        done.troubles.insert(0, f"interrupted by the user{goes_on}")
    if not done.troubles:
        return 0
    warn(f"ended early, saved what there is in {arguments.out}: {' | '.join(done.troubles)}")
    return 1
