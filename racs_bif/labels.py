"""The labels of special points: MatCont's letters, with AUTO's as aliases.

Names follow Yu. A. Kuznetsov, *Elements of Applied Bifurcation Theory*, Springer.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class Label:
    """One kind of point: its letters, its name in prose, and the letters others use."""

    code: str
    title: str
    aliases: tuple[str, ...] = ()


_TABLE: Final = (
    Label("EP", "end point"),
    Label("MX", "abnormal end"),
    Label("UZ", "user value"),
    Label("LP", "fold (limit point)", ("SN",)),
    Label("H", "Hopf point", ("HB",)),
    Label("BP", "branch point"),
    Label("CP", "cusp"),
    Label("BT", "Bogdanov-Takens point"),
    Label("GH", "generalised Hopf (Bautin) point"),
    Label("ZH", "zero-Hopf point"),
    Label("HH", "double Hopf point"),
    Label("LPC", "fold of cycles"),
    Label("PD", "period doubling"),
    Label("NS", "Neimark-Sacker point", ("TR",)),
    Label("BPC", "branch point of cycles"),
    Label("CPC", "cusp of cycles"),
    Label("GPD", "generalised period doubling"),
    Label("CH", "Chenciner point"),
    Label("R1", "1:1 resonance"),
    Label("R2", "1:2 resonance"),
    Label("R3", "1:3 resonance"),
    Label("R4", "1:4 resonance"),
    Label("LPPD", "fold-flip point"),
    Label("LPNS", "fold-Neimark-Sacker point"),
    Label("PDNS", "flip-Neimark-Sacker point"),
    Label("NSNS", "double Neimark-Sacker point"),
)
LABELS: Final = {label.code: label for label in _TABLE}
_CODES: Final = {alias: label.code for label in _TABLE for alias in (label.code, *label.aliases)}


def canonical(code: str) -> str:
    """Return MatCont's letters for a label written in MatCont's or AUTO's way.

    Raises
    ------
    KeyError
        If nobody uses these letters.

    Examples
    --------
    >>> canonical("HB"), canonical("TR")
    ('H', 'NS')
    """
    return _CODES[code.upper()]
