"""Inputs and the unit of time, said in each way to write a model, and shown with results."""

import numpy as np
import pytest
from matplotlib.figure import Figure

import racs_bif as rb
from racs_bif.cli.main import main
from racs_bif.errors import ModelError
from racs_bif.plots.root_locus import picture as locus_picture
from racs_bif.plots.spectrum import picture as spectrum_picture

EQUATIONS = {"x": "mu*x - y - x*(x**2 + y**2)", "y": "x + mu*y - y*(x**2 + y**2)"}
NUMBERS = {"mu": -0.5}
TOML = """
inputs = ["mu"]
time_unit = "ms"
[parameters]
mu = -0.5
[equations]
"""


def strings(**more):
    return rb.model_from_strings("hopf", EQUATIONS, parameters=NUMBERS, **more)


def function(**more):
    def rates(x, y, mu):
        r = x**2 + y**2
        return mu * x - y - x * r, x + mu * y - y * r

    return rb.model_from_function("hopf", rates, states="x y", parameters=NUMBERS, **more)


def table(tmp_path):
    path = tmp_path / "hopf.toml"
    lines = (f'{name} = "{right}"' for name, right in EQUATIONS.items())
    path.write_text(TOML + "\n".join(lines), encoding="utf-8")
    return rb.model_from_toml(path)


@pytest.mark.parametrize("door", ["strings", "function", "called", "table"])
def test_every_door_takes_inputs_and_the_unit_of_time(door, tmp_path):
    said = {"inputs": ["mu"], "time_unit": "ms"}
    model = {
        "strings": lambda: strings(**said),
        "function": lambda: function(**said),
        "called": lambda: function(**said, derivatives="series"),
        "table": lambda: table(tmp_path),
    }[door]()
    assert (model.inputs, model.time_unit) == (("mu",), "ms")
    assert rb.to_control(model).input_labels == ["mu"]


def test_nothing_said_is_seconds_without_inputs():
    for model in (strings(), function()):
        assert (model.inputs, model.time_unit) == ((), "s")


@pytest.mark.parametrize("door", [strings, function])
@pytest.mark.parametrize(
    ("said", "complaint"),
    [
        ({"inputs": ["nu"]}, "input 'nu' is no parameter; there are: mu"),
        ({"inputs": "mu"}, "the inputs as a list, not as 'mu'"),
        ({"time_unit": 3}, "the unit of time is 3; give a word such as 's', or ''"),
    ],
)
def test_what_is_neither_is_refused(door, said, complaint):
    with pytest.raises(ModelError, match=complaint):
        door(**said)


@pytest.fixture(scope="module", params=["s", "ms", ""])
def found(request):
    """A branch, its orbits and a history of a model in each unit of time."""
    model = strings(time_unit=request.param)
    branch = rb.continue_equilibria(model, "mu", (-1.0, 1.0))
    orbits = rb.continue_orbits(branch["H1"], span=(-0.5, 0.3), at=(0.2,))
    return request.param, model, branch, orbits, rb.simulate(model, 1.0, step=0.1)


def said(name, unit):
    return f"{name} [{unit}]" if unit else name


def test_pictures_say_it(found):
    time, model, branch, orbits, history = found
    ax = Figure().add_subplot()
    assert orbits.plot_period(ax=ax).get_ylabel() == said("period", time)
    assert history.plot(ax=Figure().add_subplot()).get_xlabel() == said("time", time)
    rate, turning = (f"1/{time}", f"rad/{time}") if time else ("", "")
    roots = spectrum_picture(rb.spectrum(model)).axes[0]
    assert (roots.get_xlabel(), roots.get_ylabel()) == (said("Re s", rate), said("Im s", turning))
    locus = locus_picture(rb.root_locus(branch)).axes[0]
    assert (locus.get_xlabel(), locus.get_ylabel()) == (said("Re s", rate), said("Im s", turning))


def test_notebooks_say_it(found):
    time, _, branch, orbits, history = found
    card = rb.Diagram(branch, orbits)._repr_html_()
    assert f"<th>{said('period', time)}</th>" in card
    assert f"<th>{said('omega', f'rad/{time}' if time else '')}</th>" in card
    assert ("rad/s" in card) == (time == "s")
    assert repr(history).split(" samples to 1")[1].startswith(f" {time}," if time else ",")


def test_files_keep_it(found, tmp_path):
    time, _, branch, orbits, history = found
    for result in (branch, orbits, history):
        again = rb.load(rb.save(result, tmp_path / "result.nc"))
        assert again == result
        assert again.system.time_unit == time
        assert again.system.unit("period") == time
    assert history.to_xarray()["time"].attrs["units"] == time


@pytest.mark.parametrize(
    ("name", "unit"), [("hodgkin_huxley", "ms"), ("lorenz", ""), ("racs", "s")]
)
def test_the_shelf_says_it(name, unit):
    assert rb.load_model(name).time_unit == unit


def test_the_command_line_says_it(capsys, tmp_path):
    table(tmp_path)
    command = ["continue", "mu", "-1", "1", "--at", "0.2", "--out", str(tmp_path / "out")]
    assert main([*command, "--model", str(tmp_path / "hopf.toml")]) == 0
    told = capsys.readouterr().out
    assert all(word in told for word in ("rad/ms", "kHz", "period [ms]"))
    assert not any(word in told for word in ("rad/s", "[s]", " Hz"))
    branch = rb.load(tmp_path / "out" / "branches.nc")["H1"]
    np.testing.assert_allclose(branch.omega, 1.0, rtol=1e-9)
