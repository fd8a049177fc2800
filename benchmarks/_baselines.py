"""What the hot paths cost when their baselines were stored, and what has become worse since."""

from __future__ import annotations

import json
import platform
import subprocess
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Mapping

FILE: Final = Path(__file__).with_name("baselines.json")
SLOWER: Final = 1.5
"""A path whose ratio to the reference kernel is more than this many times its baseline's."""
LARGER: Final = 1.25
"""The same of the peak memory."""


@dataclass(frozen=True)
class Cost:
    """What a path takes.

    Attributes
    ----------
    ratio : float
        CPU time of a run over that of the reference kernel.
    milliseconds : float
        That time itself, which tells something about the machine too.
    megabytes : float
        Peak memory of a process that does nothing else, Python and packages included.
    """

    ratio: float
    milliseconds: float
    megabytes: float


@dataclass(frozen=True)
class Stored:
    """A baseline and where it comes from.

    Attributes
    ----------
    cost : Cost
        What the path took.
    commit, date : str
        At which commit, a trailing "+" where files were changed since, and when.
    on : str
        The machine and the versions of what is most of the cost.
    """

    cost: Cost
    commit: str
    date: str
    on: str


def stored(cost: Cost) -> Stored:
    """Return what was just measured as a baseline."""
    rounded = Cost(*(float(f"{value:.4g}") for value in asdict(cost).values()))
    return Stored(rounded, commit(), f"{datetime.now(UTC):%Y-%m-%d}", machine())


def read(file: Path = FILE) -> dict[str, Stored]:
    """Return the baselines by the name of the path; none where there is no file."""
    if not file.exists():
        return {}
    found = json.loads(file.read_text(encoding="utf-8"))
    return {name: Stored(Cost(**entry.pop("cost")), **entry) for name, entry in found.items()}


def write(baselines: Mapping[str, Stored], file: Path = FILE) -> None:
    """Write the baselines."""
    entries = {name: asdict(entry) for name, entry in baselines.items()}
    file.write_text(json.dumps(entries, indent=1) + "\n", encoding="utf-8")


def worse(cost: Cost, before: Cost) -> tuple[str, ...]:
    """Return in what a cost is worse than its baseline, in a word each."""
    words = []
    if cost.ratio > SLOWER * before.ratio:
        words.append("SLOWER")
    if cost.megabytes > LARGER * before.megabytes:
        words.append("LARGER")
    return tuple(words)


def better(cost: Cost, before: Cost) -> bool:
    """Return whether a cost is so much less that a baseline should be stored again."""
    return before.ratio > SLOWER * cost.ratio or before.megabytes > LARGER * cost.megabytes


def commit() -> str:
    """Return the commit that is checked out."""
    asked = ["git", "describe", "--always", "--abbrev=7", "--dirty=+", "--exclude=*"]
    try:
        run = subprocess.run(
            asked, cwd=Path(__file__).parent, capture_output=True, text=True, check=True
        )
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return run.stdout.strip()


def machine() -> str:
    """Return what is measured on and with."""
    told = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
    names = [line.split(":", 1)[1].strip() for line in told.splitlines() if "model name" in line]
    versions = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy"))
    processor = names[0] if names else platform.processor()
    return f"{processor}; Python {platform.python_version()}, {versions}"
