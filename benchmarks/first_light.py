"""User CPU time of the main job, cold and warm.

Run ``python benchmarks/first_light.py``. Every row is a fresh process on one BLAS thread; the
numbers are user CPU seconds as the operating system counts them, so that a busy machine disturbs
them less than a clock would be.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

_EQUILIBRIA = ["continue", "u", "5", "30", "--orbits", "none", "--quiet"]
_TO_20 = ["continue", "u", "5", "20", "--quiet"]
_WHOLE = ["continue", "u", "5", "30", "--quiet"]
ROWS = (
    ("--help", ["--help"], False),
    ("equilibria and Hopf point, cold cache", _EQUILIBRIA, True),
    ("equilibria and Hopf point, warm cache", _EQUILIBRIA, False),
    ("with orbits to u = 20, cold cache", _TO_20, True),
    ("with orbits to u = 20, warm cache", _TO_20, False),
    ("the whole default run, warm cache", _WHOLE, False),
)


def measure(arguments: list[str], cache: Path, out: Path) -> float:
    """Return the user CPU seconds of one command line."""
    environment = os.environ | {"RACS_BIF_CACHE": str(cache), "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, "-m", "racs_bif", *arguments]
    if "continue" in arguments:
        command += ["--out", str(out)]
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run(command, env=environment, stdout=subprocess.DEVNULL, check=False)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def main() -> None:
    """Print the table; of three runs the fastest counts, a cold one is made once."""
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        reference = min(measure(["--version"], root / "warm", root) for _ in range(3))
        print(f"{'':42s} {'user CPU [s]':>12s} {'over --version':>15s}")
        for k, (title, arguments, cold) in enumerate(ROWS):
            if cold:
                seconds = measure(arguments, root / f"cold{k}", root / "out")
            else:
                measure(arguments, root / "warm", root / "out")
                runs = [measure(arguments, root / "warm", root / "out") for _ in range(3)]
                seconds = min(runs)
            print(f"{title:42s} {seconds:12.2f} {seconds / reference:15.1f}")


if __name__ == "__main__":
    main()
