import os
import time

import pytest

from racs_bif.errors import FileError
from racs_bif.results.atomic import check_writable, staged, write_atomically, write_text


def _everything(folder):
    return sorted(str(p.relative_to(folder)) for p in folder.rglob("*"))


def test_files_appear_together(tmp_path):
    out = tmp_path / "deep" / "out"
    with staged(out) as folder:
        write_text(folder / "a.txt", "a")
        write_text(folder / "b.txt", "b")
        assert not (out / "a.txt").exists()
    assert _everything(out) == ["a.txt", "b.txt"]
    assert (out / "a.txt").read_text() == "a"


def _write_and_fail(out, error):
    with staged(out) as folder:
        write_text(folder / "a.txt", "new")
        raise error


@pytest.mark.parametrize(
    "error", [OSError(28, "No space left"), ValueError("x"), KeyboardInterrupt]
)
def test_a_failing_writer_leaves_nothing(tmp_path, error):
    with pytest.raises((FileError, ValueError, KeyboardInterrupt)):
        _write_and_fail(tmp_path / "deep" / "out", error)
    assert _everything(tmp_path) == []


def test_a_full_disk_is_told_in_one_line(tmp_path):
    with pytest.raises(FileError, match="no space left; choose another place"):
        _write_and_fail(tmp_path, OSError(28, "No space left"))


def test_a_failing_writer_leaves_what_was_there(tmp_path):
    (tmp_path / "a.txt").write_text("old")
    with pytest.raises(ValueError, match="stop"):
        _write_and_fail(tmp_path, ValueError("stop"))
    assert (tmp_path / "a.txt").read_text() == "old"
    assert _everything(tmp_path) == ["a.txt"]


def test_a_single_file_is_replaced_whole(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")

    def half(part):
        part.write_text("ha")
        assert path.read_text() == "old"
        raise OSError(5, "Input/output error")

    with pytest.raises(FileError, match="input/output error"):
        write_atomically(path, half)
    assert path.read_text() == "old"
    assert _everything(tmp_path) == ["a.txt"]


def test_checking_leaves_no_trace(tmp_path):
    check_writable(tmp_path / "a" / "b", ("summary.json",))
    check_writable(tmp_path, ("summary.json",))
    assert _everything(tmp_path) == []


def test_a_file_in_the_way_is_found_before_computing(tmp_path):
    (tmp_path / "file").write_text("")
    for out in (tmp_path / "file", tmp_path / "file" / "out"):
        with pytest.raises(FileError, match=r"cannot write .*not a directory"):
            check_writable(out)
    (tmp_path / "summary.json").mkdir()
    with pytest.raises(FileError, match="a folder has that name"):
        check_writable(tmp_path, ("summary.json",))
    (tmp_path / "dangling").symlink_to(tmp_path / "gone")
    with pytest.raises(FileError, match="cannot write"):
        check_writable(tmp_path / "dangling")


@pytest.mark.parametrize("name", [".0123abcd.part", ".branches.0123abcd.part.nc"])
def test_what_a_killed_run_was_writing_is_swept_away_when_it_is_old(tmp_path, name):
    for age, folder in ((0.0, tmp_path / "new"), (7200.0, tmp_path / "old")):
        left = folder / name
        if name.endswith(".nc"):
            folder.mkdir()
            left.write_text("half")
        else:
            left.mkdir(parents=True)
            (left / "branches.nc").write_text("half")
        (folder / ".hidden.part").write_text("the user's")
        for path in folder.iterdir():
            os.utime(path, (time.time() - age,) * 2)
        write_text(folder / "a.txt", "a")
        with staged(folder) as stage:
            write_text(stage / "b.txt", "b")
    swept = [".hidden.part", "a.txt", "b.txt"]
    assert _everything(tmp_path / "old") == swept
    kept = sorted(p.name for p in (tmp_path / "new").iterdir())
    assert kept == sorted([name, *swept])  # another run may still be writing it
