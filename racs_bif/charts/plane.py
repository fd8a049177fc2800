"""A rectangle in the plane of two parameters."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from racs_bif.fractional.system import System
    from racs_bif.symbolic.compiled_path import CompiledPath
    from racs_bif.symbolic.field import Array

Span = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Plane:
    """Two parameters of a system, their spans, and the others held.

    Places are given in the unit square: (0, 0) where both parameters are lowest.

    Parameters
    ----------
    system : System
        The system; its other parameters are held.
    names : (str, str)
        The parameters, base or derived.
    spans : ((float, float), (float, float))
        Their intervals.
    """

    system: System
    names: tuple[str, str]
    spans: tuple[Span, Span]

    @cached_property
    def path(self) -> CompiledPath:
        """The path of the two parameters."""
        return self.system.path(*self.names)

    @cached_property
    def corner(self) -> Array:
        """Lowest values (2,)."""
        return np.array([low for low, _ in self.spans])

    @cached_property
    def width(self) -> Array:
        """Lengths (2,) of the spans."""
        return np.array([high - low for low, high in self.spans])

    def values(self, places: Array) -> Array:
        """Return parameter values, shaped like places (2,) or (2, N); exact at the edges."""
        low, high = np.array(self.spans).T
        if places.ndim == 2:
            low, high = low[:, None], high[:, None]
        return np.asarray((1.0 - places) * low + places * high)

    def places(self, values: Array) -> Array:
        """Return places in the unit square of parameter values (2,) or (2, N)."""
        corner, width = self.corner, self.width
        if values.ndim == 2:
            corner, width = corner[:, None], width[:, None]
        return np.asarray((values - corner) / width)

    @property
    def nominal(self) -> Array | None:
        """Place (2,) of the system's own values; None where they are outside."""
        own = np.array([self.system.parameters[name] for name in self.names])
        place = self.places(own)
        return place if bool(np.all((place >= 0.0) & (place <= 1.0))) else None

    def vectors(self, places: Array) -> Array:
        """Return base parameters (np, N) at places (2, N); NaN where they cannot be set."""
        compiled, values = self.system.compiled, self.values(places)
        base = [p.name for p in compiled.parameters]
        derived = [d.name for d in compiled.derived]
        p = np.repeat(self.system.values[:, None], places.shape[1], axis=1)
        moved = [k for k, name in enumerate(self.names) if name in derived]
        for k, name in enumerate(self.names):
            if name in base:
                p[base.index(name)] = values[k]
        for k in moved * len(moved):  # one may depend on what the other sets
            j = derived.index(self.names[k])
            row = compiled.kernel(f"inverse{j}")(compiled.padded(p), values[k][None, :])
            p[base.index(compiled.derived[j].sets)] = row[0]
        return p
