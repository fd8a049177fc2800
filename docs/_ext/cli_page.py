"""The reference of the command line, from its parsers."""

from __future__ import annotations

import argparse
import os
import re
from typing import TYPE_CHECKING

from racs_bif.cli.main import build_parser

if TYPE_CHECKING:
    from racs_bif.cli.parser import Parser


def page() -> str:
    """Return every verb and every one of its arguments as Markdown."""
    os.environ["COLUMNS"] = "90"  # argparse wraps usage to it
    parser, verbs = build_parser()
    parts = [_escaped(parser.description or ""), _escaped(parser.epilog or ""), _table(parser)]
    for name, verb in verbs.items():
        parts += [f"## {name}", _escaped(verb.description or ""), _usage(verb), _table(verb)]
    return "\n\n".join(parts)


def _usage(parser: Parser) -> str:
    return f"```text\n{parser.format_usage().removeprefix('usage: ').rstrip()}\n```"


def _table(parser: Parser) -> str:
    rows = ["| argument | meaning |", "|---|---|"]
    formatter = argparse.HelpFormatter(parser.prog)
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            continue
        told = formatter._expand_help(action) if action.help else ""
        rows.append(f"| {_written(action)} | {_escaped(told)} |")
    return "\n".join(rows)


def _written(action: argparse.Action) -> str:
    """Return an argument as it is written, each of its spellings."""
    value = action.metavar or (action.dest.upper() if action.nargs != 0 else "")
    if isinstance(value, tuple):
        value = " ".join(value)
    value = value.replace("|", "\\|")  # otherwise the next cell of the table
    if not action.option_strings:
        return f"`{value}`"
    shown = "" if action.nargs == 0 else f" {value}"
    return ", ".join(f"`{option}{shown}`" for option in action.option_strings)


def _escaped(text: str) -> str:
    """Keep Markdown from reading marks of its own in plain text."""
    return re.sub(r"([*_|<`\[\]])", r"\\\1", " ".join(text.split()))
