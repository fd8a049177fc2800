"""CPU time and peak memory of a program.

The kernel counts to a process's peak what its parent held when it was started, so the program is
started by a small Python that has imported next to nothing.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Mapping

_STARTER: Final = """
import json, resource, subprocess, sys
run = subprocess.run(sys.argv[2:])
used = resource.getrusage(resource.RUSAGE_CHILDREN)
with open(sys.argv[1], "w") as told:
    json.dump([run.returncode, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024], told)
"""


@dataclass(frozen=True)
class Spent:
    """What a program printed and took: CPU seconds, and megabytes at its peak."""

    printed: str
    seconds: float
    megabytes: float


def spent(
    command: list[str],
    told: Path,
    given: str = "",
    folder: Path | None = None,
    variables: Mapping[str, str] | None = None,
) -> Spent:
    """Run a program on one thread.

    Parameters
    ----------
    command : list of str
        The program and its arguments.
    told : Path
        A file to write to.
    given : str
        Its standard input.
    folder : Path, optional
        Where it runs.
    variables : mapping of str to str, optional
        Of its environment, besides this process's.

    Raises
    ------
    RuntimeError
        If it fails; the message has the end of what it printed.
    """
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    environment |= variables or {}
    run = subprocess.run(
        [sys.executable, "-E", "-S", "-c", _STARTER, str(told), *command],
        input=given,
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    code, seconds, megabytes = json.loads(told.read_text())
    if code:
        msg = f"{command[0]} ended with {code}: {(run.stdout + run.stderr)[-500:]}"
        raise RuntimeError(msg)
    return Spent(run.stdout, seconds, megabytes)
