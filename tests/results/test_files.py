from dataclasses import replace

import h5py
import numpy as np
import pytest
import xarray as xr

from racs_bif.errors import FileError
from racs_bif.results import files
from racs_bif.results.diagram import Diagram
from racs_bif.results.files import load, save


def test_a_branch_comes_back_bit_for_bit(branch, tmp_path):
    back = load(save(branch, tmp_path / "eq.nc"))
    assert back == branch
    assert back["H1"].origin is None


def test_a_diagram_comes_back_bit_for_bit(diagram, tmp_path):
    back = load(save(diagram, tmp_path / "all.nc"))
    assert isinstance(back, Diagram)
    assert back == diagram


def test_every_bit_of_awkward_numbers_is_kept(branch, tmp_path):
    states = branch.states.copy()
    states[:6, 0] = [np.nan, -np.nan, np.inf, -0.0, 5e-324, np.nextafter(1, 2)]
    odd = replace(branch, states=states, spectrum=branch.spectrum * np.nan, stopped="")
    back = load(save(odd, tmp_path / "odd.nc"))
    assert back == odd
    assert back.states.tobytes() == odd.states.tobytes()


def test_a_branch_without_anything_special_comes_back(branch, tmp_path):
    system = replace(
        branch.system, realisation=None, notes=(), units={}, states=("v",), parameters={}
    )
    bare = replace(branch, special=(), state_names=(), states=np.empty((0, 0)), system=system)
    assert load(save(bare, tmp_path / "bare.nc")) == bare


def test_names_that_collide_with_columns_of_ours_come_back(branch, tmp_path):
    odd = replace(branch, state_names=("label", "point", "max delta"), parameters=("stable",))
    back = load(save(odd, tmp_path / "odd.nc"))
    assert back == odd


def test_the_file_opens_in_xarray_with_units(diagram, tmp_path):
    path = save(diagram, tmp_path / "all.nc")
    with xr.open_dataset(path, group="EQ1", engine="h5netcdf") as data:
        assert data["delta_c"].attrs["units"] == "rad"
        assert data["u"].attrs["units"] == "m/s"
        assert data["eigenvalues"].dims == ("point", "root", "re_im")
        np.testing.assert_array_equal(data["v"], diagram["EQ1"].column("v"))
    with xr.open_dataset(path, group="PO1", engine="h5netcdf") as data:
        assert data["max_delta_c"].attrs["long_name"] == "max delta_c"
        assert data["period"].attrs["units"] == "s"
        assert "multipliers" in data
    with xr.open_dataset(path, group="PO1/profiles/NS1", engine="h5netcdf") as data:
        assert data["states"].dims == ("time", "state")
        assert list(data["states"].attrs["units"]) == ["m/s", "rad"]


def _tampered(path, change):
    with h5py.File(path, "r+") as file:
        change(file)
    return path


@pytest.mark.parametrize(
    "change",
    [
        lambda f: f["EQ1/delta_c"].write_direct(np.nextafter(f["EQ1/delta_c"][...], 1)),
        lambda f: f["EQ1"].attrs.__setitem__("stopped", "all is well"),
        lambda f: f["EQ1/system"].attrs.__setitem__("variant", "lagrange"),
        lambda f: f["EQ1/system/parameter_value"].write_direct(np.ones(3)),
        lambda f: f["EQ1/delta_c"].attrs.__setitem__("units", "deg"),
        lambda f: f["EQ1/special_points"].__delitem__("H1"),
    ],
    ids=["number", "reason", "variant", "parameter", "unit", "point"],
)
def test_a_file_that_was_changed_is_refused(branch, tmp_path, change):
    path = _tampered(save(branch, tmp_path / "eq.nc"), change)
    with pytest.raises(FileError, match="checksum is wrong"):
        load(path)


def test_a_newer_format_is_refused_before_anything_else(branch, tmp_path):
    path = save(branch, tmp_path / "eq.nc")
    _tampered(path, lambda f: f.attrs.__setitem__("format", np.int64(files.FORMAT + 1)))
    with pytest.raises(FileError, match="file format 2, this racs_bif reads up to 1; update"):
        load(path)


@pytest.mark.parametrize("kept", [0, 10, 100, 0.3, 0.7, 0.99])
def test_a_truncated_file_is_refused(branch, tmp_path, kept):
    path = save(branch, tmp_path / "eq.nc")
    whole = path.read_bytes()
    path.write_bytes(whole[: kept if isinstance(kept, int) else int(kept * len(whole))])
    with pytest.raises(FileError, match="damaged, incomplete or not netCDF-4"):
        load(path)


def test_flipped_bytes_never_give_a_result(branch, tmp_path):
    path = save(branch, tmp_path / "eq.nc")
    whole = path.read_bytes()
    rng = np.random.default_rng(0)
    changed = 0
    for place in rng.integers(0, len(whole), 40):
        broken = bytearray(whole)
        broken[place] ^= 0x55
        path.write_bytes(broken)
        try:
            assert load(path) == branch  # a byte that nobody reads
        except FileError:
            changed += 1
    assert changed > 0


@pytest.mark.parametrize("text", ["", "not a file of ours"])
def test_other_files_are_refused(tmp_path, text):
    path = tmp_path / "other.nc"
    path.write_text(text)
    with pytest.raises(FileError, match="not netCDF-4"):
        load(path)


def test_netcdf_files_of_others_are_refused(tmp_path):
    path = tmp_path / "other.nc"
    xr.Dataset({"a": ("x", [1.0, 2.0])}).to_netcdf(path, engine="h5netcdf")
    with pytest.raises(FileError, match="was not saved by racs_bif"):
        load(path)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(FileError, match=r"no file .*nothing\.nc"):
        load(tmp_path / "nothing.nc")


def test_a_failing_disk_leaves_the_old_file(branch, tmp_path, monkeypatch):
    path = save(branch, tmp_path / "eq.nc")

    def half(part, _node):
        part.write_bytes(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(files, "write_tree", half)
    with pytest.raises(FileError, match="no space left on device"):
        save(replace(branch, name="EQ2"), path)
    assert load(path) == branch
    assert [p.name for p in tmp_path.iterdir()] == ["eq.nc"]


def test_saving_into_no_folder_says_so(branch, tmp_path):
    with pytest.raises(FileError, match="no such file or directory"):
        save(branch, tmp_path / "nowhere" / "eq.nc")


def test_arrays_of_every_kind_come_back_with_their_type(branch, tmp_path):
    data = {
        "whole": np.array([1, 2, 3], dtype=np.int32),
        "real": np.array([[1.5, np.nan]]),
        "flags": np.array([True, False]),
        "single": np.array([1.0], dtype=np.float32),
    }
    special = (replace(branch.special[0], data=data), *branch.special[1:])
    back = load(save(replace(branch, special=special), tmp_path / "kinds.nc"))
    for name, array in data.items():
        found = back["H1"].data[name]
        assert found.dtype == array.dtype
        np.testing.assert_array_equal(found, array)


def test_an_array_of_words_is_refused_by_name(branch, tmp_path):
    special = (
        replace(branch.special[0], data={"words": np.array(["a", "b"])}),
        *branch.special[1:],
    )
    with pytest.raises(TypeError, match="H1: 'words' holds <U1, a file takes numbers and words"):
        save(replace(branch, special=special), tmp_path / "words.nc")
    assert not (tmp_path / "words.nc").exists()
