"""Names and units as they are set in print."""

from __future__ import annotations

import re
from typing import Final

_GREEK: Final = frozenset(
    [
        "alpha",
        "beta",
        "gamma",
        "delta",
        "epsilon",
        "zeta",
        "eta",
        "theta",
        "iota",
        "kappa",
        "lambda",
        "mu",
        "nu",
        "xi",
        "pi",
        "rho",
        "sigma",
        "tau",
        "upsilon",
        "phi",
        "chi",
        "psi",
        "omega",
        "Gamma",
        "Delta",
        "Theta",
        "Lambda",
        "Xi",
        "Pi",
        "Sigma",
        "Phi",
        "Psi",
        "Omega",
    ]
)


def symbol(name: str) -> str:
    r"""Return a name in mathtext: Greek letters as letters, the rest after ``_`` as a subscript.

    A ``d`` before a Greek letter is a time derivative.

    Examples
    --------
    >>> symbol("delta_c"), symbol("ddelta_c"), symbol("u"), symbol("yaw")
    ('$\\delta_{c}$', '$\\dot{\\delta}_{c}$', '$u$', '$\\mathrm{yaw}$')
    """
    base, _, index = name.partition("_")
    rate = base[:1] == "d" and base[1:] in _GREEK
    letter = _letter(base[1:] if rate else base)
    letter = rf"\dot{{{letter}}}" if rate else letter
    subscript = index.replace("_", r"\,")
    return f"${letter}_{{{subscript}}}$" if index else f"${letter}$"


def unit(text: str) -> str:
    """Return a unit with its exponents raised.

    Examples
    --------
    >>> unit("kg m^2"), unit("m/s")
    ('kg m$^{2}$', 'm/s')
    """
    spaced = text.replace("**", "^").replace("*", " ")
    return re.sub(r"\^\(?(-?[\d.]+)\)?", r"$^{\1}$", spaced)


def axis_label(name: str, units: str) -> str:
    """Return the label of an axis, ``name [unit]``; without brackets where there is no unit."""
    return f"{symbol(name)} [{unit(units)}]" if units and units != "1" else symbol(name)


def _letter(base: str) -> str:
    if base in _GREEK:
        return rf"\{base}"
    return base if len(base) == 1 else rf"\mathrm{{{base}}}"
