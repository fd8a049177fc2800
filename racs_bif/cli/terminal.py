"""Where a verb prints: people's text, a program's JSON, a progress bar."""

from __future__ import annotations

import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Callable, Iterator

    from rich.console import Console


class _Point(Protocol):
    """What a progress bar wants to know of a point."""

    @property
    def parameter(self) -> float:
        """The continuation parameter."""


if TYPE_CHECKING:
    Report = Callable[[_Point], None]
    Task = Callable[[str, tuple[float, float]], Report | None]


def console(arguments: Namespace) -> Console:
    """Return the console for text that people read; with ``--json`` that is stderr."""
    from rich.console import Console

    return Console(
        file=sys.stderr if arguments.json else sys.stdout,
        quiet=arguments.quiet,
        markup=False,
        highlight=False,
        emoji=False,
        soft_wrap=False,
    )


def warn(message: str) -> None:
    """Print a line to stderr, also with ``--quiet``."""
    sys.stderr.write(f"racs-bif: {' '.join(message.split())}\n")


def interactive(arguments: Namespace) -> bool:
    """Tell whether progress bars are wanted: on a terminal, where no steps are printed."""
    silent = getattr(arguments, "quiet", False) or getattr(arguments, "verbose", 0)
    return not silent and sys.stderr.isatty()


@contextmanager
def working(arguments: Namespace, title: str) -> Iterator[None]:
    """Show, on an interactive stderr, that something goes on whose end is not known."""
    if not interactive(arguments):
        yield
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}", markup=False), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(file=sys.stderr), transient=True) as bars:
        bars.add_task(title, total=None)
        yield


@contextmanager
def progress(arguments: Namespace) -> Iterator[Task]:
    """Show progress bars on an interactive stderr.

    Yields
    ------
    callable(title, span)
        Starts a bar and returns what has to be called with every new point; None where nothing is
        to be shown.
    """
    if not interactive(arguments):
        yield lambda _title, _span: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}", markup=False), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(file=sys.stderr), transient=True) as bars:

        def start(title: str, span: tuple[float, float]) -> Report:
            low, high = span
            task = bars.add_task(title, total=1.0)
            points, furthest = 0, 0.0

            def report(point: _Point) -> None:
                nonlocal points, furthest
                points += 1
                furthest = max(furthest, (point.parameter - low) / (high - low))
                text = f"{title}: {points} points, at {point.parameter:.5g}"
                bars.update(task, completed=furthest, description=text)

            return report

        yield start
