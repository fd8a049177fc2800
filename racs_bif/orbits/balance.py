"""The equations of harmonic balance on the exact operator, and their derivatives.

With X(t) = sum_k X_k e^(i k Omega t) the exact model is left(i k Omega) X_k = right(i k Omega)
core(X)_k for every harmonic: order alpha is (i k Omega)^alpha, with no realisation. The core is
evaluated in time and analysed by FFT (T. M. Cameron and J. H. Griffin, *J. Appl. Mech.* 56, 1989).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.orbits.diagonals import Diagonals
from racs_bif.orbits.elimination import choose
from racs_bif.orbits.fourier import (
    analysed,
    harmonics_of,
    points_for,
    sampled,
    to_complex,
    to_real,
)

if TYPE_CHECKING:
    from racs_bif.fractional.exact import ExactModel
    from racs_bif.orbits.diagonals import Pair
    from racs_bif.orbits.elimination import Elimination, Places
    from racs_bif.orbits.fourier import Complex
    from racs_bif.symbolic.field import Array
    from racs_bif.symbolic.paths import ParameterPath


class Balance:
    """Harmonic balance of an exact model, for any number of harmonics.

    Parameters
    ----------
    model : ExactModel
        The model.
    path : ParameterPath
        Where the active parameter leads.
    active : float
        A value of it, at which the unknowns are chosen.

    Attributes
    ----------
    elimination : Elimination
        Which unknowns are given by affine rows.
    felt : bool
        Whether a nonlinearity depends on one of those.
    """

    def __init__(self, model: ExactModel, path: ParameterPath, active: float) -> None:
        self.model, self.path, self.compiled = model, path, model.compiled
        p = path.vector(active)
        fixed, varying = _places(self.compiled.meta["fixed"]), self.compiled.varying_at
        self.elimination: Elimination = choose(fixed, varying, model.laws(p), model.size)
        self.terms = _terms(self.elimination, fixed, varying, model.ny)
        self.felt = bool(np.isin(varying[1], self.elimination.given).any())

    @property
    def kept(self) -> tuple[int, ...]:
        """Places in X of the unknowns of the balance."""
        return tuple(map(int, self.elimination.kept))

    def at(self, series: Array, period: float, active: float) -> Balanced:
        """Evaluate the balance.

        Parameters
        ----------
        series : array (2H + 1, m)
            The unknowns kept.
        period, active : float
            Period and active parameter.

        Raises
        ------
        ConvergenceError
            If the period is not positive. What is evaluated on the orbit raises it as well, where
            the equations are not finite.
        """
        if not period > 0.0:
            raise ConvergenceError(f"the period became {period:.6g}, which is not positive")
        p, dp = self.path.vector(active), self.path.direction(active)
        diagonals = Diagonals.of(self.model, p, dp)
        return Balanced(self, series, period, p, dp, diagonals)


@dataclass(frozen=True, eq=False)
class Balanced:
    """The balance at one orbit.

    Attributes
    ----------
    balance : Balance
        Whose equations these are.
    series : array (2H + 1, m)
        The unknowns kept.
    period : float
        The period.
    p, dp : array (np,)
        Base parameters, and their direction along the active one.
    diagonals : Diagonals
        The frequency responses there.
    """

    balance: Balance
    series: Array
    period: float
    p: Array
    dp: Array
    diagonals: Diagonals

    @property
    def harmonics(self) -> int:
        """Number H of harmonics."""
        return harmonics_of(self.series)

    @cached_property
    def s(self) -> Complex:
        """Frequencies i k Omega (H + 1,)."""
        return np.asarray(2j * np.pi / self.period * np.arange(self.harmonics + 1))

    @cached_property
    def padded(self) -> Array:
        """Parameters as the core takes them."""
        return self.balance.compiled.padded(self.p)

    @cached_property
    def fixed(self) -> Array:
        """Jacobian of the core where it does not vary (n, n)."""
        return self.balance.compiled.fixed_jacobian(self.padded).copy()

    @cached_property
    def sides(self) -> Pair:
        """The diagonals (H + 1, n)."""
        return self.diagonals.at(self.s)

    @cached_property
    def maps(self) -> Complex:
        """X_k by the unknowns kept (H + 1, n, m)."""
        return self.balance.elimination.maps(self.sides, self.fixed)

    @cached_property
    def spectrum(self) -> Complex:
        """X_k (H + 1, n), those that are given included."""
        elimination = self.balance.elimination
        found: Complex = (self.maps @ to_complex(self.series)[:, :, None])[:, :, 0]
        if len(elimination.rows):
            # where the affine rows are constant, they are so at any point
            constant = self.balance.compiled.core(found[0].real, self.padded)
            constant = (constant - self.fixed @ found[0].real)[elimination.rows]
            sides = (self.sides[0][:1], self.sides[1][:1])
            rhs = sides[1][:, elimination.rows] * constant
            found[0] += elimination.given_by(rhs, sides, self.fixed)[0]
        return found

    @cached_property
    def points(self) -> Array:
        """X at equal times (n, N)."""
        return sampled(self.spectrum, points_for(self.harmonics))

    @cached_property
    def core(self) -> Array:
        """The core there (n, N)."""
        values = self.balance.compiled.core(self.points, self.padded)
        if not np.isfinite(values.sum()):
            raise ConvergenceError("the equations are not finite on the orbit")
        return values

    @cached_property
    def responses(self) -> Complex:
        """The core's spectrum (H + 1, n)."""
        return analysed(self.core, self.harmonics)

    @cached_property
    def residual(self) -> Array:
        """What does not balance (2H + 1, m), as a series."""
        left, right = self.sides
        unbalanced = left * self.spectrum - right * self.responses
        return to_real(unbalanced[:, self.balance.elimination.left])

    @cached_property
    def varying(self) -> Array:
        """The entries of the core's Jacobian that vary (e, N)."""
        return self.balance.compiled.varying_jacobian(self.points, self.padded)

    @cached_property
    def transforms(self) -> Complex:
        """Their Fourier coefficients (e, N), the harmonic -k in place N - k."""
        return np.asarray(np.fft.fft(self.varying, axis=1) / self.points.shape[1])

    @cached_property
    def jacobian(self) -> Array:
        """Derivative of the residual by the series, (2H + 1, m, 2H + 1, m)."""
        return _assembled(self)

    @cached_property
    def slopes(self) -> tuple[Array, Array]:
        """Derivatives of the residual by period and by active parameter, (2H + 1, m) each.

        The affine rows are held in balance: the unknowns that they give move as well.
        """
        return self._reduced(self._by_period()), self._reduced(self._by_parameter())

    def _reduced(self, moved: Complex) -> Array:
        """Return the series of what moved in the rows left."""
        elimination = self.balance.elimination
        if len(elimination.rows):
            left, right = self.sides
            given = elimination.given_by(-moved[:, elimination.rows], self.sides, self.fixed)
            felt = self.linearised(given) if self.balance.felt else given @ self.fixed.T
            moved = moved + left * given - right * felt
        return to_real(moved[:, elimination.left])

    def _by_period(self) -> Complex:
        left, right = self.diagonals.slopes(self.s)
        moved = left * self.spectrum - right * self.responses
        return np.asarray(moved * (-self.s / self.period)[:, None])

    def _by_parameter(self) -> Complex:
        compiled = self.balance.compiled
        slopes = compiled.core_p(self.points, self.padded, compiled.padded(self.dp))
        moved = -self.sides[1] * analysed(slopes, self.harmonics)
        drifts = self.diagonals.drifts(self.s)
        if drifts is not None:
            moved += drifts[0] * self.spectrum - drifts[1] * self.responses
        return moved

    def linearised(self, change: Complex) -> Complex:
        """Return the spectrum of the core's Jacobian times a change of X (H + 1, n)."""
        values = sampled(change, self.points.shape[1])
        product = self.fixed @ values
        rows, columns = self.balance.compiled.varying_at
        np.add.at(product, rows, self.varying * values[columns])
        return analysed(product, self.harmonics)


