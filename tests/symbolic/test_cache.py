"""The cache is trusted when it is whole, rebuilt when it is not, and never needed."""

import errno
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from racs_bif.symbolic import cache, compiled
from racs_bif.symbolic.compiled import compile_model
from racs_bif.symbolic.strings import model_from_strings

ROOT = Path(__file__).parents[2]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty cache."""
    chosen = tmp_path / "cache"
    monkeypatch.setenv("RACS_BIF_CACHE", str(chosen))
    return chosen


@pytest.fixture
def builds(monkeypatch):
    """Count how often a model is really generated."""
    calls = []
    generate = compiled.generate
    monkeypatch.setattr(compiled, "generate", lambda model: calls.append(model) or generate(model))
    return calls


def decay(rate="-k*x", k=2.0):
    return model_from_strings("decay", {"x": rate}, parameters={"k": k})


def value(core, x=3.0, k=2.0):
    return core.core(np.array([x]), np.array([k]))[0]


def entries(folder):
    return sorted(p for p in folder.iterdir() if not p.name.startswith("."))


def test_a_second_compilation_is_read(folder, builds):
    first, second = compile_model(decay()), compile_model(decay())
    assert len(builds) == 1
    assert first.digest == second.digest
    assert value(second) == -6.0
    assert len(entries(folder)) == 2
    assert len(list(folder.iterdir())) == 2  # nothing half-written lies about


@pytest.mark.parametrize(
    "spoil",
    [
        lambda data: b"",
        lambda data: data[: len(data) // 2],
        lambda data: data[:-1],
        lambda data: data + b" ",
        lambda data: data.replace(b"*", b"+", 1),
        lambda data: b"\xff\xfe" + data,
        lambda data: data.partition(b"\n")[2],
        lambda data: b"# sha256 0\nraise SystemExit\n",
        lambda data: os.urandom(4000),
    ],
    ids=["empty", "half", "short", "long", "changed", "bytes", "headless", "forged", "noise"],
)
@pytest.mark.parametrize("which", [0, 1])
def test_a_damaged_entry_is_rebuilt(folder, builds, spoil, which):
    whole = compile_model(decay()).digest
    path = entries(folder)[which]
    data = path.read_bytes()
    path.write_bytes(spoil(data))
    again = compile_model(decay())
    assert len(builds) == 2
    assert again.digest == whole
    assert value(again) == -6.0
    assert again.core_xx(np.ones(1), np.ones(1), np.ones(1), np.ones(1)) == 0.0
    assert path.read_bytes() == data


def test_a_missing_half_is_rebuilt(folder, builds):
    compile_model(decay())
    entries(folder)[0].unlink()
    compile_model(decay())
    assert len(builds) == 2


def test_equal_names_do_not_share(folder):
    assert value(compile_model(decay("-k*x"))) == -6.0
    assert value(compile_model(decay("-k*x**2"))) == -18.0
    assert value(compile_model(decay("-k*x"))) == -6.0
    assert len(entries(folder)) == 4


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ({"parameters": {"k": 1.0}}, {"parameters": {"k": 2.0}}),
        ({"guess": {"x": 1.0}}, {"guess": {"x": 2.0}}),
        ({"outputs": {"o": "x"}}, {"outputs": {"o": "2*x"}}),
        ({"elements": [("w", "x", "s**0.5")]}, {"elements": [("w", "x", "s**0.6")]}),
        ({"elements": [("w", "x", "s**0.5")]}, {"elements": [("w", "2*x", "s**0.5")]}),
    ],
)
def test_whatever_differs_is_another_entry(folder, builds, first, second):
    for options in (first, second, first):
        parts = {"parameters": {"k": 1.0}} | options
        compile_model(model_from_strings("decay", {"x": "-k*x"}, **parts))
    assert len(builds) == 2


def test_names_that_join_alike_do_not_share(folder):
    assert cache.key("ab", "c") != cache.key("a", "bc")
    assert cache.key("a", "") != cache.key("a")


def test_the_key_depends_on_the_generator(monkeypatch):
    before = cache.key("a")
    monkeypatch.setattr(cache, "generator", lambda: "another version")
    assert cache.key("a") != before


@pytest.mark.parametrize("kind", ["below a file", "a file"])
def test_a_folder_that_cannot_be_made_costs_speed_only(tmp_path, monkeypatch, builds, kind):
    blocker = tmp_path / "file"
    blocker.write_text("not a folder")
    chosen = blocker / "cache" if kind == "below a file" else blocker
    monkeypatch.setenv("RACS_BIF_CACHE", str(chosen))
    for _ in range(2):
        assert value(compile_model(decay())) == -6.0
    assert len(builds) == 2
    assert blocker.read_text() == "not a folder"


def test_no_home_folder_costs_speed_only(monkeypatch):
    def nowhere():
        msg = "Could not determine home directory."
        raise RuntimeError(msg)

    for name in ("RACS_BIF_CACHE", "XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(Path, "home", nowhere)
    assert cache.read("anything") is None
    cache.write("anything", "text")
    assert value(compile_model(decay())) == -6.0


def test_folder_follows_the_environment(tmp_path, monkeypatch):
    monkeypatch.setenv("RACS_BIF_CACHE", str(tmp_path))
    assert cache.folder() == tmp_path
    monkeypatch.delenv("RACS_BIF_CACHE")
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert cache.folder() == tmp_path / "xdg" / "racs_bif"
    monkeypatch.setattr(sys, "platform", "win32")
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path / "local"))
    assert cache.folder() == tmp_path / "local" / "racs_bif"


WRITER = """
import sys
import time
from racs_bif.symbolic import cache
body = sys.argv[1] * 100_000
for _ in range(150):
    cache.write("entry", body)
