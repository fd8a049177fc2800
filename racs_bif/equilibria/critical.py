"""Eigenvectors of critical eigenvalues, normalised as normal forms want them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from racs_bif.equilibria.hopf_form import Complex
    from racs_bif.symbolic.field import Array


def pair_vectors(A: Array, omega: float, own: int) -> tuple[Complex, Complex]:
    """Return q, p (n,) of a pair: A q = i omega q, A^T p = -i omega p, <p, q> = 1.

    |q| = 1 over own states.
    """
    from scipy.linalg import eig

    values, left, right = eig(A, left=True, right=True)
    k = int(np.argmin(np.abs(values - 1j * omega)))
    q = right[:, k] / np.linalg.norm(right[:own, k])
    return q, left[:, k] / np.conj(np.vdot(left[:, k], q))


def null_vectors(A: Array, own: int) -> tuple[Complex, Complex]:
    """Return q, p (n,) with A q = 0, A^T p = 0, |q| = 1 over own states, p . q = 1.

    The sign of q is such that its largest own component is positive.
    """
    left, _, right = np.linalg.svd(A)
    q, p = right[-1], left[:, -1]
    largest = q[int(np.argmax(np.abs(q[:own])))]
    q = q / (np.linalg.norm(q[:own]) * np.sign(largest))
    return q.astype(complex), (p / (p @ q)).astype(complex)


def nilpotent_vectors(A: Array, own: int) -> tuple[Array, Array, Array, Array]:
    """Return q0, q1, p0, p1 (n,) of a double zero eigenvalue with one eigenvector.

    A q0 = 0, A q1 = q0, A^T p1 = 0, A^T p0 = p1, p0 . q0 = p1 . q1 = 1, p0 . q1 = p1 . q0 = 0, with
    |q0| = 1 and q0 . q1 = 0 over own states.
    """
    n = len(A)
    left, _, right = np.linalg.svd(A)
    matrix = np.zeros((n + 1, n + 1))
    matrix[:n, :n], matrix[:n, n], matrix[n, :n] = A, left[:, -1], right[-1]
    largest = right[-1][int(np.argmax(np.abs(right[-1][:own])))]
    q0 = right[-1] / (np.linalg.norm(right[-1][:own]) * np.sign(largest))
    q1 = np.linalg.solve(matrix, np.append(q0, 0.0))[:n]
    q1 = q1 - (q0[:own] @ q1[:own]) * q0
    p1 = left[:, -1] / (left[:, -1] @ q1)
    p0 = np.linalg.solve(matrix.T, np.append(p1, 0.0))[:n]
    # What rounding leaves of p1 . q0 is taken out with the scale of p0.
    p0 = p0 / (p0 @ q0)
    return q0, q1, p0 - (p0 @ q1) * p1, p1