def _places(entries: list[tuple[int, int]]) -> tuple[Places, Places]:
    table = np.array(entries, dtype=np.intp).reshape(-1, 2)
    return table[:, 0], table[:, 1]


@dataclass(frozen=True)
class _Terms:
    """Ways by which an unknown is felt through an entry of the Jacobian that varies.

    Attributes
    ----------
    entry : int array (t,)
        The entry.
    row, unknown : int array (t,)
        Row and column among those that the elimination leaves; no pair of them twice.
    bare : bool
        Whether all rows are states' and all columns are unknowns themselves, so that no factor
        depends on the frequency.
    """

    entry: Places
    row: Places
    unknown: Places
    bare: bool


def _terms(
    elimination: Elimination, fixed: tuple[Places, Places], varying: tuple[Places, Places], ny: int
) -> tuple[_Terms, ...]:
    """Return all ways, in groups without a pair of row and unknown twice."""
    size = len(elimination.rows) + len(elimination.left)
    # only where numbers are zero matters: these have nothing to do with one another
    numbers = np.sqrt(2.0 + np.arange(size * size).reshape(size, size))
    structure = np.zeros((size, size))
    structure[fixed] = numbers[fixed]
    side = np.asarray(np.exp(1j * np.arange(1.0, size + 1.0)))[None]
    pattern = elimination.maps((side, side.conj()), structure)[0] != 0.0
    groups: list[list[tuple[int, int, int]]] = []
    for entry, (i, j) in enumerate(zip(*varying, strict=True)):
        row = int(np.searchsorted(elimination.left, i))
        for unknown in np.flatnonzero(pattern[j]):
            pair = (row, int(unknown))
            group = next((g for g in groups if pair not in {t[1:] for t in g}), None)
            if group is None:
                groups.append(group := [])
            group.append((entry, *pair))
    bare = bool(np.all(varying[0] < ny) and np.all(np.isin(varying[1], elimination.kept)))
    columns = (np.array(group, dtype=np.intp).T for group in groups)
    return tuple(_Terms(entry, row, unknown, bare) for entry, row, unknown in columns)