"""


def test_two_processes_writing_at_once(folder):
    """A reader meets one text or the other, whole, and at every moment one of them."""
    cache.write("entry", "a" * 100_000)
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    writers = [
        subprocess.Popen([sys.executable, "-c", WRITER, letter], env=environment) for letter in "ab"
    ]
    bodies = {"a" * 100_000, "b" * 100_000}
    met = set()
    while any(w.poll() is None for w in writers):
        met.add(cache.read("entry"))
    assert [w.returncode for w in writers] == [0, 0]
    assert met <= bodies
    assert cache.read("entry") in bodies
    assert [p.name for p in folder.iterdir()] == ["entry"]


PRINTER = """
import sympy as sp
from racs_bif.symbolic.compiled import compile_model
from racs_bif.symbolic.model import FractionalElement, Model, Parameter
x, y, a, b, s = sp.symbols("x y a b s")
law = (1 + (b*s)**a + s**(a/2))/(a + s**b + s*b)
x_dot = sp.Max(x, y, a) + sp.Piecewise((x*y, sp.And(x > 0, y > 0, a > b)), (b, True)) - a*b*x*y
model = Model("seed", {"x": x_dot, "y": sp.Min(y, b, x)}, (Parameter("a", .5), Parameter("b", .7)),
              elements=(FractionalElement("w", x + y, law),))
print(compile_model(model).digest)
"""


def test_the_text_does_not_depend_on_the_hash_seed(folder):
    """Otherwise what is stored under the model's text would change from run to run."""
    digests = set()
    for seed in "12":
        environment = os.environ | {
            "PYTHONPATH": str(ROOT),
            "PYTHONHASHSEED": seed,
            "RACS_BIF_CACHE": str(folder / seed),
        }
        done = subprocess.run(
            [sys.executable, "-c", PRINTER],
            env=environment, capture_output=True, text=True, check=True,
        )  # fmt: skip
        digests.add(done.stdout)
    assert len(digests) == 1


