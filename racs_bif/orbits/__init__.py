"""Periodic orbits: discretisations, Floquet multipliers, detectors of their special points."""

from racs_bif.orbits.branch_point import BranchPointOfCycles
from racs_bif.orbits.collocation import CollocationProblem
from racs_bif.orbits.collocation_settings import CollocationSettings
from racs_bif.orbits.collocation_start import (
    CollocationStart,
    collocated_from_hopf,
    collocated_from_orbit,
    collocated_from_samples,
    doubled,
    switched,
)
from racs_bif.orbits.cycles_fold import FoldOfCycles
from racs_bif.orbits.floquet import Floquet, floquet
from racs_bif.orbits.neimark_sacker import NeimarkSacker
from racs_bif.orbits.orbit import Orbit, Refinement, refined
from racs_bif.orbits.period_doubling import PeriodDoubling
from racs_bif.orbits.problem import OrbitProblem
from racs_bif.orbits.settings import OrbitSettings
from racs_bif.orbits.shooting import ShootingProblem
from racs_bif.orbits.start import Start, from_hopf, from_samples, hopf_orbit

__all__ = [
    "BranchPointOfCycles",
    "CollocationProblem",
    "CollocationSettings",
    "CollocationStart",
    "Floquet",
    "FoldOfCycles",
    "NeimarkSacker",
    "Orbit",
    "OrbitProblem",
    "OrbitSettings",
    "PeriodDoubling",
    "Refinement",
    "ShootingProblem",
    "Start",
    "collocated_from_hopf",
    "collocated_from_orbit",
    "collocated_from_samples",
    "doubled",
    "floquet",
    "from_hopf",
    "from_samples",
    "hopf_orbit",
    "refined",
    "switched",
]
