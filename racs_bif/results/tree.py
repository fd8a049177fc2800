"""A tree of named numbers and words: what a file holds, its fingerprint, and netCDF-4 around it.

Everything that is saved passes through this form, so that the checksum covers what a reader of the
file gets and not the bytes that HDF5 happens to lay out.
"""

from __future__ import annotations

import hashlib
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from h5netcdf import File, Group
    from numpy.typing import NDArray

Attribute = bool | str | int | float | tuple[str, ...] | tuple[float, ...]
"""Words and numbers beside the data; a tuple has at least one."""
COMPLEX = "re_im"
"""Trailing dimension of complex numbers: real part, imaginary part."""


@dataclass
class Variable:
    """An array with named dimensions: float64, int64, int8, or object holding str."""

    dimensions: tuple[str, ...]
    data: NDArray[np.generic] | NDArray[np.object_]
    attributes: dict[str, Attribute] = field(default_factory=dict)


@dataclass
class Node:
    """A group: attributes, variables, groups."""

    attributes: dict[str, Attribute] = field(default_factory=dict)
    variables: dict[str, Variable] = field(default_factory=dict)
    groups: dict[str, Node] = field(default_factory=dict)


def complex_variable(
    dimensions: tuple[str, ...],
    data: NDArray[np.complex128],
    attributes: Mapping[str, Attribute] | None = None,
) -> Variable:
    """Return complex numbers as a variable with a trailing dimension of two."""
    parts = np.ascontiguousarray(data, dtype=complex).view(float).reshape(*data.shape, 2)
    return Variable((*dimensions, COMPLEX), parts, dict(attributes or {}))


def complex_array(variable: Variable) -> NDArray[np.complex128]:
    """Return the complex numbers of such a variable."""
    parts = np.ascontiguousarray(variable.data, dtype=float)
    shape = parts.shape[:-1]
    numbers: NDArray[np.complex128] = parts.reshape(-1).view(complex).reshape(shape)
    return numbers


def words_variable(dimension: str, texts: tuple[str, ...]) -> Variable:
    """Return words as a variable."""
    return Variable((dimension,), np.array(texts, dtype=object))


def words(value: Attribute | None) -> tuple[str, ...]:
    """Return words kept as an attribute: netCDF does not tell one word from a list of one."""
    if value is None:
        return ()
    return tuple(map(str, value)) if isinstance(value, tuple) else (str(value),)


def numbers(value: Attribute | None) -> tuple[float, ...]:
    """Return numbers kept as an attribute, one or several."""
    if value is None:
        return ()
    return tuple(map(float, value)) if isinstance(value, tuple) else (float(value),)


def real_array(variable: Variable) -> NDArray[np.float64]:
    """Return the real numbers of a variable."""
    return np.asarray(variable.data, dtype=float)


def words_array(variable: Variable) -> tuple[str, ...]:
    """Return the words of such a variable."""
    return tuple(str(word) for word in variable.data)


def fingerprint(node: Node) -> str:
    """Return the SHA-256 of all names, attributes, shapes and bits of a tree."""
    digest = hashlib.sha256()
    for piece in _pieces(node, ""):
        digest.update(len(piece).to_bytes(8, "little"))
        digest.update(piece)
    return digest.hexdigest()


def write_tree(path: Path, node: Node) -> None:
    """Write a tree as a netCDF-4 file."""
    import h5netcdf

    with h5netcdf.File(path, "w") as file:
        _write(file, node)


def read_tree(path: Path) -> Node:
    """Read a netCDF-4 file as a tree.

    Raises
    ------
    OSError
        If it is none, or not complete.
    """
    import h5netcdf

    class Readable(h5netcdf.File):  # type: ignore[misc]  # h5netcdf brings no types
        """A file that closes quietly: one that is damaged raises once, when it is opened."""

        def close(self) -> None:
            with suppress(AttributeError, RuntimeError, KeyError, ValueError, OSError, TypeError):
                super().close()

        __del__ = close

    with Readable(path, "r") as file:
        return _read(file)


def _pieces(node: Node, path: str) -> Iterator[bytes]:
    yield from _attribute_pieces(node.attributes, path)
    for name, variable in sorted(node.variables.items()):
        yield f"{path}/{name}:{variable.dimensions}{variable.data.shape}".encode()
        if variable.data.dtype == object:
            yield repr(words_array(variable)).encode()
        else:
            yield variable.data.dtype.str.encode()
            yield np.ascontiguousarray(variable.data).tobytes()
        yield from _attribute_pieces(variable.attributes, f"{path}/{name}")
    for name, group in sorted(node.groups.items()):
        yield f"{path}/{name}/".encode()
        yield from _pieces(group, f"{path}/{name}")


def _attribute_pieces(attributes: Mapping[str, Attribute], path: str) -> Iterator[bytes]:
    for name, value in sorted(attributes.items()):
        several = value if isinstance(value, tuple) else (value,)
        text = [v.hex() if isinstance(v, float) else repr(v) for v in several]
        yield f"{path}@{name}={text}".encode()


def _write(group: File | Group, node: Node) -> None:
    import h5py

    for name, value in node.attributes.items():
        group.attrs[name] = _stored(value)
    for name, variable in node.variables.items():
        sizes = zip(variable.dimensions, variable.data.shape, strict=True)
        group.dimensions.update({d: n for d, n in sizes if d not in group.dimensions})
        is_text = variable.data.dtype == object
        dtype = h5py.string_dtype() if is_text else variable.data.dtype
        stored = group.create_variable(name, variable.dimensions, dtype=dtype)
        if variable.data.size:
            stored[...] = variable.data
        for key, value in variable.attributes.items():
            stored.attrs[key] = _stored(value)
    for name, child in node.groups.items():
        _write(group.create_group(name), child)


def _read(group: File | Group) -> Node:
    node = Node(attributes={k: _attribute(v) for k, v in group.attrs.items()})
    for name, stored in group.variables.items():
        data = np.asarray(stored[...])
        if data.dtype == object:
            data = np.array([word.decode() for word in data], dtype=object)
        attributes = {k: _attribute(v) for k, v in stored.attrs.items()}
        node.variables[name] = Variable(tuple(stored.dimensions), data, attributes)
    node.groups = {name: _read(child) for name, child in group.groups.items()}
    return node


def _stored(value: Attribute) -> object:
    if isinstance(value, tuple):
        return list(value) if isinstance(value[0], str) else np.array(value, dtype=float)
    if isinstance(value, bool):
        return np.int8(value)
    if isinstance(value, str):
        return value
    return np.int64(value) if isinstance(value, int) else np.float64(value)


def _attribute(value: object) -> Attribute:
    """Return an attribute as it was before it was stored, but for tuples of one."""
    if isinstance(value, np.ndarray) and value.size == 1:
        value = value.reshape(-1)[0]
    if isinstance(value, np.ndarray | list | tuple):
        several = list(value)
        if any(isinstance(one, str) for one in several):
            return tuple(map(str, several))
        return tuple(map(float, several))
    if isinstance(value, np.int8):
        return bool(value)
    if isinstance(value, np.integer | int):
        return int(value)
    return float(value) if isinstance(value, np.floating | float) else str(value)
