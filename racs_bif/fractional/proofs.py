"""Hopf points and folds of the exact model as systems that an interval proof can handle.

Unknowns are the equilibrium X, the parameter and, at a Hopf point, omega. That Delta(i omega) is
singular is one complex equation g = 0, g from the bordered matrix: there is no null vector among
the unknowns, so that a proof covers every Hopf point whose equilibrium, parameter and frequency lie
in the box. The Jacobian is regular at the zero; so the root i omega is simple and crosses the
imaginary axis with a speed that is not zero, or the fold is quadratic.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from racs_bif.fractional.enclosed import EnclosedModel, EnclosedPoint, solve_bordered
from racs_bif.fractional.exact_fold import null_vectors
from racs_bif.fractional.intervals import flint
from racs_bif.fractional.krawczyk import Box, Equations, prove

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import acb, arb

    from racs_bif.fractional.exact import ExactModel
    from racs_bif.fractional.intervals import Number
    from racs_bif.symbolic.compiled_path import CompiledPath
    from racs_bif.symbolic.field import Array

OMEGA = "omega"
"""What the frequency is called among the unknowns."""
_LEAST_SHARE = 1e-2
_LEAST_VALUE = 1e-3


def prove_hopf(model: ExactModel, path: CompiledPath, X: Array, value: float, omega: float) -> Box:
    """Prove that exactly one Hopf point lies in a box around an approximate one.

    Parameters
    ----------
    model : ExactModel
        The exact model, with or without fractional elements.
    path : CompiledPath
        The active parameter; all others are the doubles that they are.
    X : array (size,)
        States and element outputs.
    value, omega : float
        The parameter and the frequency [rad/s].

    Returns
    -------
    Box
        In X, the parameter and ``omega``.

    Raises
    ------
    UsageError
        If python-flint is not installed.
    NoneThereError
        If it was proved that there is none.
    ConvergenceError
        If nothing could be proved.
    """
    return prove(_Hopf(model, path, X, value, omega), "Hopf point")


def prove_fold(model: ExactModel, path: CompiledPath, X: Array, value: float) -> Box:
    """Prove that exactly one fold lies in a box around an approximate one; see `prove_hopf`."""
    return prove(_Fold(model, path, X, value), "fold")


class _Fold(Equations):
    def __init__(self, model: ExactModel, path: CompiledPath, X: Array, value: float) -> None:
        compiled = model.compiled
        self.names = (*compiled.states, *compiled.elements, path.names[0])
        self.centre = np.append(X, value)
        self.scales = _scales(X, value)
        self.model = EnclosedModel(model, path)
        left, right = null_vectors(model.jacobian(X, path.vector(value)))
        self._beside, self._below = left.tolist(), right.conj().tolist()

    def _solved(self, z: Sequence[arb]) -> tuple[EnclosedPoint, list[acb], list[acb], acb]:
        at = self.model.at(z[:-1], z[-1])
        return at, *solve_bordered(at.equilibrium_x(), self._below, self._beside)

    def values(self, z: Sequence[arb]) -> list[arb]:
        """Return the equilibrium equations and g."""
        at, _, _, g = self._solved(z)
        return [*at.equilibrium(), g.real]

    def slopes(self, z: Sequence[arb]) -> list[list[arb]]:
        """Return the derivatives by X and the parameter."""
        at, v, w, _ = self._solved(z)
        right, (n_p, d_p) = at.gains[0], at.gain_slopes
        last = [_turn(w, right, bent) for bent in at.bent(v)]
        along = _turn(w, right, at.shifted(v)) + _turn(w, n_p, at.turned(v)) - _turn(w, d_p, v)
        rows = _with_column(at.equilibrium_x(), at.equilibrium_p())
        return [*rows, [(-entry).real for entry in (*last, along)]]


class _Hopf(Equations):
    def __init__(
        self, model: ExactModel, path: CompiledPath, X: Array, value: float, omega: float
    ) -> None:
        compiled = model.compiled
        self.names = (*compiled.states, *compiled.elements, path.names[0], OMEGA)
        self.centre = np.concatenate([X, [value, omega]])
        self.scales = np.append(_scales(X, value), omega)
        self.model = EnclosedModel(model, path)
        left, right = null_vectors(model.delta(1j * omega, X, path.vector(value)))
        self._beside, self._below = left.tolist(), right.conj().tolist()

    def _solved(self, z: Sequence[arb]) -> tuple[_Frequency, list[acb], list[acb], acb]:
        at = _Frequency(self.model.at(z[:-2], z[-2]), z[-1])
        return at, *solve_bordered(at.delta(), self._below, self._beside)

    def values(self, z: Sequence[arb]) -> list[arb]:
        """Return the equilibrium equations, and g's real and imaginary part."""
        at, _, _, g = self._solved(z)
        return [*at.point.equilibrium(), g.real, g.imag]

    def slopes(self, z: Sequence[arb]) -> list[list[arb]]:
        """Return the derivatives by X, the parameter and omega."""
        at, v, w, _ = self._solved(z)
        point = at.point
        turned = point.turned(v)
        last = [_turn(w, at.right, bent) for bent in point.bent(v)]
        left_p, right_p = at.along()
        along = _turn(w, at.right, point.shifted(v)) + _turn(w, right_p, turned)
        along = along - _turn(w, left_p, v)
        left_s, right_s = at.slope()
        by_s = _turn(w, right_s, turned) - _turn(w, left_s, v)
        # g' = -w . (dDelta v), and the core enters Delta with a minus of its own.
        entries = [*last, along, by_s * flint().acb(0, 1)]
        zeros = [flint().arb(0)] * self.model.size
        rows = _with_column(_with_column(point.equilibrium_x(), point.equilibrium_p()), zeros)
        return [*rows, [e.real for e in entries], [e.imag for e in entries]]


