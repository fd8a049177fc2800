"""A problem of the textbooks by AUTO-07p: its Fortran is compiled once, then run twice a time.

The equations are those that racs_bif evaluates, written out operation by operation.
"""

from __future__ import annotations

import shutil
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

from benchmarks import _auto
from benchmarks._driven import in_our_names, spent_so_far
from benchmarks._spent import spent
from benchmarks._textbook import Found

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from benchmarks._textbook import Problem

CONSTANTS: Final = """\
NDIM={size}, IPS={kind}, IRS={start}, ILP=1, ICP={active}
NTST=40, NCOL=4, IAD=3, ISP=2, ISW=1, IPLT=0, NBC=0, NINT=0
NMX={most}, RL0={low}, RL1={high}, A0=-1e8, A1=1e8
NPR=0, MXBF=0, IID=0, ITMX=20, ITNW=8, NWTN=3, JAC=0
EPSL=1e-8, EPSU=1e-8, EPSS=1e-7
DS={ds}, DSMIN=1e-6, DSMAX={dsmax}, IADS=1
NPAR=36
"""
LABELS: Final = {1: "BP", 2: "LP", 3: "HB", 5: "LP", 6: "BP", 7: "PD", 8: "TR"}
_HEADER: Final = "0"


class Auto:
    """AUTO-07p on one problem.

    Attributes
    ----------
    compilation : float
        CPU seconds that compiling and linking took.
    """

    def __init__(self, problem: Problem, folder: Path) -> None:
        from racs_bif.shelf import find
        from racs_bif.shelf.load import system_of
        from racs_bif.shelf.modules import load_module

        self._problem, self._folder = problem, folder
        made: Any = load_module(find("models", problem.model)).model()
        if problem.homoclinic is not None:
            made = replace(made, guess=problem.guess)
        system = system_of(made)
        self._size = len(system.field.states)
        before = spent_so_far()
        self._auto = _auto.Auto(system, problem.parameter, problem.span[0], folder)
        self.compilation = spent_so_far() - before

    def run(self) -> Found:
        """Follow equilibria, and orbits from the first Hopf point."""
        steps, seconds = self._problem.steps, 0.0
        low, high = self._problem.span
        seconds += self._step(
            kind=1, start=0, active=[1], low=low, high=high, most=1000, ds=steps["ds"],
            dsmax=steps["dsmax"],
        )  # fmt: skip
        rest = rows((self._folder / "fort.7").read_text().splitlines())
        hopf = next(label for kind, label, _ in rest if LABELS.get(kind) == "HB")
        shutil.copy(self._folder / "fort.8", self._folder / "fort.3")
        low, high = self._problem.orbits
        seconds += self._step(
            kind=2, start=hopf, active=[1, 11], low=low, high=high, most=int(steps["nmx"]),
            ds=steps["orbit_ds"], dsmax=steps["orbit_dsmax"],
        )  # fmt: skip
        orbits = rows((self._folder / "fort.7").read_text().splitlines())
        special = in_our_names(named(rest), orbits=False) + in_our_names(named(orbits), orbits=True)
        return Found(
            version="AUTO-07p",
            points=len(rest) + len(orbits),
            special=special,
            end=(orbits[-1][2][0], orbits[-1][2][-1]),
            seconds=[seconds],
        )

    def _step(self, **constants: object) -> float:
        text = CONSTANTS.format(size=self._size, **constants)
        for name in ("fort.7", "fort.8", "fort.9"):
            (self._folder / name).unlink(missing_ok=True)
        return spent(["./model.exe"], self._folder / "told", text, self._folder).seconds


def rows(lines: Iterable[str]) -> list[tuple[int, int, list[float]]]:
    """Return type, label and numbers of each point in AUTO's file ``fort.7``."""
    found = []
    for line in lines:
        words = line.split()
        if words and words[0] != _HEADER:
            numbers = [_auto.number(word) for word in words[4:]]
            found.append((int(words[2]), int(words[3]), numbers))
    return found


def named(points: Iterable[tuple[int, int, list[float]]]) -> list[tuple[str, float]]:
    """Return AUTO's labels and the values of the parameter of those that have one."""
    return [(LABELS[kind], numbers[0]) for kind, _, numbers in points if kind in LABELS]
