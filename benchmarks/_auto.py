"""AUTO-07p, compiled and run on a system of this package, and its orbits read back.

Its Python front end does not work with numpy 2, so the executable is linked with gfortran against
the objects that the Debian package brings, and driven by constants on its standard input.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from benchmarks._fortran import written
from benchmarks._spent import Spent, spent
from racs_bif.orbits.mesh import Mesh
from racs_bif.orbits.piecewise import Piecewise

if TYPE_CHECKING:
    from racs_bif.fractional.system import System

ROOT: Final = Path(os.environ.get("AUTO_DIR", "/usr/lib/auto-07p"))
MISSING: Final = "AUTO-07p is not here and was not run: apt-get install auto-07p gfortran"
_FLAGS: Final = ("-O2", "-fopenmp", "-std=legacy", "-w")
_PARAMETERS: Final = 36
_HOPF, _WANTED = 3, -4
"""Types of AUTO's points."""

# EPSL and EPSU are our Newton's tolerance, ISP = 2 locates every bifurcation as we do; with an EPSS
# of the usual 1e-6 the wanted orbits would be beside the wanted values by more than their error
_CONSTANTS: Final = """\
NDIM={size}, IPS={kind}, IRS={start}, ILP=1, ICP={active}
NTST=40, NCOL=4, IAD=3, ISP=2, ISW=1, IPLT=0, NBC=0, NINT=0
NMX=2000, RL0={low}, RL1={high}, A0=0.0, A1=1e8
NPR=0, MXBF=0, IID=0, ITMX=20, ITNW=5, NWTN=3, JAC=0
EPSL=1e-8, EPSU=1e-8, EPSS=1e-9
DS={step}, DSMIN=1e-6, DSMAX={longest}, IADS=1
NPAR={parameters}, UZR={{{wanted}}}
"""


@dataclass(frozen=True)
class Found:
    """What AUTO found.

    Attributes
    ----------
    points : int
        Points of the branch of orbits.
    seconds : float
        CPU time of the run that found them.
    megabytes : float
        Its peak memory.
    orbits : dict of float to (float, float)
        Period and highest value of a state where the parameter has a wanted value.
    """

    points: int
    seconds: float
    megabytes: float
    orbits: dict[float, tuple[float, float]]


@dataclass(frozen=True)
class _Solution:
    """One solution of AUTO's file of them."""

    kind: int
    label: int
    times: np.ndarray
    states: np.ndarray
    parameters: np.ndarray


def available() -> bool:
    """Return whether AUTO-07p and a Fortran compiler are here."""
    return shutil.which("gfortran") is not None and bool(list((ROOT / "lib").glob("*.o")))


class Auto:
    """AUTO-07p on one system.

    Parameters
    ----------
    system : System
        The system.
    parameter : str
        The active parameter.
    begin : float
        Where the branch of equilibria begins that leads to the Hopf point: shortly before it.
    folder : Path
        Where to work.
    """

    def __init__(self, system: System, parameter: str, begin: float, folder: Path) -> None:
        self._size, self._folder, self._begin = len(system.field.states), folder, begin
        source = folder / "model.f90"
        source.write_text(written(system, parameter, begin))
        objects = sorted(map(str, (ROOT / "lib").glob("*.o")))
        command = ["gfortran", *_FLAGS, str(source), *objects, "-o", str(folder / "model.exe")]
        subprocess.run(command, check=True, cwd=folder)

    def orbits(self, high: float, state: int, wanted: tuple[float, ...]) -> Found:
        """Follow the orbits from the first Hopf point to a value of the parameter."""
        # AUTO watches the one pair that is nearest to the axis: a slow pair of the memory hides the
        # critical one unless steps are short
        self._run(
            kind=1, start=0, active=[1], high=self._begin + 0.2, wanted="", step=0.01, longest=0.01
        )
        hopf = next(s for s in self._solutions() if s.kind == _HOPF)
        shutil.copy(self._folder / "fort.8", self._folder / "fort.3")
        stops = f"1: {list(wanted)}"
        used = self._run(
            kind=2,
            start=hopf.label,
            active=[1, 11],
            high=high,
            wanted=stops,
            step=0.05,
            longest=0.5,
        )
        rows = (self._folder / "fort.7").read_text().splitlines()
        points = sum(row.split()[0] != "0" for row in rows if row.strip())
        orbits = {}
        for solution in self._solutions():
            if solution.kind == _WANTED:
                value = wanted[int(np.argmin(np.abs(np.array(wanted) - solution.parameters[0])))]
                top = _highest(solution, 4, state)
                orbits[value] = float(solution.parameters[10]), top
        return Found(points, used.seconds, used.megabytes, orbits)

    def _run(self, **constants: object) -> Spent:
        text = _CONSTANTS.format(
            size=self._size, low=self._begin - 1.0, parameters=_PARAMETERS, **constants
        )
        for name in ("fort.7", "fort.8", "fort.9"):
            (self._folder / name).unlink(missing_ok=True)
        return spent(["./model.exe"], self._folder / "told", text, self._folder)

    def _solutions(self) -> list[_Solution]:
        lines = (self._folder / "fort.8").read_text().splitlines()
        found, at = [], 0
        while at < len(lines):
            header = [int(word) for word in lines[at].split()]
            kind, label, count, width, rows = (header[k] for k in (2, 3, 6, 7, 8))
            numbers = [number(w) for line in lines[at + 1 : at + 1 + rows] for w in line.split()]
            table = np.array(numbers[: count * width]).reshape(count, width)
            parameters = np.array(numbers[-header[11] :])
            found.append(_Solution(kind, label, table[:, 0], table[:, 1:], parameters))
            at += 1 + rows
        return found


def number(word: str) -> float:
    """Read a number; AUTO leaves the E out of exponents of three digits."""
    try:
        return float(word)
    except ValueError:
        return float(word[:-4] + "e" + word[-4:])


def _highest(solution: _Solution, degree: int, state: int) -> float:
    """Return the highest value of a state, found on AUTO's polynomials as on our own."""
    mesh = Mesh(solution.times[::degree], 1)
    nodes = solution.states[:-1].reshape(mesh.steps, degree, -1)
    return float(Piecewise(mesh, nodes).extrema()[0][state])
