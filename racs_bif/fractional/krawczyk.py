"""Proofs that exactly one zero of a system of equations lies in a box, by Krawczyk's operator.

For a box Z with centre c and any matrix Y, every zero in Z lies in
``K(Z) = c - Y f(c) + (I - Y f'(Z)) (Z - c)``. If K(Z) lies in the interior of Z there is exactly
one zero in Z, and f' is regular there; if K(Z) and Z are apart there is none (R. Krawczyk,
Computing 4, 1969; A. Neumaier, *Interval Methods for Systems of Equations*, Cambridge 1990,
section 5.1).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.fractional.intervals import UnboundedError, flint, working_precision

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import arb, arb_mat

    from racs_bif.symbolic.field import Array

_LARGEST = 0.1
_SMALLEST = 1e-12
_SHRINK = 10.0**-0.5
_TIGHTENINGS = 10


class Equations(ABC):
    """A square system of real equations with an approximate zero.

    Attributes
    ----------
    names : tuple of str
        The unknowns.
    centre : array (n,)
        The approximate zero.
    scales : array (n,)
        Typical sizes of the unknowns: the shape of the boxes.
    """

    names: tuple[str, ...]
    centre: Array
    scales: Array

    @abstractmethod
    def values(self, z: Sequence[arb]) -> list[arb]:
        """Return enclosures (n,) of the residuals over a box z (n,)."""

    @abstractmethod
    def slopes(self, z: Sequence[arb]) -> list[list[arb]]:
        """Return enclosures (n, n) of the derivatives over a box z (n,)."""


@dataclass(frozen=True)
class Box:
    """A box in which exactly one zero was proved to lie.

    Parameters
    ----------
    names : tuple of str
        The unknowns.
    centre, radii : arrays (n,)
        The box: there is one zero in it and no other.
    lower, upper : arrays (n,)
        Bounds between which that zero lies.
    """

    names: tuple[str, ...]
    centre: Array
    radii: Array
    lower: Array
    upper: Array

    def contains(self, name: str, value: float) -> bool:
        """Say whether an unknown may have a value in the box."""
        k = self.names.index(name)
        return bool(abs(value - self.centre[k]) <= self.radii[k])

    def width(self, name: str) -> float:
        """Return the distance of the bounds between which an unknown lies."""
        k = self.names.index(name)
        return float(self.upper[k] - self.lower[k])


class NoneThereError(ConvergenceError):
    """It was proved that no zero lies in the box that was looked at."""


def prove(equations: Equations, what: str) -> Box:
    """Prove that exactly one zero lies in a box around the approximate one.

    Boxes are tried from large to small; the first that can be proved is taken.

    Parameters
    ----------
    equations : Equations
        The system.
    what : str
        What a zero is, for messages.

    Raises
    ------
    UsageError
        If python-flint is not installed.
    NoneThereError
        If a box around the approximate zero was proved to hold none.
    ConvergenceError
        If nothing could be proved.
    """
    with working_precision():
        return _prove(equations, what)


def _prove(equations: Equations, what: str) -> Box:
    arb = flint().arb
    centre = [arb(float(x)) for x in equations.centre]
    try:
        step = _Step(equations, centre)
    except (UnboundedError, np.linalg.LinAlgError) as error:
        why = f"the equations cannot be solved at its place ({error})"
        msg = f"no proof of a {what}, {why}; ask for strength='complete'"
        raise ConvergenceError(msg) from None
    ratio, reason = _LARGEST, ""
    while ratio > _SMALLEST:
        radii = np.asarray(ratio * equations.scales, dtype=float)
        box = [arb(float(c), float(r)) for c, r in zip(equations.centre, radii, strict=True)]
        try:
            image = step(box)
        except UnboundedError as error:
            reason = str(error)
            ratio *= _SHRINK
            continue
        if any(not k.overlaps(z) for k, z in zip(image, box, strict=True)):
            msg = f"proved that no {what} lies in the box {_words(equations, radii)}"
            raise NoneThereError(msg)
        inside = zip(image, centre, radii, strict=True)
        if all(abs(k - c) < arb(float(r)) for k, c, r in inside):
            lower, upper = _tightened(equations, image)
            return Box(equations.names, equations.centre, radii, lower, upper)
        reason = "the equations vary too much, or the approximation is too far off"
        ratio *= _SHRINK
    msg = (
        f"no box around the {what} could be proved to hold exactly one, {reason}; "
        "ask for strength='complete'"
    )
    raise ConvergenceError(msg)


class _Step:
    """Krawczyk's operator around a centre."""

    def __init__(self, equations: Equations, centre: list[arb]) -> None:
        package = flint()
        self.equations, self.centre, n = equations, centre, len(centre)
        slopes = equations.slopes(centre)
        middle = np.array([[float(x.mid()) for x in row] for row in slopes])
        inverse = np.linalg.inv(middle)
        self.inverse: arb_mat = package.arb_mat(inverse.tolist())
        self.start = self.inverse * package.arb_mat(n, 1, equations.values(centre))

    def __call__(self, box: list[arb]) -> list[arb]:
        """Return K(box)."""
        package, n = flint(), len(box)
        slopes = package.arb_mat(self.equations.slopes(box))
        eye = package.arb_mat([[int(i == j) for j in range(n)] for i in range(n)])
        away = package.arb_mat(n, 1, [z - c for z, c in zip(box, self.centre, strict=True)])
        moved = (eye - self.inverse * slopes) * away
        return [c - self.start[k, 0] + moved[k, 0] for k, c in enumerate(self.centre)]


def _tightened(equations: Equations, box: list[arb]) -> tuple[Array, Array]:
    """Return bounds of the zero in a box that is known to hold it."""
    for _ in range(_TIGHTENINGS):
        image = _Step(equations, [z.mid() for z in box])(box)
        before = box
        box = [k.intersection(z) for k, z in zip(image, box, strict=True)]
        if all(z.rad() * 2 > b.rad() for z, b in zip(box, before, strict=True)):
            break
    lower = np.array([-_above(-z.lower()) for z in box])
    return lower, np.array([_above(z.upper()) for z in box])


def _above(number: arb) -> float:
    """Return a double that is not below an exact number."""
    double = float(number)
    return double if number <= double else float(np.nextafter(double, np.inf))


def _words(equations: Equations, radii: Array) -> str:
    triples = zip(equations.names, equations.centre, radii, strict=True)
    return ", ".join(f"{name} = {c:.6g} +- {r:.1e}" for name, c, r in triples)
