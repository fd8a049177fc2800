"""Results in netCDF-4 files: saved whole, loaded bit for bit, refused when they were changed.

A file has a group for each branch, which opens in xarray::

    xarray.open_dataset("branches.nc", group="EQ1", engine="h5netcdf")

with the parameters, states and measures as variables that know their units, eigenvalues or
multipliers with a trailing dimension ``re_im``, and beneath it groups with the system, the special
points and the profiles of orbits. A time history has the one group ``history``, a chart the group
``chart1`` and its slices one each, their boundaries, regions and maps beneath.
"""

from __future__ import annotations

from pathlib import Path

from racs_bif.errors import FileError
from racs_bif.results.atomic import write_atomically
from racs_bif.results.branch import Branch
from racs_bif.results.chart import Chart
from racs_bif.results.chart_slices import ChartSlices
from racs_bif.results.chart_tree import CHART, SLICES, decode_charts, encode_charts
from racs_bif.results.decode import decode_branch
from racs_bif.results.diagram import Diagram
from racs_bif.results.encode import encode_branch
from racs_bif.results.history import TimeHistory
from racs_bif.results.history_tree import GROUP, decode_history, encode_history
from racs_bif.results.tree import Attribute, Node, fingerprint, read_tree, words, write_tree

Result = Branch | Diagram | TimeHistory | Chart | ChartSlices
FORMAT = 1
"""Version of the layout; a reader refuses a newer one."""
_CHECKSUM = "sha256"


def save(result: Result, path: str | Path) -> Path:
    """Save a branch, a diagram, a time history or a chart as a netCDF-4 file.

    The file appears whole or not at all.

    Parameters
    ----------
    result : Branch, Diagram, TimeHistory, Chart or ChartSlices
        What to save.
    path : str or Path
        Where; an existing file is replaced.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    FileError
        If it cannot be written there.
    """
    path = Path(path)
    node = _encode(result)
    node.attributes[_CHECKSUM] = fingerprint(node)
    write_atomically(path, lambda part: write_tree(part, node))
    return path


def load(path: str | Path) -> Result:
    """Load what `save` saved, bit for bit.

    Parameters
    ----------
    path : str or Path
        The file.

    Returns
    -------
    Branch, Diagram, TimeHistory, Chart or ChartSlices
        Equal to what was saved. A branch that was saved alone comes back as one.

    Raises
    ------
    FileError
        If there is no such file, or it is not one of ours, is damaged or changed, or was written
        by a newer version.
    """
    path = Path(path)
    node = _read(path)
    version = node.attributes.get("format")
    if not isinstance(version, int) or _CHECKSUM not in node.attributes:
        msg = f"'{path}' was not saved by racs_bif; load files written by save()"
        raise FileError(msg)
    if version > FORMAT:
        msg = (
            f"'{path}' has file format {version}, this racs_bif reads up to {FORMAT}; "
            "update racs_bif"
        )
        raise FileError(msg)
    checksum = node.attributes.pop(_CHECKSUM)
    if checksum != fingerprint(node):
        msg = f"'{path}' was changed after it was saved: its checksum is wrong; compute it again"
        raise FileError(msg)
    try:
        return _decode(node)
    except (KeyError, ValueError, TypeError, IndexError, AttributeError) as error:
        msg = (
            f"'{path}' lacks what its kind of result has: {error}; it was not saved by save(), "
            "compute it again"
        )
        raise FileError(" ".join(msg.split())) from error


def _decode(node: Node) -> Result:
    if node.attributes["content"] == GROUP:
        return decode_history(node.groups[GROUP])
    if node.attributes["content"] in {CHART, SLICES}:
        return decode_charts(node)
    branches = [decode_branch(node.groups[n]) for n in words(node.attributes["branches"])]
    return branches[0] if node.attributes["content"] == "branch" else Diagram(*branches)


def _encode(result: Result) -> Node:
    if isinstance(result, TimeHistory):
        return _encode_history(result)
    if isinstance(result, Chart | ChartSlices):
        charts = result.charts if isinstance(result, ChartSlices) else (result,)
        node = encode_charts(result)
        node.attributes |= _about(charts[0].system.version)
        return node
    return _encode_branches(result)


def _encode_branches(result: Branch | Diagram) -> Node:
    branches = (result,) if isinstance(result, Branch) else result.branches
    node = Node(
        attributes=_about(branches[0].system.version),
        groups={branch.name: encode_branch(branch) for branch in branches},
    )
    node.attributes["content"] = "branch" if isinstance(result, Branch) else "diagram"
    node.attributes["branches"] = tuple(branch.name for branch in branches)
    return node


def _encode_history(history: TimeHistory) -> Node:
    attributes = _about(history.system.version) | {"content": GROUP}
    return Node(attributes=attributes, groups={GROUP: encode_history(history)})


def _about(version: str) -> dict[str, Attribute]:
    return {
        "Conventions": "CF-1.11",
        "source": f"racs_bif {version}".strip(),
        "format": FORMAT,
    }


def _read(path: Path) -> Node:
    if not path.exists():
        msg = f"there is no file '{path}'; check its name and folder"
        raise FileError(msg)
    try:
        return read_tree(path)
    # h5py raises these, whichever it runs into first, for a file that is not HDF5 or lacks a part.
    except (OSError, RuntimeError, KeyError, ValueError, AttributeError, TypeError) as error:
        msg = (
            f"'{path}' cannot be read: it is damaged, incomplete or not netCDF-4 ({error}); "
            "compute it again"
        )
        raise FileError(" ".join(msg.split())) from error