@pytest.mark.parametrize("where", ["mkstemp", "fdopen", "replace", "mkdir"])
@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EROFS, errno.EACCES, errno.EDQUOT])
def test_a_full_disk_or_read_only_home_costs_speed_only(folder, builds, monkeypatch, where, number):
    def fail(*_args, **_kwargs):
        raise OSError(number, os.strerror(number))

    if where != "mkdir":
        folder.mkdir()
    home = {"mkstemp": cache.tempfile, "fdopen": os, "replace": os, "mkdir": Path}[where]
    with monkeypatch.context() as patch:
        patch.setattr(home, where, fail)
        for _ in range(2):
            assert value(compile_model(decay())) == -6.0
    assert len(builds) == 2
    assert not folder.exists() or list(folder.iterdir()) == []
    for _ in range(2):  # and when there is room again, it is used
        assert value(compile_model(decay())) == -6.0
    assert len(builds) == 3


def test_a_disk_that_fills_up_in_the_middle_of_an_entry(folder):
    """The kernel itself refuses the rest: what was there stays, and nothing lies about."""
    cache.write("entry", "old")
    script = """
import resource
from racs_bif.symbolic import cache
resource.setrlimit(resource.RLIMIT_FSIZE, (5000, 5000))
cache.write("entry", "new" * 100_000)
cache.write("small", "fits")
"""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    subprocess.run([sys.executable, "-c", script], env=environment, check=True)
    assert cache.read("entry") == "old"
    assert cache.read("small") == "fits"
    assert sorted(p.name for p in folder.iterdir()) == ["entry", "small"]


def test_an_interrupted_writer_leaves_nothing(folder, monkeypatch):
    def interrupt(*_args):
        raise KeyboardInterrupt

    cache.write("entry", "old")
    monkeypatch.setattr(os, "replace", interrupt)
    with pytest.raises(KeyboardInterrupt):
        cache.write("entry", "new")
    assert cache.read("entry") == "old"
    assert [p.name for p in folder.iterdir()] == ["entry"]


def test_a_killed_writer_leaves_whole_entries(folder):
    """What it was writing lies about, does no harm, and is swept away when it is old."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    endless = WRITER.replace("range(150)", "iter(int, 1)")
    bodies = {letter * 100_000 for letter in "ab"}
    for letter, pause in (("a", 0.0), ("b", 0.013), ("a", 0.029)):
        before = cache.read("entry")
        writer = subprocess.Popen([sys.executable, "-c", endless, letter], env=environment)
        while cache.read("entry") in (None, before) and writer.poll() is None:
            time.sleep(0.001)
        time.sleep(pause)
        writer.kill()
        writer.wait()
        assert cache.read("entry") in bodies
    for k, age in enumerate((0.0, 7200.0)):
        left = folder / f".writing-{k}"
        left.write_text("half")
        os.utime(left, (time.time() - age,) * 2)
    assert value(compile_model(decay())) == -6.0
    assert (folder / ".writing-0").exists()  # another process may still be writing it
    assert not (folder / ".writing-1").exists()


COMPILER = """
import sys
import time
import numpy as np
from racs_bif.symbolic.compiled import compile_model
from racs_bif.symbolic.strings import model_from_strings
sys.stdin.readline()
model = model_from_strings("decay", {"x": "-k*x"}, parameters={"k": 2.0})
print(compile_model(model).core(np.array([3.0]), np.array([2.0]))[0])
"""


def test_two_processes_compiling_the_same_model_at_once(folder):
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    runs = [
        subprocess.Popen(
            [sys.executable, "-c", COMPILER],
            env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )
        for _ in range(2)
    ]  # fmt: skip
    for run in runs:
        run.stdin.write("\n")
        run.stdin.flush()
    told = [float(run.communicate()[0]) for run in runs]
    assert told == [-6.0, -6.0]
    assert len(list(folder.iterdir())) == 2


def test_the_folder_of_each_system(monkeypatch, tmp_path):
    monkeypatch.delenv("RACS_BIF_CACHE", raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setattr("sys.platform", "darwin")
    assert cache.folder() == tmp_path / "Library" / "Caches" / "racs_bif"
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    assert cache.folder() == tmp_path / ".cache" / "racs_bif"
