"""What a run of ``racs-bif continue`` has finished, on disk for one that goes on with it."""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from racs_bif.errors import FileError, UsageError

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Sequence

    from racs_bif.fractional.system import System
    from racs_bif.results.branch import Branch
    from racs_bif.results.provenance import SystemInfo

UNFINISHED: Final = ("unfinished.nc", "unfinished.json")
"""The branches that are done, and the steps that they came from. The latter is written last."""
_FORMAT: Final = 1
_OF_NO_MATTER: Final = frozenset(
    {"command", "json", "out", "quiet", "resume", "state", "verb", "verbose"}
)
"""Arguments that a run may go on without."""


@dataclass(frozen=True)
class Step:
    """A step that was finished.

    Parameters
    ----------
    name : str
        Which: "orbits from H1".
    branches : int
        How many branches it added.
    troubles, notes : tuple of str
        What it had to say.
    """

    name: str
    branches: int
    troubles: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()


class Journal:
    """The steps of a run, kept in a folder.

    Parameters
    ----------
    folder : Path
        Where.
    arguments : Namespace
        The run's arguments.
    """

    def __init__(self, folder: Path, arguments: Namespace) -> None:
        self.branches_file, self.steps_file = (folder / name for name in UNFINISHED)
        self.told = {
            name: repr(value)
            for name, value in vars(arguments).items()
            if name not in _OF_NO_MATTER
        }
        self.steps: list[Step] = []
        self._earlier: dict[str, tuple[Step, tuple[Branch, ...]]] = {}

    def take_up(self, system: System) -> None:
        """Read what an earlier run has finished.

        Parameters
        ----------
        system : System
            What this run follows.

        Raises
        ------
        UsageError
            If there is none, or it was another run.
        FileError
            If its files cannot be read.
        """
        from racs_bif.results.diagram import Diagram
        from racs_bif.results.files import load
        from racs_bif.results.provenance import describe

        if not self.steps_file.exists():
            msg = f"{self.steps_file.parent} holds no unfinished run to go on with"
            raise UsageError(f"{msg}; leave out --resume")
        told, steps = self._read()
        mine = self.told | _origin(describe(system))
        different = sorted(k for k in {*told, *mine} if told.get(k) != mine.get(k))
        if different:
            msg = f"the unfinished run in {self.steps_file.parent} differs in"
            raise UsageError(
                f"{msg} {', '.join(different)}; give the same, or leave out --resume to begin again"
            )
        found = load(self.branches_file)
        branches = found.branches if isinstance(found, Diagram) else ()
        first = 0
        for step in steps:
            added = tuple(branches[first : first + step.branches])
            if len(added) != step.branches:
                raise FileError(self._spoilt("it lacks branches"))
            self._earlier[step.name] = step, added
            first += step.branches

    def _read(self) -> tuple[dict[str, str], list[Step]]:
        try:
            text: dict[str, Any] = json.loads(self.steps_file.read_text(encoding="utf-8"))
            if text["format"] != _FORMAT:
                raise FileError(self._spoilt(f"its format is {text['format']}, not {_FORMAT}"))
            steps = [
                Step(s["name"], s["branches"], tuple(s["troubles"]), tuple(s["notes"]))
                for s in text["steps"]
            ]
            return dict(text["run"]), steps
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise FileError(self._spoilt(f"it cannot be read ({error})")) from None

    def _spoilt(self, why: str) -> str:
        return f"{self.steps_file} is of no use: {why}; leave out --resume to begin again"

    def earlier(self, name: str) -> tuple[Step, tuple[Branch, ...]] | None:
        """Return a step that the earlier run has finished, and its branches."""
        return self._earlier.get(name)

    def keep(self, step: Step, branches: Sequence[Branch]) -> None:
        """Put a step that is done, and all branches so far, on disk.

        A disk that takes nothing is told of at the end, where the results are written.
        """
        from racs_bif.results.atomic import write_text
        from racs_bif.results.diagram import Diagram
        from racs_bif.results.files import save

        self.steps.append(step)
        self._earlier.pop(step.name, None)
        rest = list(self._earlier.values())  # what this run has not come to yet
        steps = [*self.steps, *(step for step, _ in rest)]
        told = self.told | _origin(branches[0].system)
        text = {"format": _FORMAT, "run": told, "steps": [asdict(s) for s in steps]}
        with suppress(FileError, OSError):
            self.branches_file.parent.mkdir(parents=True, exist_ok=True)
            save(Diagram(*branches, *(b for _, mine in rest for b in mine)), self.branches_file)
            write_text(self.steps_file, json.dumps(text, indent=1) + "\n")

    def close(self) -> None:
        """Remove the files: all is in the results."""
        for path in (self.steps_file, self.branches_file):
            with suppress(OSError):
                path.unlink()


def _origin(info: SystemInfo) -> dict[str, str]:
    return {"equations": info.equations, "version": info.version}
