"""The stiffness for which one of the paper's stability boundaries is where the paper has it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from racs_bif import calibrate, load_model

if TYPE_CHECKING:
    from collections.abc import Mapping

SPAN: Final = (5e3, 1e5)
"""Stiffnesses searched [N/rad]."""


def pinned(hopf: Mapping[str, float]) -> float:
    """Return C_s [N/rad] that puts an exact Hopf point of the vehicle at some values."""
    return calibrate(load_model("racs"), "C_s", hopf, span=SPAN).value


def titled(stiffness: float, source: str = "") -> str:
    """Return a title such as ``C_s = 13128 N/rad (Fig. 9)``."""
    return rf"$C_s$ = {stiffness:.0f} N/rad" + (f" ({source})" if source else "")
