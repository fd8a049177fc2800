"""The matrix of multiple shooting, dense or as a bordered ring."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.orbits.condense import BorderedRing, Ring

if TYPE_CHECKING:
    from racs_bif.continuation.problem import Solver
    from racs_bif.symbolic.field import Array

TAIL: Final = 3
"""Unknowns after the states: period, number of the reference, parameter."""


def dense_jacobian(ends: Array, phase: Array, scales: Array) -> Array:
    """Return the derivative (M n + 2, M n + 3) of gaps, phase and number.

    Parameters
    ----------
    ends : array (M, n, n + 2)
        Derivatives of the ends of the segments by their starts, the period and the parameter.
    phase : array (M n + 2,)
        Derivative of the phase by all starts, the period and the parameter.
    scales : array (n,)
        Magnitudes by which the gaps are divided.
    """
    count, size = ends.shape[:2]
    scaled = ends / scales[:, None]
    jacobian = np.zeros((count * size + 2, count * size + TAIL))
    for m in range(count):
        own = slice(m * size, (m + 1) * size)
        jacobian[own, own] = scaled[m, :, :size]
    every = np.arange(count * size)
    jacobian[every, np.roll(every, -size)] -= np.tile(1.0 / scales, count)
    jacobian[every, -3] = scaled[:, :, size].ravel()
    jacobian[every, -1] = scaled[:, :, size + 1].ravel()
    jacobian[-2, :-2], jacobian[-2, -1] = phase[:-1], phase[-1]
    jacobian[-1, -2] = 1.0
    return jacobian


def ring_solver(ends: Array, phase: Array, scales: Array, row: Array) -> Solver:
    """Return a solver of [jacobian; row] by condensing the ring of segments orthogonally.

    Parameters
    ----------
    ends, phase, scales
        As of `dense_jacobian`.
    row : array (M n + 3,)
        The last row.
    """
    count, size = ends.shape[:2]
    scaled = ends / scales[:, None]
    transitions = scaled[:, :, :size] * scales
    rows = np.stack((phase, np.delete(row, -2)))
    borders = rows[:, :-2].reshape(2, count, size) * scales
    ring = Ring(transitions, np.broadcast_to(-np.eye(size), transitions.shape))
    solver = BorderedRing(ring, scaled[:, :, size:], borders, rows[:, -2:])

    def solve(rhs: Array) -> Array:
        matrix = rhs.reshape(len(rhs), -1)
        width, number = matrix.shape[1], matrix[-2]
        border = np.stack((matrix[-3], matrix[-1] - row[-2] * number))
        points, unknowns = solver.solve(matrix[:-TAIL].reshape(count, size, width), border)
        states = (points * scales[:, None]).reshape(-1, width)
        solution = np.concatenate((states, unknowns[:1], number[None], unknowns[1:]))
        return solution.reshape(rhs.shape)

    return solve
