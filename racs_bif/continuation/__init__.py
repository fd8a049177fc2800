"""Pseudo-arclength continuation: follows curves of solutions, knowing no dynamical system."""

from racs_bif.continuation.points import Point, SpecialPoint, Trace
from racs_bif.continuation.problem import Detector, Problem
from racs_bif.continuation.settings import StepSettings
from racs_bif.continuation.steps import steps
from racs_bif.continuation.stopped import Stopped
from racs_bif.continuation.trace import trace

__all__ = [
    "Detector",
    "Point",
    "Problem",
    "SpecialPoint",
    "StepSettings",
    "Stopped",
    "Trace",
    "steps",
    "trace",
]
