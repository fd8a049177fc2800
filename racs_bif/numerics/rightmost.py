"""The eigenvalues of a large sparse matrix that may be right of the imaginary axis.

Bendixson's theorem says where those are: in a rectangle that the symmetric and the skew part of the
matrix bound. Shift-invert Arnoldi gives all eigenvalues in a disk, the nearest ones to a shift;
further shifts are set until disks cover the rectangle, so that a pair far up the imaginary axis is
not missed. What is taken on trust is that Arnoldi's method, from a random vector, misses none in
its disk; that the number of real ones is even or odd is checked by the sign of a determinant. Where
so many shifts do not cover the rectangle, as with thousands of hardly damped oscillators, the
result says how far up the search went.

Sources: I. Bendixson, Acta Math. 25 (1902) 359; R. B. Lehoucq, D. C. Sorensen, C. Yang, *ARPACK
Users' Guide*, SIAM 1998.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from racs_bif.errors import ConvergenceError
from racs_bif.numerics.sparse import Factors, Matrix, start

if TYPE_CHECKING:
    from collections.abc import Sequence

Complex = NDArray[np.complex128]

_COUNT = 24
_MOST = 16
_WIDE, _HIGH = 64, 1024
_CELLS = 32
_NEAR = 1e-4
_ASIDE = 0.1
_TINY = 1e-9
_BALANCINGS = 20


@dataclass(frozen=True)
class Rightmost:
    """Eigenvalues of a real matrix.

    Parameters
    ----------
    values : complex array (m,)
        All that were found, the rightmost first; conjugates are both there.
    height : float
        No eigenvalue with a real part above zero and an imaginary part below this is missing;
        infinity where none is missing at all.
    """

    values: Complex
    height: float


@dataclass(frozen=True)
class _Disk:
    """All eigenvalues in a disk; `odd` says whether a real shift has an odd number above it."""

    centre: complex
    radius: float
    values: Complex
    odd: bool = False

    def holds(self, points: Complex, margin: float = 0.0) -> NDArray[np.bool_]:
        """Return which points, or their conjugates, are at least `margin` within the disk."""
        distance = np.minimum(np.abs(points - self.centre), np.abs(points.conj() - self.centre))
        return np.asarray(distance + margin <= self.radius)


def rightmost(matrix: Matrix) -> Rightmost:
    """Return the eigenvalues of a real sparse matrix that may be right of the imaginary axis.

    Parameters
    ----------
    matrix : sparse array (n, n)
        Of some hundred rows at least.

    Returns
    -------
    Rightmost
        These eigenvalues and others near them; always the same for the same matrix.

    Raises
    ------
    ConvergenceError
        If Arnoldi's method does not converge.
    """
    matrix = _balanced(matrix)
    right, top = _rectangle(matrix)
    for count in (_COUNT, 2 * _COUNT):
        disks = [_disk(matrix, 0.0, count)]
        cells = _cells(right, top, disks[0].radius)
        while (left := _uncovered(disks, cells)) is not None and len(disks) < _MOST:
            ahead = min(left.imag + 0.5 * disks[-1].radius, max(top, left.imag))
            disks.append(_disk(matrix, complex(left.real, ahead), count))
        _extend(matrix, disks, count)
        values = _merged(disks)
        height = math.inf if left is None else max(left.imag - cells[1], 0.0)
        real = values[values.imag == 0.0].real
        above = int(np.count_nonzero(real > disks[0].centre.real))
        if left is not None or above % 2 == disks[0].odd:
            return Rightmost(values, height)
    return Rightmost(values, 0.0)


def _balanced(matrix: Matrix) -> Matrix:
    """Return a similar matrix whose rows and columns are more alike: its rectangle is smaller."""
    entries = matrix.tocoo()
    row, column = entries.coords
    data = np.where(row == column, 0.0, np.abs(entries.data))
    scale = np.ones(matrix.shape[0])
    for _ in range(_BALANCINGS):
        now = data * scale[column] / scale[row]
        rows = np.bincount(row, now, len(scale))
        columns = np.bincount(column, now, len(scale))
        both = (rows > 0.0) & (columns > 0.0)
        ratio = np.divide(rows, columns, out=np.ones_like(rows), where=both)
        # The fourth root: each entry is in a row and in a column, and both move at once.
        scale *= ratio**0.25
    entries.data = entries.data * scale[column] / scale[row]
    return entries.tocsc()


def _rectangle(matrix: Matrix) -> tuple[float, float]:
    """Return bounds of the real and the imaginary part of any eigenvalue, neither below zero."""
    symmetric, skew = (matrix + matrix.T) / 2.0, (matrix - matrix.T) / 2.0
    diagonal = symmetric.diagonal()
    right = diagonal - np.abs(diagonal) + abs(symmetric).sum(axis=1)
    return max(float(right.max()), 0.0), float(abs(skew).sum(axis=1).max())


def _cells(right: float, top: float, radius: float) -> tuple[NDArray[Any], float]:
    """Return the centres of the cells of a rectangle above the real axis, and their reach."""
    size = max(radius / 8.0, right / _WIDE, top / _HIGH)
    columns, rows = (max(math.ceil(length / size), 1) for length in (right, top))
    x = right * (np.arange(columns) + 0.5) / columns
    y = top * (np.arange(rows) + 0.5) / rows
    reach = 0.5 * math.hypot(right / columns, top / rows)
    return (x + 1j * y[:, None]).ravel(), reach


def _uncovered(disks: Sequence[_Disk], cells: tuple[NDArray[Any], float]) -> complex | None:
    """Return the centre of the lowest cell that no disk covers, the leftmost of several."""
    centres, reach = cells
    left = centres[~np.any([disk.holds(centres, reach) for disk in disks], axis=0)]
    return complex(left[0]) if len(left) else None


def _extend(matrix: Matrix, disks: list[_Disk], count: int) -> None:
    """Look as far left on the real axis as real eigenvalues go right: their sums may be zero."""
    values = _merged(disks)
    furthest = float(np.max(values[values.imag == 0.0].real, initial=0.0))
    reach = furthest / (2 * _CELLS)
    cells = -furthest * (np.arange(_CELLS) + 0.5) / _CELLS + 0j, reach
    while furthest and len(disks) < _MOST and (left := _uncovered(disks, cells)) is not None:
        disks.append(_disk(matrix, complex(left.real), count))


def _disk(matrix: Matrix, shift: complex, count: int) -> _Disk:
    """Return the eigenvalues nearest to a shift.

    The shift is moved aside where it is so near to an eigenvalue that the others would be lost in
    its rounding.
    """
    from scipy.sparse import eye_array

    size = matrix.shape[0]
    count = min(count, size - 2)
    eye = eye_array(size, format="csc")
    for _ in range(4):
        exact = shift.real if shift.imag == 0.0 else shift
        try:
            factors = Factors(matrix - exact * eye)
        except np.linalg.LinAlgError:
            shift += _TINY * float(abs(matrix).sum(axis=1).max())
            continue
        inverse = _largest(factors, size, count, real=shift.imag == 0.0)
        distance = 1.0 / np.abs(inverse)
        radius = float(distance.max())
        if distance.min() > _NEAR * radius:
            values = shift + 1.0 / inverse
            odd = shift.imag == 0.0 and factors.sign * (-1.0) ** size < 0.0
            return _Disk(shift, radius * (1.0 + _TINY), _upper(values, shift, radius), odd)
        shift += _ASIDE * radius
    msg = "no eigenvalues can be computed, whatever the shift"
    raise ConvergenceError(msg)


def _largest(factors: Factors, size: int, count: int, *, real: bool) -> Complex:
    """Return the largest eigenvalues of the inverse."""
    from scipy.sparse.linalg import ArpackError, LinearOperator, eigs

    kind = float if real else complex
    operator = LinearOperator((size, size), matvec=factors.once, dtype=kind)
    first = start(size).astype(kind)
    try:
        found = eigs(operator, k=count, which="LM", v0=first, return_eigenvectors=False)
    except ArpackError as error:
        msg = f"the eigenvalues were not found ({error})"
        raise ConvergenceError(msg) from None
    return np.asarray(found, dtype=complex)


def _upper(values: Complex, shift: complex, radius: float) -> Complex:
    """Return the eigenvalues on and above the real axis, of each pair of conjugates one."""
    if shift.imag == 0.0:
        # In real arithmetic they come in pairs, of which the count may have cut the last.
        real, pairs = values[values.imag == 0.0], values[values.imag != 0.0]
        return np.concatenate((real, np.unique(pairs.real + 1j * np.abs(pairs.imag))))
    edge = _TINY * radius
    kept = values[values.imag >= -edge]
    return np.where(np.abs(kept.imag) <= edge, kept.real, kept)


def _merged(disks: Sequence[_Disk]) -> Complex:
    """Return the eigenvalues of all disks, once each, with their conjugates, rightmost first."""
    upper = disks[0].values
    for k, disk in enumerate(disks[1:], 1):
        known = np.any([before.holds(disk.values) for before in disks[:k]], axis=0)
        upper = np.concatenate((upper, disk.values[~known]))
    values = np.concatenate((upper, upper[upper.imag > 0.0].conj()))
    return values[np.lexsort((values.imag, -values.real))]
