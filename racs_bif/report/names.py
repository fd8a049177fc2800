"""Names and units as they are set in HTML."""

from __future__ import annotations

import re
from html import escape
from typing import Final

_GREEK: Final = dict(
    zip(
        (
            *("alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota"),
            *("kappa", "lambda", "mu", "nu", "xi", "pi", "rho", "sigma", "tau", "upsilon"),
            *("phi", "chi", "psi", "omega", "Gamma", "Delta", "Theta", "Lambda", "Xi", "Pi"),
            *("Sigma", "Phi", "Psi", "Omega"),
        ),
        "αβγδεζηθικλμνξπρστυφχψωΓΔΘΛΞΠΣΦΨΩ",
        strict=True,
    )
)


def symbol(name: str) -> str:
    """Return a name in HTML: Greek letters as letters, the rest after ``_`` as a subscript.

    A ``d`` before a Greek letter is a time derivative.

    Examples
    --------
    >>> symbol("delta_c"), symbol("u"), symbol("yaw")
    ('<i>δ</i><sub>c</sub>', '<i>u</i>', 'yaw')
    """
    base, _, index = name.partition("_")
    rate = base[:1] == "d" and base[1:] in _GREEK
    letter = _letter(base[1:]) + "\N{COMBINING DOT ABOVE}" if rate else _letter(base)
    letter = f"<i>{letter}</i>" if len(letter) <= 2 and (rate or len(letter) == 1) else letter
    return f"{letter}<sub>{escape(index.replace('_', ' '))}</sub>" if index else letter


def unit(text: str) -> str:
    """Return a unit with its exponents raised.

    Examples
    --------
    >>> unit("kg m^2"), unit("m/s")
    ('kg m<sup>2</sup>', 'm/s')
    """
    spaced = escape(text.replace("**", "^").replace("*", " "))
    return re.sub(r"\^\(?(-?[\d.]+)\)?", r"<sup>\1</sup>", spaced)


def axis_label(name: str, units: str) -> str:
    """Return the label of an axis, ``name [unit]``; without brackets where there is no unit."""
    return f"{symbol(name)} [{unit(units)}]" if units and units != "1" else symbol(name)


def plain(name: str) -> str:
    """Return a name as text, for where HTML has no subscripts.

    Examples
    --------
    >>> plain("delta_c"), plain("ddelta_c"), plain("period")
    ('δ_c', 'dδ_c', 'period')
    """
    base, _, index = name.partition("_")
    rate = base[:1] == "d" and base[1:] in _GREEK
    letter = f"d{_GREEK[base[1:]]}" if rate else _GREEK.get(base, base)
    return f"{letter}_{index}" if index else letter


def _letter(base: str) -> str:
    return _GREEK.get(base) or escape(base)
