"""Files of every format so far load, with what is known to be in them.

``corpus/make.py`` wrote them; files of older formats stay as they are.
"""

import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import FileError
from racs_bif.results import files

CORPUS = Path(__file__).parent / "corpus"
KINDS = {
    "branch": rb.Branch,
    "diagram": rb.Diagram,
    "curve": rb.Branch,
    "orbit": rb.Branch,
    "chart": rb.Chart,
    "history": rb.TimeHistory,
}
FILES = sorted(CORPUS.glob("format*.nc"))


def _name(path):
    return path.stem


def _kind(path):
    return path.stem.split("_")[1]


def _format(path):
    return int(path.stem.split("_")[0].removeprefix("format"))


def _checksum(path):
    with h5py.File(path) as file:
        return file.attrs["sha256"]


def test_there_is_a_file_of_each_kind_in_each_format():
    wanted = {(n, kind) for n in range(1, files.FORMAT + 1) for kind in KINDS}
    assert {(_format(path), _kind(path)) for path in FILES} == wanted
    assert all(path.stat().st_size < 50_000 for path in FILES)


@pytest.mark.parametrize("path", FILES, ids=_name)
def test_a_stored_file_loads(path, tmp_path):
    result = rb.load(path)
    assert type(result) is KINDS[_kind(path)]
    again = rb.save(result, tmp_path / "again.nc")
    assert rb.load(again) == result
    if _format(path) == files.FORMAT:  # bit for bit, names and attributes too
        assert _checksum(again) == _checksum(path)


def test_what_is_in_the_files_of_format_1():
    branch, diagram, curve, orbit, chart, history = (
        rb.load(CORPUS / f"format1_{kind}.nc") for kind in KINDS
    )
    # exact, Wang and Li: 1 + A^2 + 2 A cos(alpha pi/2) with A = 1, alpha = 0.9
    hopf = branch["H1"].exact
    assert hopf.parameters["B"] == pytest.approx(2.0 + 2.0 * np.cos(0.45 * np.pi), rel=1e-8)
    assert hopf.omega == pytest.approx(1.0, rel=1e-8)
    assert (branch.system.model, branch.kind) == ("fractional_brusselator", "equilibrium")
    # exact: a Hopf point at B = 1 + A^2 with omega = A
    assert diagram["EQ1"]["H1"].parameters["B"] == pytest.approx(2.0, rel=1e-8)
    assert [b.kind for b in diagram] == ["equilibrium", "orbit"]
    assert orbit["UZ1"].parameters == {"B": pytest.approx(2.01, rel=1e-12)}
    assert orbit.column("period")[0] == pytest.approx(2 * np.pi, rel=1e-8)
    assert set(orbit.profiles) == {"UZ1"}
    assert (curve.kind, curve.parameters) == ("curve", ("B", "A"))
    B, A = curve.values.T
    np.testing.assert_allclose(B, 1 + A**2 + 2 * A * np.cos(0.45 * np.pi), rtol=1e-2)
    assert sorted(region.unstable for region in chart.regions) == [0, 2]
    assert chart.map.unstable.shape == (3, 2)
    assert history.times[-1] == 0.5
    assert set(history.errors) >= {"x", "y"}


@pytest.mark.parametrize("path", FILES, ids=_name)
@pytest.mark.parametrize("share", [0.0, 0.2, 0.6, 0.95, 0.999])
def test_a_truncated_file_of_any_kind_is_refused(path, share, tmp_path):
    whole = path.read_bytes()
    broken = tmp_path / "broken.nc"
    broken.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(
        FileError, match=r"broken\.nc' cannot be read: .*; compute it again"
    ) as told:
        rb.load(broken)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize("path", FILES, ids=_name)
def test_a_changed_number_of_any_kind_is_refused(path, tmp_path):
    """One bit of one number in the largest array."""
    changed = tmp_path / "changed.nc"
    shutil.copy(path, changed)
    with h5py.File(changed, "r+") as file:
        arrays = []
        file.visititems(lambda _, item: arrays.append(item) if _real(item) else None)
        largest = max(arrays, key=lambda item: item.size)
        numbers = largest[...]
        numbers.reshape(-1).view(np.uint64)[0] ^= 1
        largest[...] = numbers
    with pytest.raises(FileError, match=r"changed\.nc' was changed .* compute it again"):
        rb.load(changed)


def _real(item):
    return isinstance(item, h5py.Dataset) and item.dtype == np.float64 and item.size


@pytest.mark.parametrize("path", FILES, ids=_name)
def test_a_newer_file_of_any_kind_is_refused(path, tmp_path):
    newer = tmp_path / "newer.nc"
    shutil.copy(path, newer)
    with h5py.File(newer, "r+") as file:
        file.attrs["format"] = np.int64(files.FORMAT + 1)
    with pytest.raises(FileError, match=rf"newer\.nc' has file format {files.FORMAT + 1}.*update"):
        rb.load(newer)


@pytest.mark.parametrize("content", ["branch", "history", "chart", "sermon"])
def test_a_right_checksum_over_the_wrong_things_is_refused(content, tmp_path):
    path = tmp_path / "forged.nc"
    node = files.Node({"format": files.FORMAT, "content": content, "branches": "EQ1"})
    node.attributes["sha256"] = files.fingerprint(node)
    files.write_tree(path, node)
    with pytest.raises(FileError, match=r"forged\.nc' lacks what its kind of result has"):
        rb.load(path)
