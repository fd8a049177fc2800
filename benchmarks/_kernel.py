"""The reference kernel that costs are ratios to, and how a function is measured against it.

The kernel is a fixed computation of some 20 ms that is made of what the hot paths are made of:
plain Python, numpy calls on small arrays, and LAPACK on small matrices. None of it is ours, so that
it gets faster or slower with the machine and never with the package. It must not be changed without
storing all baselines again.

Times are CPU time of one thread. Function and kernel are measured in turn, and the median of the
ratios of neighbours counts. On a machine of two cores with six busy programs, six measurements of a
path spread by 10 % of it on average, ratios of the least times by 16 %.
"""

from __future__ import annotations

import gc
import statistics
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from scipy.linalg import eigvals

if TYPE_CHECKING:
    from collections.abc import Callable

_SHORTEST: Final = 0.05
"""Seconds that a measurement is to take: a fast function is called as often as that needs."""
_MOST_CALLS: Final = 1 << 20


@dataclass(frozen=True)
class Ratio:
    """How long a function takes.

    Attributes
    ----------
    ratio : float
        To the kernel.
    seconds, reference : float
        CPU time of a call, and of the kernel.
    """

    ratio: float
    seconds: float
    reference: float


def kernel() -> float:
    """Compute something that has nothing to do with the package."""
    total = 0.0
    table: dict[int, float] = {}
    for k in range(20_000):
        table[k % 97] = total
        total += 0.5 * k - table.get(k % 89, 0.0) * 1e-9
    x = np.linspace(0.0, 1.0, 20)
    for _ in range(1000):
        x = np.concatenate([x[10:], x[:10] * x[10:]]) + 0.01
        x = np.where(x > 1.0, x - 1.0, x)
        total += float(x.sum())
    A = np.cos(np.arange(400.0)).reshape(20, 20) + 20.0 * np.eye(20)
    for _ in range(40):
        x = np.linalg.solve(A + np.diag(x), x)
        total += float(eigvals(A, check_finite=False).real.max()) + float((A @ A).sum())
    return total


def spent(function: Callable[[], object], calls: int) -> float:
    """Return the CPU time of a call, of some calls in a row."""
    before = time.process_time()
    for _ in range(calls):
        function()
    return (time.process_time() - before) / calls


def measured(function: Callable[[], object], runs: int) -> Ratio:
    """Measure a function against the kernel.

    Parameters
    ----------
    function : callable
        What is measured; it is called once before.
    runs : int
        How many times.
    """
    function()
    kernel()
    calls = 1
    while calls < _MOST_CALLS and spent(function, calls) * calls < _SHORTEST:
        calls *= 2
    return in_turn(lambda: spent(function, calls), lambda: spent(kernel, 1), runs)


def in_turn(one: Callable[[], float], reference: Callable[[], float], runs: int) -> Ratio:
    """Return the ratio of two times that are measured in turn; their least are returned too."""
    before, pairs = reference(), []
    for _ in range(runs):
        gc.collect()
        time_of_one, after = one(), reference()
        pairs.append((time_of_one, 0.5 * (before + after)))
        before = after
    seconds, references = zip(*pairs, strict=True)
    ratio = statistics.median(a / b for a, b in pairs)
    return Ratio(ratio, min(seconds), min(references))
