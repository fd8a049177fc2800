"""What the elements of a model remember, step by step.

With ``w~ = w - w_before`` and ``e~ = e - e_before``, deviations from the history before t = 0, a
memory gives at every step the numbers in ``w~ = gain * e~ + known``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.fractional.convolution_quadrature import check_orders, quadrature_weights
from racs_bif.fractional.exponential_sums import exponential_sum
from racs_bif.fractional.l1_scheme import l1_order, l1_weights

if TYPE_CHECKING:
    from racs_bif.fractional.laws import Law
    from racs_bif.symbolic.field import Array

    Build = Callable[[tuple[Law, ...], float, int, float], "Memory"]

TOLERANCE: Final = 1e-10
"""Error of the fast memory's weights, unless another is asked for."""


class Memory(ABC):
    """The memory of all elements of a model.

    Attributes
    ----------
    gain : array (ne,)
        Weight of the present input.
    """

    gain: Array

    @abstractmethod
    def known(self) -> Array:
        """Return what the past contributes (ne,) to the outputs of the step that comes next."""

    @abstractmethod
    def push(self, e: Array, w: Array) -> None:
        """Take in the deviations (ne,) of inputs and outputs of the step that was made."""

    @property
    @abstractmethod
    def touched(self) -> int:
        """How many numbers the next step reads: its cost."""


class FullMemory(Memory):
    """Everything is remembered: the convolution with given weights.

    Parameters
    ----------
    weights : array (ne, count + 1)
        Of the present input first.
    """

    def __init__(self, weights: Array) -> None:
        self.gain = weights[:, 0].copy()
        self._reversed = np.ascontiguousarray(weights[:, ::-1])
        self._inputs = np.zeros((len(weights), weights.shape[1]))
        self._made = 0

    def known(self) -> Array:
        """Return what the past contributes (ne,) to the outputs of the step that comes next."""
        past = slice(self._reversed.shape[1] - 1 - self._made, self._reversed.shape[1] - 1)
        pairs = zip(self._reversed[:, past], self._inputs[:, : self._made], strict=True)
        return np.array([np.dot(a, b) for a, b in pairs])

    def push(self, e: Array, w: Array) -> None:
        """Take in the deviations (ne,) of inputs and outputs of the step that was made."""
        self._inputs[:, self._made] = e
        self._made += 1

    @property
    def touched(self) -> int:
        """How many numbers the next step reads: its cost."""
        return 2 * len(self.gain) * self._made


class ExponentialMemory(Memory):
    """The recent past as it was, the rest in as many numbers as there are rates.

    Parameters
    ----------
    laws : tuple of Law
        One for each element.
    step : float
        Distance of times [s].
    count : int
        Number of steps over which it shall reach.
    tolerance : float
        Largest relative error of the weights of each power of s.
    """

    def __init__(self, laws: tuple[Law, ...], step: float, count: int, tolerance: float) -> None:
        powers = [row for law in laws for row in (law.numerator, law.denominator)]
        sums = exponential_sum(tuple(powers), step, count, tolerance)
        near_n = _rows([sums.nearby(law.numerator) for law in laws], sums.near)
        near_d = _rows([sums.nearby(law.denominator) for law in laws], sums.near)
        first = near_d[:, 0]
        self.gain = near_n[:, 0] / first
        # In order of time, like the signals: the oldest first.
        self._near = np.stack([near_n, -near_d])[:, :, :0:-1] / first[:, None]
        arriving = np.exp(-sums.near * sums.rates)
        far_n = _rows([sums.far(law.numerator) for law in laws], len(sums.rates))
        far_d = _rows([sums.far(law.denominator) for law in laws], len(sums.rates))
        self._arrive = np.stack([far_n, -far_d]) * arriving / first[:, None]
        self._fade = np.exp(-sums.rates)
        self._states = np.zeros_like(far_n)
        self._recent = np.zeros((2, len(laws), sums.near))

    def known(self) -> Array:
        """Return what the past contributes (ne,) to the outputs of the step that comes next."""
        near = (self._near * self._recent[:, :, 1:]).sum(axis=(0, 2))
        return np.asarray(near + self._states.sum(axis=1))

    def push(self, e: Array, w: Array) -> None:
        """Take in the deviations (ne,) of inputs and outputs of the step that was made."""
        self._recent[:, :, :-1] = self._recent[:, :, 1:]
        self._recent[0, :, -1], self._recent[1, :, -1] = e, w
        self._states *= self._fade
        self._states += (self._arrive * self._recent[:, :, :1]).sum(axis=0)

    @property
    def touched(self) -> int:
        """How many numbers the next step reads: its cost."""
        return self._recent.size + self._near.size + self._states.size + self._arrive.size


def _full(laws: tuple[Law, ...], step: float, count: int, tolerance: float) -> Memory:
    return FullMemory(_rows([quadrature_weights(law, step, count + 1) for law in laws], count + 1))


def _l1(laws: tuple[Law, ...], step: float, count: int, tolerance: float) -> Memory:
    return FullMemory(_rows([l1_weights(law, step, count + 1) for law in laws], count + 1))


def _rows(rows: list[Array], width: int) -> Array:
    return np.array(rows).reshape(len(rows), width)


METHODS: Final[dict[str, Build]] = {"bdf2": _full, "l1": _l1, "fast": ExponentialMemory}
"""What discretises the laws: from laws, step, number of steps and the fast one's tolerance."""


def order_of(method: str, laws: tuple[Law, ...]) -> float:
    """Return the order of convergence of a method at fixed times, for linear models."""
    return min([2.0, *map(l1_order, laws)]) if method == "l1" else 2.0


def check_laws(laws: tuple[Law, ...]) -> None:
    """Refuse laws that cannot be integrated.

    Raises
    ------
    ParameterError
        If an order is too high.
    """
    for law in laws:
        check_orders(law)
