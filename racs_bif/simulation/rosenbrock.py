"""One step of a Rosenbrock method, for many members at once.

Source: G. Steinebach, *Construction of Rosenbrock-Wanner method Rodas5P and numerical benchmarks
within the Julia Differential Equations package*, BIT 63 (2023) 27: order 5(4), L-stable, 8 stages
with one matrix, an interpolation of order 4. Stiff states cost no steps.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array

ORDER: Final = 5
STAGES: Final = 8
GAMMA: Final = 0.21193756319429014
_LAST: Final = (
    -7.502846399306121,
    2.561846144803919,
    -11.627539656261098,
    -0.18268767659942256,
    0.030198172008377946,
)
PLACES: Final = (
    (),
    (3.0,),
    (2.849394379747939, 0.45842242204463923),
    (-6.954028509809101, 2.489845061869568, -10.358996098473584),
    (2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641),
    _LAST,
    (*_LAST, 1.0),
    (*_LAST, 1.0, 1.0),
)
"""Where the stages are; the step ends at the last one plus the last increment."""
COUPLINGS: Final = (
    (),
    (-14.155112264123755,),
    (-17.97296035885952, -2.859693295451294),
    (147.12150275711716, -1.41221402718213, 71.68940251302358),
    (165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306),
    (
        24.854864614690072,
        -3.0009227002832186,
        47.4931110020768,
        5.5814197821558125,
        -0.6610691825249471,
    ),
    (
        30.91273214028599,
        -3.1208243349937974,
        77.79954646070892,
        34.28646028294783,
        -19.097331116725623,
        -28.087943162872662,
    ),
    (
        37.80277123390563,
        -3.2571969029072276,
        112.26918849496327,
        66.9347231244047,
        -40.06618937091002,
        -54.66780262877968,
        -9.48861652309627,
    ),
)
BETWEEN: Final = np.array(
    [
        [
            25.948786856663858,
            -2.5579724845846235,
            10.433815404888879,
            -2.3679251022685204,
            0.524948541321073,
            1.1241088310450404,
            0.4272876194431874,
            -0.17202221070155493,
        ],
        [
            -9.91568850695171,
            -0.9689944594115154,
            3.0438037242978453,
            -24.495224566215796,
            20.176138334709044,
            15.98066361424651,
            -6.789040303419874,
            -6.710236069923372,
        ],
        [
            11.419903575922262,
            2.8879645146136994,
            72.92137995996029,
            80.12511834622643,
            -52.072871366152654,
            -59.78993625266729,
            -0.15582684282751913,
            4.883087185713722,
        ],
    ]
)
"""With r = 1 - s: x(s) = r x0 + s (x1 + r (k1 + s (k2 + s k3))), each k of these increments."""


class Linear(Protocol):
    """The equations' linearisation at M places."""

    def solve(self, right: Array) -> Array:
        """Return k (n, M) with (1 / (GAMMA h) - Jacobian) k = right."""


class Equations(Protocol):
    """x' = rate(x), x (n, M)."""

    def rate(self, x: Array) -> Array:
        """Return x'."""

    def linear(self, x: Array, shift: Array) -> Linear:
        """Return the linearisation at x, with 1 / (GAMMA h) (M,)."""


@dataclass(frozen=True)
class Step:
    """A step that was tried.

    Parameters
    ----------
    x : array (n, M)
        Where it ends.
    error : array (n, M)
        Estimate of its error there.
    increments : array (STAGES, n, M)
        What it was made of.
    """

    x: Array
    error: Array
    increments: Array


def step(equations: Equations, x: Array, h: Array) -> Step:
    """Try a step.

    Parameters
    ----------
    equations : Equations
        Those of all members.
    x : array (n, M)
        Where it begins.
    h : array (M,)
        Sizes of the members' steps.
    """
    linear = equations.linear(x, 1.0 / (GAMMA * h))
    increments = np.empty((STAGES, *x.shape))
    rate = equations.rate(x)
    at = x
    for k in range(STAGES):
        if k:
            at = x + weighted(PLACES[k], increments)
            rate = equations.rate(at) + weighted(COUPLINGS[k], increments) / h
        increments[k] = linear.solve(rate)
    return Step(at + increments[-1], increments[-1], increments)


def weighted(weights: tuple[float, ...] | Array, rows: Array) -> Array:
    """Return the weighted sum of the first rows (k, n, M)."""
    count = len(weights)
    flat = np.asarray(weights) @ rows[:count].reshape(count, -1)
    return np.asarray(flat.reshape(rows.shape[1:]))
