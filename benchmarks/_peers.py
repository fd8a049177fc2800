"""The Python peers: where each is, how it is installed, and how its driver is run.

Every peer has a virtual environment of its own in one folder, ``FOLDER/NAME``.
"""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Final

from benchmarks._spent import spent
from benchmarks._textbook import Found

if TYPE_CHECKING:
    from benchmarks._textbook import Problem

ROOT: Final = Path(__file__).parent.parent


@dataclass(frozen=True)
class Peer:
    """A package of the index, at the version that its driver is written for.

    Attributes
    ----------
    name, version : str
        What is installed.
    driver : str
        The module of this folder that runs it.
    """

    name: str
    version: str
    driver: str


PEERS: Final = (
    Peer("xpplab", "0.1.2", "benchmarks._by_xpplab"),
    Peer("bifpy", "0.3.0", "benchmarks._by_bifpy"),
)
NOT_DRIVEN: Final = {
    "pycobi 1.1.0": "it calls AUTO-07p's own Python front end, which as Debian packages it fails"
    " (ValueError in parseS.py) with numpy 2, which pycobi requires",
    "jaxcont 0.4.0": "it cannot start orbits at a Hopf point; its README leaves branch switching to"
    " the future",
    "PyDSTool 0.91.0": "it needs numpy 1 and imports the module 'parser', which Python has had no"
    " longer since 3.10",
}
"""Peers of which no figures are given, and why."""


@dataclass(frozen=True)
class Cost:
    """What a program took: CPU seconds, first with an empty cache or a compilation to do."""

    first: float | None
    cold: float
    warm: float
    found: Found


def install(folder: Path) -> dict[str, str]:
    """Install the peers, each in an environment of its own; return why some could not be."""
    failed = {}
    for peer in PEERS:
        home = folder / peer.name
        if not home.exists():
            subprocess.run([sys.executable, "-m", "venv", str(home)], check=True)
        command = [str(home / "bin" / "pip"), "install", "-q", f"{peer.name}=={peer.version}"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            failed[peer.name] = last_line(done.stderr) or f"pip ended with {done.returncode}"
    return failed


def last_line(text: str) -> str:
    """Return the last line of a text that says something."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return lines[-1] if lines else ""


def told(printed: str) -> Found:
    """Read what a driver printed: JSON on its last line, whatever its program said before."""
    found = json.loads(last_line(printed))
    special = [(label, value) for label, value in found.pop("special")]
    return Found(**found | {"special": special, "end": tuple(found["end"])})


def run(python: str, driver: str, problem: Problem, least: int, method: str = "") -> Cost:
    """Measure a driver: cold processes, then one whose runs after the first are the warm ones.

    Parameters
    ----------
    python : str
        The Python that has the program.
    driver : str
        The module.
    problem : Problem
        What to run.
    least : int
        How many cold processes and warm runs: the least of each counts.
    method : str
        For racs_bif: the method of the orbits; a process with an empty cache is measured too.

    Raises
    ------
    RuntimeError
        If the driver fails.
    """
    given = json.dumps(asdict(problem) | {"method": method})
    with TemporaryDirectory() as folder:
        note = Path(folder) / "told"
        command = [python, "-m", driver]
        first = None
        if method:
            fresh = ["env", f"RACS_BIF_CACHE={folder}/cache", *command, "1"]
            first = spent(fresh, note, given, ROOT).seconds
        colds = [spent([*command, "1"], note, given, ROOT).seconds for _ in range(least)]
        found = told(spent([*command, str(1 + least)], note, given, ROOT).printed)
    return Cost(first, min(colds), min(found.seconds[1:]), found)


def by_auto(problem: Problem, least: int) -> Cost:
    """Measure AUTO-07p: a cold process and a warm one are the same, its program run again."""
    from benchmarks._by_auto import Auto

    with TemporaryDirectory() as folder:
        auto = Auto(problem, Path(folder))
        runs = [auto.run() for _ in range(least)]
    seconds = min(run.seconds[0] for run in runs)
    found = replace(runs[0], seconds=[seconds])
    return Cost(auto.compilation + seconds, seconds, seconds, found)
