"""The program ``racs-bif``: finds the verb, and turns every outcome into an exit status.

Nothing slow is imported here or in a verb's file: ``--help`` answers at once.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import sys
from typing import TYPE_CHECKING, Final

from racs_bif.cli import (
    analyses,
    calibrate,
    certify,
    chart,
    continue_,
    curve,
    models,
    new,
    orbit,
    plot,
    realisations,
    report,
    simulate,
    spectrum,
)
from racs_bif.cli import run as run_
from racs_bif.cli.logs import log_shown
from racs_bif.cli.parser import Parser
from racs_bif.errors import ConvergenceError, RacsBifError, UsageError, nearest

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import ModuleType

DONE: Final = 0
EARLY: Final = 1
WRONG: Final = 2
VERBS: Final[dict[str, ModuleType]] = {
    "continue": continue_,
    "orbit": orbit,
    "simulate": simulate,
    "curve": curve,
    "chart": chart,
    "plot": plot,
    "report": report,
    "calibrate": calibrate,
    "models": models,
    "new": new,
    "analyses": analyses,
    "run": run_,
    "spectrum": spectrum,
    "certify": certify,
    "realisations": realisations,
}
"""Each verb's module has HELP, `configure(parser)` and `run(arguments) -> int`."""
_THREADS: Final = (
    "OPENBLAS_NUM_THREADS",
    "OMP_NUM_THREADS",
    "MKL_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)
_VERBOSE: Final = ("-v", "--verbose", "-vv")
_ISSUES: Final = "please report it with what -v prints"


class _Version(argparse.Action):
    """Print the version and stop; found out only when asked for."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        """Print the version and stop."""
        from racs_bif import __version__

        print(f"racs-bif {__version__}")
        parser.exit()


def build_parser() -> tuple[Parser, dict[str, Parser]]:
    """Return the parser and those of the verbs by name."""
    parser = Parser(
        prog="racs-bif",
        description="Continuation and stability analysis of dynamical systems with "
        "fractional-order elements.",
        epilog="'racs-bif VERB --help' explains a verb. Exit status: 0 done, 1 ended early but "
        "saved what there is, 2 wrong usage or input.",
    )
    parser.add_argument(
        "--version", action=_Version, nargs=0, help="print the version and stop", default=None
    )
    table = parser.add_subparsers(dest="verb", metavar="VERB", parser_class=Parser)
    verbs: dict[str, Parser] = {}
    for name, module in VERBS.items():
        verbs[name] = table.add_parser(name, help=module.HELP, description=module.DESCRIPTION)
        module.configure(verbs[name])
        _add_verbosity(verbs[name])
    return parser, verbs


def _add_verbosity(parser: Parser) -> None:
    parser.add_argument(
        *_VERBOSE[:2],
        action="store_const",
        const=1,
        default=0,
        help="show each continuation step, and a traceback if something goes wrong",
    )
    parser.add_argument(
        _VERBOSE[2],
        dest="verbose",
        action="store_const",
        const=2,
        default=0,
        help="show trial steps too, and why they are rejected",
    )


def main(argv: Sequence[str] | None = None) -> int:
    """Run the program.

    Parameters
    ----------
    argv : sequence of str, optional
        Arguments; the process's own by default.

    Returns
    -------
    int
        Exit status: 0 done, 1 ended early, 2 wrong usage or input.
    """
    # Read by BLAS when numpy is imported: threads make small matrices slower.
    for variable in _THREADS:
        os.environ.setdefault(variable, "1")
    arguments = list(sys.argv[1:] if argv is None else argv)
    verbose = not set(_VERBOSE).isdisjoint(arguments)
    try:
        return _run(arguments)
    except SystemExit as stop:  # --help and --version
        return stop.code if isinstance(stop.code, int) else DONE
    except RacsBifError as error:
        _complain(str(error))
        if verbose:
            _print_traceback()
        return EARLY if isinstance(error, ConvergenceError) else WRONG
    except KeyboardInterrupt:
        _complain("interrupted before there was anything to save")
        return EARLY
    except BrokenPipeError:
        # The reader of our output is gone; nothing more may be written to it.
        with contextlib.suppress(OSError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EARLY
    except Exception as error:  # noqa: BLE001  # a mistake of ours: a user is told so in one line
        _complain(f"internal error, {type(error).__name__}: {error}; {_ISSUES}")
        if verbose:
            _print_traceback()
        return EARLY


def _run(arguments: list[str]) -> int:
    parser, verbs = build_parser()
    verb = next((word for word in arguments if not word.startswith("-")), None)
    if verb is None:
        parser.check_options(arguments)
        parser.parse_args(arguments)
        msg = f"which verb? There are: {', '.join(VERBS)}; see racs-bif --help"
        raise UsageError(msg)
    if verb not in verbs:
        msg = f"unknown verb '{verb}'; {nearest(verb, VERBS)}"
        raise UsageError(msg)
    place = arguments.index(verb)
    parser.check_options(arguments[:place])
    verbs[verb].check_options(arguments[place + 1 :])
    parsed = parser.parse_args(arguments)
    parsed.command = arguments
    with log_shown(0 if getattr(parsed, "quiet", False) else parsed.verbose):
        return int(VERBS[verb].run(parsed))


def _complain(message: str) -> None:
    sys.stderr.write(f"racs-bif: {' '.join(message.split())}\n")


def _print_traceback() -> None:
    import traceback

    traceback.print_exc()


if __name__ == "__main__":
    sys.exit(main())
