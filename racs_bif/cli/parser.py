"""An argument parser whose complaints are one line, with the nearest name."""

from __future__ import annotations

import argparse
import math
import re
from typing import TYPE_CHECKING, Any, NoReturn

from racs_bif.errors import UsageError, nearest

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

_NEGATIVE = re.compile(
    r"^-(?:(?:\d[\d_]*\.?[\d_]*|\.\d[\d_]*)(?:e[-+]?\d+)?|inf|infinity|nan)$", re.IGNORECASE
)
"""What is a negative number and not an option; infinite ones too, to be refused as such."""


class Parser(argparse.ArgumentParser):
    """A parser that raises `UsageError` and takes every way of writing a negative number.

    Attributes
    ----------
    options : list of str
        Every option it knows, as written: ``--help``, ``-h``.
    """

    def __init__(self, **settings: Any) -> None:  # noqa: ANN401  # argparse's own, passed on
        self.options: list[str] = []
        super().__init__(allow_abbrev=False, **settings)
        # argparse knows only "-1.5"; "-1e-3" would be an unknown option.
        self._negative_number_matcher = _NEGATIVE

    def add_argument(self, *names: str, **settings: Any) -> argparse.Action:  # noqa: ANN401
        """Add an argument and remember its options."""
        self.options += [name for name in names if name.startswith("-")]
        return super().add_argument(*names, **settings)

    def error(self, message: str) -> NoReturn:
        """Raise what argparse found wrong.

        Raises
        ------
        UsageError
            Always.
        """
        msg = f"{message.removeprefix('argument ')}; see {self.prog} --help"
        raise UsageError(msg)

    def check_options(self, arguments: Sequence[str]) -> None:
        """Refuse options that the parser does not know, before they confuse the rest.

        Raises
        ------
        UsageError
            With the nearest option.
        """
        for argument in arguments:
            if argument == "--":
                return
            name = argument.partition("=")[0]
            if len(name) < 2 or name[0] != "-" or _NEGATIVE.match(argument):
                continue
            if name not in self.options:
                msg = f"unknown option '{name}'; {nearest(name, self.options)}"
                raise UsageError(msg)


def number(text: str) -> float:
    """Return a finite number.

    Raises
    ------
    argparse.ArgumentTypeError
        If the text is none.
    """
    try:
        value = float(text)
    except ValueError:
        msg = f"'{text}' is not a number; write for example 12.5 or -1e-3"
        raise argparse.ArgumentTypeError(msg) from None
    if not math.isfinite(value):
        msg = f"'{text}' is not finite; give a finite number"
        raise argparse.ArgumentTypeError(msg)
    return value


def count(text: str) -> int:
    """Return a whole number that is at least 1.

    Raises
    ------
    argparse.ArgumentTypeError
        If the text is none.
    """
    if not text.isdecimal() or int(text) < 1:
        msg = f"'{text}' is not a whole number of at least 1"
        raise argparse.ArgumentTypeError(msg)
    return int(text)


def count_or_none(text: str) -> int:
    """Return a whole number that is at least 0.

    Raises
    ------
    argparse.ArgumentTypeError
        If the text is none.
    """
    return 0 if text == "0" else count(text)


def choice(*known: str) -> Callable[[str], str]:
    """Return a function that takes one of some words, and names the nearest for any other."""

    def chosen(text: str) -> str:
        if text not in known:
            msg = f"unknown '{text}'; {nearest(text, known)}"
            raise argparse.ArgumentTypeError(msg)
        return text

    return chosen


def assignment(text: str) -> tuple[str, float]:
    """Return the name and the number of ``NAME=VALUE``.

    Raises
    ------
    argparse.ArgumentTypeError
        If the text is not of this form.
    """
    name, equals, value = text.partition("=")
    if not equals or not name.strip():
        msg = f"'{text}' is not NAME=VALUE; write for example c=0.3"
        raise argparse.ArgumentTypeError(msg)
    try:
        return name.strip(), number(value.strip())
    except argparse.ArgumentTypeError as error:
        msg = f"{name.strip()}: {error}"
        raise argparse.ArgumentTypeError(msg) from None
