"""Names of signals in python-control, as names that an expression can use."""

from __future__ import annotations

import keyword
import re


def plain_name(label: str) -> str:
    """Return a label as a name that an expression can use.

    Examples
    --------
    >>> plain_name("x[0]"), plain_name("yaw rate"), plain_name("lambda")
    ('x_0', 'yaw_rate', 'lambda_')
    """
    name = re.sub(r"\W+", "_", label).strip("_") or "system"
    if name[0].isdigit():
        name = f"_{name}"
    return f"{name}_" if keyword.iskeyword(name) else name
