"""Units that follow from a model's unit of time: of periods, rates and frequencies."""

from __future__ import annotations

from typing import Final

SECONDS: Final = "s"
_HERTZ: Final = {"s": "Hz", "ms": "kHz", "us": "MHz"}


def rate_unit(time: str) -> str:
    """Return the unit of growth rates; none where time has none.

    Examples
    --------
    >>> rate_unit("s"), rate_unit("ms"), rate_unit("")
    ('1/s', '1/ms', '')
    """
    return f"1/{time}" if time else ""


def frequency_unit(time: str) -> str:
    """Return the unit of angular frequencies; none where time has none.

    Examples
    --------
    >>> frequency_unit("s"), frequency_unit("ms"), frequency_unit("")
    ('rad/s', 'rad/ms', '')
    """
    return f"rad/{time}" if time else ""


def cycles_unit(time: str) -> str:
    """Return the unit of numbers of periods in a time; none where time has none.

    Examples
    --------
    >>> cycles_unit("s"), cycles_unit("ms"), cycles_unit("d"), cycles_unit("")
    ('Hz', 'kHz', '1/d', '')
    """
    return _HERTZ.get(time, rate_unit(time))


def after(unit: str) -> str:
    """Return what stands behind a number: a blank and the unit; nothing where there is none.

    Examples
    --------
    >>> after("rad/s"), after("")
    (' rad/s', '')
    """
    return f" {unit}" if unit else ""
