import os
import subprocess
import sys

import pytest

from racs_bif import __version__
from racs_bif.cli import continue_

SLOW = ("numpy", "scipy", "sympy", "matplotlib", "rich", "control", "xarray", "h5netcdf")


def _one_line(err):
    return err.count("\n") == 1 and err.startswith("racs-bif: ") and "Traceback" not in err


@pytest.mark.parametrize("arguments", [["--help"], ["continue", "--help"], ["--version"]])
def test_help_imports_nothing_slow(arguments):
    code = (
        "import sys; from racs_bif.cli.main import main\n"
        f"status = main({arguments!r})\n"
        f"slow = [name for name in {SLOW!r} if name in sys.modules]\n"
        "sys.exit(f'{status} {slow}' if status or slow else 0)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout


def test_python_m_racs_bif_is_the_program():
    command = [sys.executable, "-m", "racs_bif", "--version"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout == f"racs-bif {__version__}\n"


@pytest.mark.parametrize("verb", ["continue", "calibrate", "models"])
def test_every_verb_has_help(cli, verb):
    told = cli(verb, "--help")
    assert told.status == 0
    assert f"racs-bif {verb}" in told.out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "which verb? There are: continue, "),
        (["contineu", "u", "5", "30"], "unknown verb 'contineu'; did you mean 'continue'?"),
        (["--verson"], "unknown option '--verson'; did you mean '--version'?"),
        (["continue", "u", "5"], "required: HIGH"),
        (["continue", "u", "5", "30", "40"], "unrecognized arguments: 40"),
        (["continue", "u", "30", "5"], "LOW must be below HIGH, here 30 and 5"),
        (["continue", "u", "5", "5"], "LOW must be below HIGH"),
        (["continue", "u", "nan", "30"], "LOW: 'nan' is not finite"),
        (["continue", "u", "5", "-inf"], "HIGH: '-inf' is not finite"),
        (["continue", "u", "5", "thirty"], "HIGH: 'thirty' is not a number"),
        (["continue", "u", "5", "30", "--at", "31"], "--at 31 is outside the span 5 to 30"),
        (["continue", "u", "5", "30", "--set", "c"], "'c' is not NAME=VALUE"),
        (["continue", "u", "5", "30", "--set", "c=much"], "c: 'much' is not a number"),
        (["continue", "u", "5", "30", "--modle", "racs"], "did you mean '--model'?"),
        (["continue", "u", "5", "30", "--orbits", "shoting"], "did you mean 'shooting'?"),
        (["continue", "u", "5", "30", "--sections", "0"], "'0' is not a whole number"),
        (["continue", "u", "5", "30", "--model", "rcas"], "did you mean 'racs'?"),
        (["continue", "u", "5", "30", "--model", "no.py"], "there is no file 'no.py'"),
        (["calibrate", "C_s"], "required: --hopf"),
        (["models", "--set", "c=1"], "--variant and --set need a model"),
    ],
)
def test_bad_input_is_one_line_and_status_2(cli, arguments, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    told = cli(*arguments)
    assert told.status == 2
    assert message in told.err
    assert _one_line(told.err)
    assert told.out == ""
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["continue", "mmu", "-1", "1"], "unknown parameter 'mmu'; did you mean 'mu'?"),
        (["continue", "mu", "-11", "1"], "leaves the model's validity, -10 < mu < 10"),
        (["continue", "mu", "-1", "1", "--variant", "spuer"], "did you mean 'super'?"),
        (["continue", "mu", "-1", "1", "--set", "kk=1"], "unknown parameter 'kk'"),
        (["continue", "mu", "-1", "1", "--set", "mu=1"], "--set mu contradicts following mu"),
        (["continue", "mu", "-1", "1", "--state", "z"], "unknown state 'z'; there are: x, y"),
        (["continue", "k", "-1", "1", "--set", "mu=10.5"], "mu"),
        (["continue", "mu", "-1", "1", "--band", "10", "1"], "band 10 .. 1 rad/s is not usable"),
        (["continue", "mu", "-1", "1", "--realisation", "x"], "unknown realisation 'x'"),
        (["calibrate", "k", "--hopf", "mu=0", "--span", "2", "1"], "LOW must be below HIGH"),
        (["calibrate", "q", "--hopf", "mu=0"], "unknown parameter 'q'"),
        (["calibrate", "k", "--hopf", "q=0"], "unknown parameter 'q'"),
        (["calibrate", "mu", "--hopf", "k=1", "--span", "-20", "1"], "leaves the model's validity"),
    ],
)
def test_bad_input_to_a_model_is_one_line_and_status_2(
    cli, normal_form, arguments, message, tmp_path
):
    out = ["--out", tmp_path / "out"] if arguments[0] == "continue" else []
    told = cli(*arguments, "--model", normal_form, *out)
    assert told.status == 2
    assert message in told.err
    assert _one_line(told.err)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "text",
    ["def model(:", "1 / 0", "import nothing_like_this", "x = 1", "def model():\n    return 1 / 0"],
)
def test_a_model_file_that_raises_is_one_line_and_status_2(cli, tmp_path, text):
    path = tmp_path / "broken.py"
    path.write_text(text)
    told = cli("continue", "u", "5", "30", "--model", path, "--out", tmp_path / "out")
    assert told.status == 2
    assert "broken.py" in told.err
    assert _one_line(told.err)
    assert not (tmp_path / "out").exists()


def test_an_unwritable_out_is_found_before_anything_is_computed(cli, computed, tmp_path):
    def never(*_a, **_k):
        raise AssertionError

    computed.equilibria = never
    (tmp_path / "file").write_text("")
    told = cli("continue", "u", "5", "30", "--out", tmp_path / "file" / "out")
    assert told.status == 2
    assert "cannot write" in told.err
    assert _one_line(told.err)
    assert [p.name for p in tmp_path.iterdir()] == ["file"]


def test_blas_is_told_to_use_one_thread_unless_the_user_says_otherwise(cli, monkeypatch):
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    cli("--version")
    assert os.environ["OPENBLAS_NUM_THREADS"] == "1"
    assert os.environ["OMP_NUM_THREADS"] == "3"


def test_a_mistake_of_ours_is_one_line_and_a_traceback_only_with_v(cli, monkeypatch):
    def broken(_):
        msg = "it broke"
        raise ZeroDivisionError(msg)

    monkeypatch.setattr(continue_, "open_system", broken)
    told = cli("continue", "u", "5", "30")
    assert told.status == 1
    assert _one_line(told.err)
    assert "internal error, ZeroDivisionError: it broke; please report it" in told.err
    assert "Traceback" in cli("continue", "u", "5", "30", "-v").err


def test_a_reader_that_goes_away_is_no_error(tmp_path):
    command = f"{sys.executable} -m racs_bif models | true"
    done = subprocess.run(command, shell=True, capture_output=True, text=True, check=False)
    assert done.stderr == ""
