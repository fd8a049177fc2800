"""Which points of codimension two are looked for on which curve of cycles."""

from __future__ import annotations

from typing import TYPE_CHECKING

from racs_bif.orbits.curves.doubling_points import DoublingResonance, GeneralisedPeriodDoubling
from racs_bif.orbits.curves.fold_points import CuspOfCycles, FoldResonance
from racs_bif.orbits.curves.interactions import DoublingBeside, FoldBeside, TorusBeside
from racs_bif.orbits.curves.torus_points import Chenciner, TorusResonance

if TYPE_CHECKING:
    from racs_bif.continuation.problem import Detector


def detectors(name: str) -> list[Detector]:
    """Return the detectors of a curve of kind "lpc", "pd" or "ns"."""
    if name == "lpc":
        beside = [DoublingBeside("LPPD", "lpc, pd"), TorusBeside("LPNS", "lpc, ns")]
        return [CuspOfCycles(), FoldResonance(), *beside]
    if name == "pd":
        others = [FoldBeside("LPPD", "pd, lpc"), TorusBeside("PDNS", "pd, ns")]
        return [GeneralisedPeriodDoubling(), DoublingResonance(), *others]
    strong = {"R1": 1.0, "R2": -1.0, "R3": -0.5, "R4": 0.0}
    resonances = [TorusResonance(label, kappa) for label, kappa in strong.items()]
    near = [FoldBeside("LPNS", "ns, lpc"), DoublingBeside("PDNS", "ns, pd")]
    return [*resonances, Chenciner(), *near, TorusBeside("NSNS", "ns")]