def _assembled(here: Balanced) -> Array:
    """Return the Jacobian in real coefficients.

    A change of the unknowns x_l moves the residual r_k by A_kl x_l + B_kl conj(x_l), where A is
    made of differences k - l of the harmonics of the entries and B of their sums k + l.
    """
    elimination = here.balance.elimination
    left, right = here.sides
    count, width = here.harmonics + 1, len(elimination.kept)
    matrix = np.zeros((2 * count - 1, width, 2 * count - 1, width))
    rows, columns = here.balance.compiled.varying_at
    k = np.arange(count)
    differences = (k[:, None] - k) % here.transforms.shape[1]
    sums = k[:, None] + k
    for term in here.balance.terms:
        A = here.transforms[term.entry[:, None, None], differences]
        B = here.transforms[term.entry[:, None, None], sums]
        if not term.bare:
            heads = right.T[rows[term.entry]][:, :, None]
            factors = here.maps[:, columns[term.entry], term.unknown].T[:, None, :]
            A, B = A * heads * factors, B * heads * factors.conj()
        even, odd = A + B, (A - B)[:, :, 1:]
        even[:, 0] *= 0.5
        odd[:, 0] *= 0.5
        row, unknown = term.row, term.unknown
        matrix[:count, row, :count, unknown] -= even.real
        matrix[count:, row, :count, unknown] += even.imag[:, 1:]
        matrix[:count, row, count:, unknown] -= odd.imag
        matrix[count:, row, count:, unknown] -= odd.real[:, 1:]
    own = left[:, :, None] * here.maps - right[:, :, None] * (here.fixed @ here.maps)
    own = own[:, elimination.left]
    later = k[1:] + here.harmonics
    matrix[k, :, k] += own.real
    matrix[later, :, later] += own.real[1:]
    matrix[k[1:], :, later] += own.imag[1:]
    matrix[later, :, k[1:]] -= own.imag[1:]
    return matrix
