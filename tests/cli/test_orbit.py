"""The verbs `orbit` and `plot`, and what `continue` says of further branches."""

import json

import pytest

import racs_bif as rb

MODEL = '''"""The adaptive control system: its cycles double their period."""

import sympy as sp

from racs_bif import Model, Parameter


def model():
    x, y, z, al, be = sp.symbols("x y z al be")
    return Model(
        name="adaptive",
        equations={"x": y, "y": z, "z": -al * z - be * y - x + x**2},
        parameters=(Parameter("al", 1.2), Parameter("be", 1.0)),
        guess={"x": 0.0, "y": 0.0, "z": 0.0},
    )
'''


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("model") / "adaptive.py"
    path.write_text(MODEL)
    return path


@pytest.fixture
def out(tmp_path):
    return tmp_path / "out"


def test_one_orbit_is_told_and_written(cli, file, out):
    told = cli("orbit", "--model", file, "--set", "al=0.9", "--out", out)
    assert (told.status, told.err) == (0, "")
    assert "Orbit at al = 0.9 by collocation: period 6.306235" in told.out
    assert "Followed from H1 at al = 1." in told.out
    lines = [line for line in told.out.splitlines() if not line.startswith("Wrote")]
    assert max(map(len, lines)) <= 80
    names = sorted(path.name for path in out.iterdir())
    assert names == ["orbit.nc", "orbit.png", "orbit.svg", "summary.json"]
    (orbit,) = json.loads((out / "summary.json").read_text())["orbits"]
    assert orbit["period"] == pytest.approx(6.306235, abs=1e-6)
    assert orbit["stable"] is True
    assert orbit["label"] == "UZ"
    assert len(orbit["multipliers"]) == 3
    assert rb.load(out / "orbit.nc")["UZ1"].period == orbit["period"]


def test_json_alone_on_standard_output(cli, file, out):
    told = cli(
        "orbit", "--model", file, "--set", "al=0.7", "--method", "shooting", "--json", "--out", out
    )
    summary = json.loads(told.out)
    assert summary["orbits"][0]["parameters"] == {"al": 0.7}
    assert summary["branches"][0]["method"] == "shooting"
    assert "Multipliers" in told.err


def test_an_orbit_that_there_is_not(cli, file, out):
    told = cli("orbit", "--model", file, "--set", "al=1.4", "--out", out)
    assert told.status == 1
    assert told.err.startswith("racs-bif: no orbit found at al = 1.4 (")
    assert not out.exists() or not list(out.iterdir())


def test_wrong_usage_of_orbit(cli, file, out):
    for arguments, message in (
        ((), "along which parameter?"),
        (("--set", "al=0.9", "--along", "bee"), "unknown parameter 'bee'; did you mean 'be'?"),
        (("--set", "al=0.9", "--method", "colocation"), "did you mean 'collocation'"),
        (("--set", "al=0.9", "--state", "q"), "unknown state 'q'"),
        (("--set", "al=0.9", "--span", "2", "1"), "LOW must be below HIGH"),
    ):
        told = cli("orbit", "--model", file, *arguments, "--out", out)
        assert told.status == 2
        assert message in told.err


def test_values_of_the_period_and_further_branches(cli, file, out):
    run = ("continue", "al", "0.55", "1.2", "--model", file, "--orbits", "collocation")
    told = cli(*run, "--at", "0.9", "period=6.35", "--probes", "0", "--out", out)
    assert told.status == 0, told.err
    diagram = rb.load(out / "branches.nc")
    assert [b.name for b in diagram] == ["EQ1", "PO1"]
    periods = [p.period for p in diagram["PO1"].special if p.label == "UZ"]
    assert 6.35 in periods
    assert "Other branches of orbits begin at PD1: --branches 1 follows them." in told.out
    told = cli(*run, "--branches", "1", "--probes", "0", "--out", out)
    diagram = rb.load(out / "branches.nc")
    assert [b.name for b in diagram] == ["EQ1", "PO1", "PO2"]
    assert diagram["PD2"].parameters["al"] == pytest.approx(0.579629840896, rel=1e-6)
    assert "--branches 1" not in told.out


def test_a_cascade_is_told_with_its_ratios(cli, file, out):
    run = ("continue", "al", "0.5", "1.2", "--model", file, "--orbits", "collocation")
    told = cli(*run, "--cascade", "3", "--probes", "0", "--out", out)
    assert told.status == 0, told.err
    assert "Cascade from PD1 of PO1:" in told.out
    assert "by Feigenbaum's number it ends at al = 0.56" in told.out


def test_two_hopf_points_of_one_branch_give_it_once(cli, tmp_path, out):
    path = tmp_path / "joined.py"
    path.write_text(
        "import racs_bif as rb\n\n\ndef model():\n"
        "    g = '(lam*(1 - lam) - x**2 - y**2)'\n"
        "    return rb.model_from_strings('joined', {'x': g + '*x - 2*y', 'y': '2*x + ' + g + "
        "'*y'}, parameters={'lam': 0.5}, guess={'x': 0.0, 'y': 0.0})\n"
    )
    told = cli("continue", "lam", "-1", "2", "--model", path, "--probes", "0", "--out", out)
    assert told.status == 0, told.err
    assert [b.name for b in rb.load(out / "branches.nc")] == ["EQ1", "PO1"]
    assert "It is H2, lam = 1" in " ".join(told.out.split())
    assert "The orbits from H2 are those of PO1." in told.out


def test_pictures_from_a_saved_file(cli, file, out):
    cli("orbit", "--model", file, "--set", "al=0.9", "--out", out)
    for what in ("profiles", "phase", "circle", "orbit"):
        told = cli("plot", out / "orbit.nc", "--what", what)
        assert (told.status, told.err) == (0, "")
        assert (out / f"{what}.png").read_bytes().startswith(b"\x89PNG")
    told = cli("plot", out / "orbit.nc", "--point", "UZ1", "--to", out / "a.svg")
    assert b"<svg" in (out / "a.svg").read_bytes()
    for arguments, message in (
        (("--what", "phases"), "did you mean 'phase'"),
        (("--point", "H9"), "no special point 'H9'"),
        (("--branch", "PO9"), "has no branch of orbits 'PO9'"),
        (("--to", out / "a.txt"), "is no picture"),
    ):
        told = cli("plot", out / "orbit.nc", *arguments)
        assert told.status == 2
        assert message in told.err
    assert cli("plot", out / "nothing.nc").status == 2