class _Frequency:
    """A box's characteristic matrix at s = i omega."""

    def __init__(self, point: EnclosedPoint, omega: arb) -> None:
        package = flint()
        self.point, self._ny = point, point.model.ny
        self._log = package.acb(omega.log(), package.arb.pi() / 2)
        self._s = package.acb(0, omega)
        self.left = [self._s] * self._ny + [d(self._log) for d in point.laws.d]
        self.right = [package.acb(1)] * self._ny + [n(self._log) for n in point.laws.n]

    def delta(self) -> list[list[acb]]:
        """Return the characteristic matrix (size, size)."""
        pairs = zip(self.right, self.point.core_x, strict=True)
        rows: list[list[acb]] = [[-(n * entry) for entry in row] for n, row in pairs]
        for k, d in enumerate(self.left):
            rows[k][k] = rows[k][k] + d
        return rows

    def slope(self) -> tuple[list[acb], list[acb]]:
        """Return the derivatives of both diagonals by s."""
        one, zero = flint().acb(1), flint().acb(0)
        laws = self.point.laws
        left = [one] * self._ny + [d.slope(self._log) for d in laws.d]
        return left, [zero] * self._ny + [n.slope(self._log) for n in laws.n]

    def along(self) -> tuple[list[acb], list[acb]]:
        """Return the derivatives of both diagonals by the active parameter."""
        zeros, laws = [flint().acb(0)] * self._ny, self.point.laws
        left = zeros + [d.along(self._log) for d in laws.d]
        return left, zeros + [n.along(self._log) for n in laws.n]


def _scales(X: Array, value: float) -> Array:
    size = np.abs(X)
    largest = float(size.max())
    size = np.maximum(size, _LEAST_SHARE * largest) if largest else np.ones(len(X))
    return np.append(size, max(abs(value), _LEAST_VALUE))


def _turn(w: Sequence[Number], diagonal: Sequence[Number], v: Sequence[Number]) -> acb:
    """Return w . diag(diagonal) v."""
    parts = (a * b * c for a, b, c in zip(w, diagonal, v, strict=True))
    return cast("acb", sum(parts, flint().acb(0)))


def _with_column(rows: list[list[arb]], column: Sequence[arb]) -> list[list[arb]]:
    return [[*row, entry] for row, entry in zip(rows, column, strict=True)]
