"""A system whose laws are those of its realisation: quotients of polynomials in s.

What traces boundaries and counts roots on the exact characteristic equation then does so on the
equation of the realisation, memory states and all, without their number making it slower.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.fractional.exact import ExactModel
from racs_bif.fractional.laws import Law, PowerSum
from racs_bif.fractional.realised import RealisedField
from racs_bif.fractional.system import System

if TYPE_CHECKING:
    from racs_bif.fractional.bank import Frame
    from racs_bif.fractional.filter import Filter
    from racs_bif.symbolic.field import Array

_NO_WORSE: Final = 1e-8
"""Error of a response that polynomials may add, relative to it."""


@dataclass(frozen=True, eq=False)
class RationalSystem(System):
    """A system whose exact model has the laws of the realisation."""

    @classmethod
    def of(cls, system: System) -> RationalSystem:
        """Return the system with the laws of its realisation."""
        return cls(system.compiled, system.values, system.settings, system.loaded)

    @cached_property
    def exact(self) -> ExactModel:
        """The characteristic equation of the realised model."""
        return ExactModel(RationalField(self.compiled, self.settings))


class RationalField(RealisedField):
    """The realised vector field, with the laws of its filters instead of those they realise."""

    def laws(self, p: Array) -> tuple[Law, ...]:
        """Return the filters' laws at base parameters p (np,)."""
        frame = self._own.frame(p)
        pairs = zip(frame.laws, frame.filters, strict=True)
        return tuple(self._rational(law, done) for law, done in pairs)

    @property
    def states(self) -> tuple[str, ...]:  # type: ignore[override]
        """Names of the states of the realised field."""
        return self._own.states

    def frame(self, p: Array) -> Frame:
        """Return the frame of the filters themselves: memory states are theirs."""
        return self._own.frame(p)

    def law_directions(self, p: Array, dp: Array) -> tuple[Law, ...] | None:
        """Return the derivatives of these laws along dp, None if no law moves."""
        moved = self._own.law_directions(p, dp)
        if moved is None:
            return None
        frame = self._own.frame(p)
        triples = zip(frame.laws, frame.filters, moved, strict=True)
        return tuple(
            _slope(law.name, done, self.realisation.derivative(law, direction))
            for law, done, direction in triples
        )

    @cached_property
    def _own(self) -> RealisedField:
        return RealisedField(self.compiled, self.realisation)

    def __getstate__(self) -> tuple[object, ...]:
        """Pickle what makes it."""
        return (self.compiled, self.realisation)

    def __setstate__(self, state: tuple[object, ...]) -> None:
        """Make it again."""
        self.__init__(*state)  # type: ignore[misc] # as it was pickled

    def _rational(self, law: Law, done: Filter) -> Law:
        key = (done.A.tobytes(), done.B.tobytes(), done.C.tobytes(), done.D)
        kept = self._known.get(key)
        if kept is None:
            self._known.clear()
            kept = self._known[key] = rational(law, done)
        return kept

    @cached_property
    def _known(self) -> dict[object, Law]:
        return {}


def rational(law: Law, done: Filter) -> Law:
    """Return the transfer law of a filter that realises a law.

    Raises
    ------
    UsageError
        If its poles cannot be told apart well enough to write it as a quotient of polynomials.
    """
    poles, gains = _parts(law.name, done)
    bottom = np.poly(poles) if len(poles) else np.ones(1)
    top = done.D * bottom
    for k, gain in enumerate(gains):
        top[1:] = top[1:] + gain * np.poly(np.delete(poles, k))
    made = _law(law, np.asarray(top.real, dtype=float), np.asarray(bottom.real, dtype=float))
    s = np.asarray(1j * np.geomspace(*_seen(poles), 50), dtype=complex)
    right = done(s)
    if not np.all(np.abs(made(s) - right) <= _NO_WORSE * np.abs(right)):
        raise UsageError(_unusable(law.name))
    return made


def _slope(name: str, done: Filter, moved: Filter) -> Law:
    """Return the derivative of `rational`, that of the filter being `moved`."""
    diagonal = np.diag(np.diag(done.A))
    if not (
        np.array_equal(done.A, diagonal) and np.array_equal(moved.A, np.diag(np.diag(moved.A)))
    ):
        raise UsageError(_unusable(name))
    poles, speeds = np.diag(done.A), np.diag(moved.A)
    gains = done.C * done.B
    drifts = moved.C * done.B + done.C * moved.B
    count = len(poles)
    bottom = np.zeros(count + 1)
    top = moved.D * np.poly(poles) if count else np.array([moved.D])
    for k in range(count):
        without = np.poly(np.delete(poles, k))
        bottom[1:] -= speeds[k] * without
        top[1:] += drifts[k] * without
        for j in range(count):
            if j != k and speeds[j]:
                top[2:] -= gains[k] * speeds[j] * np.poly(np.delete(poles, [j, k]))
    top = top + done.D * bottom
    exponents = np.zeros(count + 1)
    return Law(PowerSum(top[::-1], exponents), PowerSum(bottom[::-1], exponents))


def _parts(name: str, done: Filter) -> tuple[Array, Array]:
    """Return poles and residues of a filter."""
    if np.array_equal(done.A, np.diag(np.diag(done.A))):
        return np.diag(done.A).copy(), done.C * done.B
    poles, vectors = np.linalg.eig(done.A)
    try:
        gains = (done.C @ vectors) * np.linalg.solve(vectors, done.B.astype(vectors.dtype))
    except np.linalg.LinAlgError:
        raise UsageError(_unusable(name)) from None
    return poles, gains


def _law(law: Law, top: Array, bottom: Array) -> Law:
    exponents = np.arange(len(bottom), dtype=float)
    return Law(
        PowerSum(top[::-1].copy(), exponents),
        PowerSum(bottom[::-1].copy(), exponents),
        law.name,
        law.feedthrough,
    )


def _seen(poles: Array) -> tuple[float, float]:
    sizes = np.abs(poles[poles != 0.0])
    return (float(sizes.min()), float(sizes.max())) if len(sizes) else (0.1, 10.0)


def _unusable(name: str) -> str:
    return (
        f"the realisation of '{name}' cannot be written with its poles apart, as charts and "
        "harmonic balance of the realised operator need; choose the realisation 'diffusive' or "
        "'fitted'"
    )
