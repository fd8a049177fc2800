"""Equality of results: the same numbers bit by bit, NaN equal to NaN."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass

import numpy as np


def same(one: object, other: object) -> bool:
    """Tell whether two results hold the same: types, shapes and every bit of every number.

    Fields of dataclasses that are declared with ``compare=False`` are passed over.
    """
    if type(one) is not type(other):
        return False
    if is_dataclass(one):
        names = [f.name for f in fields(one) if f.compare]
        return all(same(getattr(one, name), getattr(other, name)) for name in names)
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
    if isinstance(one, tuple | list) and isinstance(other, tuple | list):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, np.ndarray | float | complex):
        return _bits(one) == _bits(other)
    return bool(one == other)


def _bits(value: object) -> tuple[str, tuple[int, ...], bytes]:
    array = np.asarray(value)
    return array.dtype.str, array.shape, array.tobytes()
