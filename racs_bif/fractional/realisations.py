"""The realisations there are, by their names on the command line."""

from __future__ import annotations

from dataclasses import fields

from racs_bif.errors import UsageError, nearest
from racs_bif.fractional.aaa import Aaa
from racs_bif.fractional.charef import Charef
from racs_bif.fractional.continued_fraction import ContinuedFraction
from racs_bif.fractional.diffusive import Diffusive
from racs_bif.fractional.filter import Realisation
from racs_bif.fractional.fitted import Fitted
from racs_bif.fractional.matsuda import Matsuda
from racs_bif.fractional.modified_oustaloup import ModifiedOustaloup
from racs_bif.fractional.nonnegative import NonNegative
from racs_bif.fractional.oustaloup import Oustaloup
from racs_bif.fractional.vector_fitting import VectorFitting

DEFAULT = "diffusive"

REALISATIONS: dict[str, type[Realisation]] = {
    "diffusive": Diffusive,
    "fitted": Fitted,
    "oustaloup": Oustaloup,
    "modified-oustaloup": ModifiedOustaloup,
    "charef": Charef,
    "matsuda": Matsuda,
    "continued-fraction": ContinuedFraction,
    "nonnegative": NonNegative,
    "vector-fitting": VectorFitting,
    "aaa": Aaa,
}
"""Realisations by name."""


def choose_realisation(
    name: str | Realisation | None, band: tuple[float, float], *, order: int = 0
) -> Realisation:
    """Return a realisation by name with a band and an order (sections).

    Parameters
    ----------
    name : str or Realisation, optional
        A key of `REALISATIONS`, the default where left out; a realisation passes through.
    band : (float, float)
        Frequencies [rad/s] between which it approximates.
    order : int
        Its order, or its sections where it has those; 0 takes its default.

    Raises
    ------
    UsageError
        If the name is unknown, or band or order cannot be used.

    Examples
    --------
    >>> choose_realisation("charef", (0.1, 100.0), order=5).sections
    5
    """
    if isinstance(name, Realisation):
        return name
    known = REALISATIONS.get(name or DEFAULT)
    if known is None:
        msg = f"unknown realisation '{name}'; {nearest(str(name), REALISATIONS)}"
        raise UsageError(msg)
    size = "sections" if any(f.name == "sections" for f in fields(known)) else "order"
    return known(band=band, **{size: order})
