"""A user's mistakes, one of each kind: the message names the offending thing and the mend."""

import shlex
from types import SimpleNamespace

import control
import numpy as np
import pytest
import sympy as sp

import racs_bif as rb
from racs_bif.charts.backends import LocalProcesses
from racs_bif.charts.sweeps import Sweep
from racs_bif.cli.main import main
from racs_bif.continuation.settings import StepSettings
from racs_bif.errors import (
    ConvergenceError,
    FileError,
    ModelError,
    ParameterError,
    RacsBifError,
    UsageError,
)
from racs_bif.orbits.collocation_settings import CollocationSettings
from racs_bif.simulation.batch import BatchSettings
from racs_bif.verbs.predictions import predict_orbits

HOPF = {"x": "mu*x - y - k*x*(x**2 + y**2)", "y": "x + mu*y - k*y*(x**2 + y**2)"}
NUMBERS = {"mu": -0.5, "k": 1.0, "none": 0.0}
LAW = ("Z", "x", "1/(1 + s**alpha)")


def strings(equations=None, parameters=None, **more):
    """Build the normal form of a Hopf point, or what a test makes of it."""
    numbers = NUMBERS if parameters is None else parameters
    return rb.model_from_strings("hopf", equations or HOPF, parameters=numbers, **more)


def function(name="two", **more):
    given = {"states": ["x", "y"], "parameters": {"k": 1.0}}
    return rb.model_from_function(name, lambda x, y, k: (y, -k * x), **given | more)


def fractional():
    return strings(
        {"x": "v", "v": "-k*x - c*Z"}, {"k": 1.0, "c": 0.1, "alpha": 0.5}, elements=[LAW]
    )


def settled(text):
    """Write a model in TOML beside the others of the test and read it."""

    def read(world):
        path = world.folder / "mine.toml"
        path.write_text(text, encoding="utf-8")
        return rb.model_from_toml(path)

    return read


def written(name, text):
    """Write a model in Python and load it."""

    def read(world):
        path = world.folder / f"{name}.py"
        path.write_text(text, encoding="utf-8")
        return rb.load_model(str(path))

    return read


def chart(world, spans=None, **options):
    return rb.stability_chart(world.model, *PLANE, spans or SPANS, **options)


def broken(world):
    path = world.folder / "broken.nc"
    path.write_bytes(b"no netCDF")
    return rb.load(path)


@pytest.fixture(scope="module")
def world(tmp_path_factory):
    """What the mistakes are made with: a model, a branch, an orbit, and the branch from a file."""
    folder = tmp_path_factory.mktemp("world")
    model = strings()
    branch = rb.continue_equilibria(model, "mu", (-1.0, 1.0))
    fold = strings({"x": "a + b*x - x**3"}, {"a": -1.0, "b": 1.0}, guess={"x": -1.3})
    orbits = rb.continue_orbits(branch["H1"], span=(-0.5, 0.2), at=(0.1,))
    file = rb.save(branch, folder / "eq.nc")
    return SimpleNamespace(
        folder=folder,
        model=model,
        system=rb.load_model("van_der_pol"),
        element=fractional(),
        branch=branch,
        hopf=branch["H1"],
        folded=rb.continue_equilibria(fold, "a", (-1.0, 1.0)),
        orbits=orbits,
        loaded=rb.load(file),
        history=rb.simulate(model, 1.0, step=0.1),
        file=file,
    )


VARIED = ("mu", (-1.0, 1.0))
PLANE = ("mu", "k")
SMALL = ((-1.0, -0.9), (1.0, 1.1))
SPANS = ((-1.0, 1.0), (0.5, 2.0))
T = "[equations]\nx = '-k*x'\n"

MODELS = [
    # the mistake, its error, the thing, the mend
    (lambda w: strings({"x": "-q*x"}), ModelError, "'q'", "there are: "),
    (lambda w: strings({"x": "-kk*x"}), ModelError, "'kk' in the equation of 'x'", "mean 'k'?"),
    (lambda w: strings({"x": "sine(x)"}), ModelError, "'sine'", "did you mean 'sin'?"),
    (lambda w: strings({"x": "sin(x, 2)"}), ModelError, "'sin(x, 2)'", "give 1"),
    (lambda w: strings({"x": "x.real"}), ModelError, "'x.real'", "use numbers, names"),
    (lambda w: strings({"x": "x +"}), ModelError, "'x +'", "check brackets"),
    (lambda w: strings({"x": "x % 2"}), ModelError, "'x % 2'", "use the operators"),
    (lambda w: strings({"x": "~x"}), ModelError, "'~x'", "write it so"),
    (lambda w: strings({"x": "1j*x"}), ModelError, "'1j'", "give one"),
    (lambda w: strings({"x": "x*1e999"}), ModelError, "'x*1e999'", "scale the equation"),
    (lambda w: strings({"x": "x*10**9**9"}), ModelError, "'x*10**9**9'", "smaller exponent"),
    (lambda w: strings({"x": "x*" + 3999 * "9"}), ModelError, "'x*999", "write it as 1.0e9"),
    (lambda w: strings({"x": "x()()"}), ModelError, "'x()()'", "write it as sin(x)"),
    (lambda w: strings({"x": "1 if x else 2"}), ModelError, "'x'", "compare two terms with <"),
    (lambda w: strings({"x": 2.0}), ModelError, "'x'", "must be a string, not float"),
    (lambda w: strings({"x": 9000 * "x+" + "x"}), ModelError, "'x'", "split it"),
    (lambda w: strings({"x": 900 * "(" + "x" + 900 * ")"}), ModelError, "'x'", "check brackets"),
    (lambda w: strings({"2x": "k"}), ModelError, "'2x'", "use letters, digits and _"),
    (lambda w: strings({"pi": "k"}), ModelError, "'pi' is a constant", "rename it"),
    (lambda w: strings({"k": "k"}), ModelError, "'k' is used twice", "rename one of them"),
    (lambda w: strings({"s": "k"}, elements=[LAW]), ModelError, "'s'", "rename it"),
    (lambda w: strings(["x"]), ModelError, "model 'hopf'", "as a dict, not as list"),
    (lambda w: strings({3: "k"}), ModelError, "3 cannot be a name", "give a string"),
    (
        lambda w: strings(parameters={"mu": "much", "k": 1}),
        ModelError,
        "'mu' is 'much'",
        "give one",
    ),
    (lambda w: strings(parameters={"mu": np.nan, "k": 1}), ModelError, "'mu'", "finite number"),
    (lambda w: strings(guess={"z": 1.0}), ModelError, "unknown state 'z'", "there are: x, y"),
    (lambda w: strings(elements=[("Z", "x")]), ModelError, "('Z', 'x')", "(output, input, law)"),
    (
        lambda w: rb.spectrum(strings(elements=[("Z", "x", "exp(s)")])),
        ModelError,
        "law of 'Z'",
        "write it as",
    ),
    (
        lambda w: rb.model_from_strings("m", {}, parameters={}),
        ModelError,
        "'m'",
        "at least one state",
    ),
    (lambda w: function(states=3), ModelError, "as 3", "as a list"),
    (lambda w: function(states=["x", "x"]), ModelError, "'x' is used twice", "rename one"),
    (lambda w: function(parameters=3.0), ModelError, "float", "as a dict"),
    (
        lambda w: function(guess=(1.0,)),
        ModelError,
        "the guess has 1",
        "give 2, one for each of x, y",
    ),
    (lambda w: function(derivatives="auto2"), UsageError, "'auto2'", "did you mean 'auto'?"),
    (
        lambda w: rb.model_from_function("f", 3, states=["x"]),
        ModelError,
        "int is no function",
        "give",
    ),
    (
        lambda w: rb.model_from_function("f", lambda x, b, a: a, states=["x"]),
        ModelError,
        "'a'",
        "there are",
    ),
    (
        lambda w: rb.model_from_function("f", lambda x: int("a"), states=["x"]),
        ModelError,
        "'f'",
        "make",
    ),
    (
        lambda w: rb.model_from_function("f", lambda x: "x", states=["x"]),
        ModelError,
        "'f'",
        "numbers",
    ),
    (
        lambda w: rb.spectrum(rb.Model("m", {"x": sp.Symbol("x")}, mass=sp.Matrix([[sp.I]]))),
        ModelError,
        "the mass matrix is complex",
        "write it with real numbers",
    ),
    (
        lambda w: rb.spectrum(rb.Model("m", {"x": sp.Symbol("x")}, mass=sp.Matrix([[0]]))),
        ModelError,
        "the mass matrix is singular",
        "solve them for one variable",
    ),
    (
        lambda w: rb.spectrum(strings({"x": "log(x)"}, guess={"x": -1.0})),
        ModelError,
        "x = -1",
        "give another guess",
    ),
    (
        lambda w: rb.spectrum(strings({"x": "1 + x**2"})),
        ConvergenceError,
        "model 'hopf'",
        "give another guess or value",
    ),
    (
        lambda w: rb.with_feedback(function(derivatives="differences"), {"k": {"x": 1.0}}),
        ModelError,
        "model 'two'",
        "write them as expressions",
    ),
    (lambda w: rb.model_from_function("f", iter, states=["x"]), ModelError, "'iter'", "a Python"),
    (lambda w: rb.Parameter("1a", 1.0) and rb.Model("m", {"1a": 0}), ModelError, "'1a'", "letters"),
    (settled("name = 'm'\n"), ModelError, "[equations]", "give one"),
    (settled("name = 3\n" + T), ModelError, "the name is 3", "a word in quotes"),
    (settled("nonsense"), ModelError, "mine.toml is no TOML", "mend the file"),
    (settled("equation = 3\n"), ModelError, "'equation'", "did you mean 'equations'?"),
    (settled("equations = 3\n"), ModelError, "'equations' is", "make it a table"),
    (settled("[equations]\nx = [3]\n"), ModelError, "'equations.x'", "put it in quotes"),
    (settled(T + "[parameters.k]\nunit = 'm'\n"), ModelError, "'parameters.k'", "give one"),
    (settled(T + "[parameters]\nk = 'a'\n"), ModelError, "'parameters.k'", "give a number"),
    (
        settled(T + "[parameters.k]\ndefault = 1\nvalid = [2, 1]\n"),
        ModelError,
        "valid",
        "LOW below",
    ),
    (settled("band = [1]\n" + T), ModelError, "'band'", "give two numbers"),
    (settled("notes = 3\n" + T), ModelError, "'notes'", "list of texts"),
    (settled("mass = [1]\n" + T), ModelError, "'mass'", "list of rows"),
    (settled(T + "[elements.Z]\ninput = 'x'\n"), ModelError, "'law'", "give one"),
    (
        lambda w: rb.model_from_toml("no.toml"),
        ModelError,
        "no.toml cannot be read",
        "check its path",
    ),
    (lambda w: rb.load_model("van_der_pool"), UsageError, "'van_der_pool'", "mean 'van_der_pol'?"),
    (lambda w: rb.load_model("no_such.py"), UsageError, "no file 'no_such.py'", "no_such"),
    (lambda w: rb.load_model(3), UsageError, "3", "give"),
    (written("empty", "x = 1\n"), ModelError, "no function 'model'", "add 'def model() -> Model'"),
    (
        written("none", "def model():\n    return 3\n"),
        ModelError,
        "returns int",
        "return a racs_bif",
    ),
    (written("raises", "1 / 0\n"), ModelError, "line 1 raises ZeroDivisionError", "mend the file"),
    (
        lambda w: rb.load_model("van_der_pol", variant="x"),
        UsageError,
        "'van_der_pol' has no variants",
        "leave --variant out",
    ),
    (
        lambda w: rb.load_model("van_der_pol", parameters={"nu": 1}),
        ParameterError,
        "'nu'",
        "there are: mu, g",
    ),
    (
        lambda w: rb.load_model("van_der_pol", parameters={"mu": np.inf}),
        ParameterError,
        "'mu' is inf",
        "give a finite number",
    ),
    (
        lambda w: rb.load_model("racs", parameters={"alpha": 1.5}),
        ParameterError,
        "'alpha' = 1.5",
        "choose it between",
    ),
    (lambda w: rb.load_model("racs", realisation="x"), UsageError, "'x'", "there are: "),
    (
        lambda w: rb.load_model("racs", band=(2, 1)),
        UsageError,
        "band 2 .. 1",
        "give 0 < LOW < HIGH",
    ),
]

VERBS = [
    (
        lambda w: rb.continue_equilibria(w.model, "nu", (0, 1)),
        ParameterError,
        "'nu'",
        "there are: mu, k",
    ),
    (
        lambda w: rb.continue_equilibria(w.model, "mu", (1, 0)),
        UsageError,
        "1 to 0",
        "give a finite",
    ),
    (
        lambda w: rb.continue_equilibria(w.model, *VARIED, at=(3.0,)),
        UsageError,
        "mu = 3",
        "widen the span",
    ),
    (
        lambda w: rb.continue_equilibria(rb.load_model("racs"), "alpha", (0.5, 2.0)),
        ParameterError,
        "'alpha'",
        "narrow the span",
    ),
    (lambda w: StepSettings(initial=-1.0), UsageError, "'initial'", "must be a positive number"),
    (lambda w: StepSettings(minimum=1.0, initial=0.1), UsageError, "minimum", "must obey"),
    (lambda w: w.branch["H7"], UsageError, "no special point 'H7'", "H1"),
    (lambda w: w.branch.at(mu=5.0), UsageError, "mu = 5", "continue it"),
    (lambda w: w.branch.at(nu=5.0), UsageError, "'nu' is not active", "there are: mu"),
    (lambda w: w.branch.column("z"), UsageError, "'z'", "there are: "),
    (lambda w: rb.Diagram(), UsageError, "a diagram", "at least one branch"),
    (lambda w: rb.Diagram(w.branch)["H9"], UsageError, "'H9'", "H1"),
    (lambda w: rb.all_equilibria(w.model, "mu", (2, 2)), UsageError, "2 to 2", "LOW below HIGH"),
    (
        lambda w: rb.continue_orbits(w.hopf, method="shoting"),
        UsageError,
        "'shoting'",
        "did you mean 'shooting'?",
    ),
    (lambda w: rb.continue_orbits(w.folded["LP1"]), UsageError, "LP1", "start from a Hopf point"),
    (
        lambda w: rb.continue_orbits(w.loaded["H1"]),
        UsageError,
        "loaded from a file",
        "continue the",
    ),
    (
        lambda w: rb.continue_orbits(w.hopf, (1.0, 2.0)),
        UsageError,
        "outside the span 1 to 2",
        "widen it",
    ),
    (
        lambda w: rb.continue_orbits(w.hopf, orbit_settings=StepSettings()),
        UsageError,
        "StepSettings",
        "needs ",
    ),
    (lambda w: CollocationSettings(degree=9), UsageError, "'degree'", "must be from 2 to 7, not 9"),
    (lambda w: CollocationSettings(intervals=2), UsageError, "intervals", "must obey"),
    (
        lambda w: rb.continue_curve(w.hopf, ("mu", "mu")),
        UsageError,
        "mu, mu",
        "needs two different",
    ),
    (lambda w: rb.continue_curve(w.hopf, ("mu", "z")), ParameterError, "'z'", "there are: mu, k"),
    (
        lambda w: rb.continue_curve(w.hopf, PLANE, operator="exat"),
        UsageError,
        "'exat'",
        "there are: ",
    ),
    (
        lambda w: rb.continue_curve(w.hopf, PLANE, ((1, 2), None)),
        UsageError,
        "'mu' leaves out the start",
        "widen it",
    ),
    (lambda w: rb.continue_curve(w.hopf, PLANE, kind="x"), UsageError, "'x'", "there are: "),
    (lambda w: rb.continue_curve(w.hopf, PLANE, kind="fold"), UsageError, "H1", "these can: "),
    (
        lambda w: rb.continue_curve(w.folded["LP1"], ("a", "b"), kind="hopf"),
        UsageError,
        "LP1",
        "these can: ",
    ),
    (lambda w: rb.find_orbit(w.model, "mu", 0.1, start="hop"), UsageError, "'hop'", "'hopf'?"),
    (lambda w: rb.find_orbit(w.model, "mu", 0.1, method="x"), UsageError, "'x'", "there are: "),
    (
        lambda w: rb.find_orbit(w.model, "mu", -0.1, duration=9),
        ConvergenceError,
        "mu = -0.1",
        "give",
    ),
    (
        lambda w: rb.orbit_from_history(w.history, "mu", model=w.model),
        UsageError,
        "the history is at rest",
        "start it somewhere else",
    ),
    (lambda w: rb.period_doubling_cascade(w.hopf, 0), UsageError, "depth", "at least 1, not 0"),
    (
        lambda w: rb.phase_response(w.loaded["H1"]),
        UsageError,
        "loaded from a file",
        "continue from",
    ),
    (lambda w: rb.phase_response(w.hopf), UsageError, "H1 is no orbit", "take a point of a branch"),
    (
        lambda w: rb.spectrum(w.model, above=np.nan),
        UsageError,
        "Re s = nan",
        "give a finite number",
    ),
    (lambda w: rb.certify(w.branch, "newtons"), UsageError, "'newtons'", "did you mean 'newton'?"),
    (lambda w: rb.certify(w.branch, tolerance=0), UsageError, "tolerance 0", "give a positive"),
    (lambda w: rb.certify(w.orbits), UsageError, "no branch of equilibria", "give one"),
    (lambda w: rb.simulate(w.model, -1.0), UsageError, "-1 s", "give a positive, finite one"),
    (
        lambda w: rb.simulate(w.model, 1.0, step=2.0),
        UsageError,
        "the step is 2 s",
        "give one between",
    ),
    (lambda w: rb.simulate(w.model, 1.0, tolerance=2), UsageError, "the tolerance is 2", "between"),
    (lambda w: rb.simulate(w.model, 1.0, operator="x"), UsageError, "'x'", "there are: "),
    (lambda w: rb.simulate(w.model, 1.0, method="x"), UsageError, "'x'", "there are: "),
    (lambda w: rb.simulate(w.model, 1.0, initial={"z": 1}), UsageError, "'z'", "there are: x, y"),
    (
        lambda w: rb.simulate(w.model, 1.0, initial={"x": np.inf}),
        UsageError,
        "'x' is inf",
        "finite",
    ),
    (lambda w: rb.simulate(w.element, 1, initial={"Z": 1}), UsageError, "'Z' follows", "there are"),
    (lambda w: rb.simulate(w.model, 1.0, history="x"), UsageError, "'x'", "there are: "),
    (
        lambda w: rb.simulate(w.model, 1.0, inputs={"z": np.sin}),
        ParameterError,
        "'z'",
        "there are: mu",
    ),
    (lambda w: w.history.column("z"), UsageError, "'z'", "there are: "),
    (
        lambda w: rb.simulate_batch(w.model, 1.0, values={"mu": [0, 1], "k": [1, 2, 3]}),
        UsageError,
        "mu has 2, k has 3",
        "one length",
    ),
    (lambda w: rb.simulate_batch(w.model, 1.0, initial={"z": 1}), UsageError, "'z'", "there are"),
    (lambda w: rb.simulate_batch(w.model, -1.0), UsageError, "-1 s", "give a finite one above"),
    (lambda w: BatchSettings(samples=1), UsageError, "not 1", "must keep at least 2 samples"),
    (lambda w: BatchSettings(after=-1.0), UsageError, "-1 s", "must be a finite time from 0 on"),
    (lambda w: rb.stability_chart(w.model, "mu", "mu", SPANS), UsageError, "'mu'", "two different"),
    (lambda w: rb.stability_chart(w.model, "mu", "z", SPANS), ParameterError, "'z'", "there are"),
    (
        lambda w: rb.stability_chart(w.model, *PLANE, SPANS, at={"mu": 1.0}),
        UsageError,
        "'mu' is varied",
        "leave it out",
    ),
    (
        lambda w: rb.stability_chart(w.model, *PLANE, SPANS, operator="x"),
        UsageError,
        "'x'",
        "there are: ",
    ),
    (
        lambda w: rb.stability_chart(w.model, *PLANE, SPANS, marks={"z": (1.0,)}),
        UsageError,
        "not of 'z'",
        "must be wanted at values of mu or k",
    ),
    (
        lambda w: rb.stability_chart(w.model, *PLANE, SPANS, marks={"k": (9.0,)}),
        UsageError,
        "k = 9",
        "widen the span",
    ),
    (
        lambda w: rb.stability_chart(w.model, *PLANE, SPANS, quantity="x"),
        UsageError,
        "'x'",
        "there are: ",
    ),
    (
        lambda w: rb.chart_slices(w.model, *PLANE, SPANS, ("mu", (1.0, 2.0))),
        UsageError,
        "'mu'",
        "slice along another parameter",
    ),
    (lambda w: rb.calibrate(w.system, "mu", {"mu": 1}), UsageError, "'mu'", "calibrate another"),
    (
        lambda w: rb.calibrate(w.system, "g", {"mu": 1.0}, span=(2, 1)),
        UsageError,
        "2 .. 1",
        "give LOW < HIGH",
    ),
    (
        lambda w: rb.calibrate(w.system, "g", {"mu": 1.0}, span=(1, 2)),
        UsageError,
        "'g' in 1 .. 2",
        "give another --span",
    ),
    (
        lambda w: rb.all_equilibria(strings({"x": "mu + x + x**2"}), "mu", (1, 2)),
        ConvergenceError,
        "model 'hopf'",
        "give a better guess",
    ),
    (
        lambda w: rb.continue_curve(w.hopf, PLANE, kind="lpc"),
        UsageError,
        "H1",
        "these can: ",
    ),
    (
        lambda w: rb.continue_curve(w.hopf, PLANE, kind="homoclinic"),
        UsageError,
        "H1",
        "must start at",
    ),
    (lambda w: rb.continue_curve(w.loaded["H1"], PLANE), UsageError, "H1", "compute its branch"),
    (
        lambda w: rb.orbit_from_history(w.history, "mu", model=strings({"x": "mu*y", "y": "-k*x"})),
        ModelError,
        "'hopf'",
        "compute it again, or give the model",
    ),
    (
        lambda w: rb.stability_chart(strings({"x": "2 + mu + k + x**2"}), *PLANE, SPANS),
        ConvergenceError,
        "mu -1 to 1 and k 0.5 to 2",
        "give the model a better guess, or other spans",
    ),
    (lambda w: rb.continue_curve(w.orbits["UZ1"], PLANE), UsageError, "UZ1", "these can: "),
    (
        lambda w: rb.continue_curve(w.hopf, ("k", "none")),
        UsageError,
        "'none' is 0",
        "give its span",
    ),
    (
        lambda w: rb.from_control(control.NonlinearIOSystem(lambda t, x, u, p: -x, name="free")),
        UsageError,
        "'free' leaves open",
        "name them",
    ),
    (lambda w: predict_orbits(w.hopf, "torus"), UsageError, "'torus'", "there are: "),
    (lambda w: predict_orbits(w.hopf, "lpc"), UsageError, "H1", "these can: GH"),
    (
        lambda w: rb.certify(w.branch, model=strings({"x": "-k*x - y", "y": "x"})),
        ModelError,
        "EQ1",
        "compute it again",
    ),
    (
        lambda w: rb.orbit_from_history(w.history, "mu", model="van_der_pol"),
        ModelError,
        "'van_der_pol'",
        "use the model that the result",
    ),
    (
        lambda w: chart(w, SMALL, quantity="amplitude"),
        UsageError,
        "simulations",
        "give their duration",
    ),
    (
        lambda w: chart(w, quantity="amplitude", sweep=Sweep(duration=1.0, watch="z")),
        UsageError,
        "'z'",
        "there are: x, y",
    ),
    (lambda w: Sweep(duration=0.0, watch="x"), UsageError, "0 s", "give a positive one"),
    (lambda w: chart(w, quantity="count", tiles=w.file), FileError, "eq.nc", "choose another"),
    (lambda w: chart(w, quantity="count", shape=(0, 2)), UsageError, "0 x 2", "at least one cell"),
    (lambda w: chart(w, workers=-1), UsageError, "-1", "give 0 or more"),
    (lambda w: LocalProcesses(0), UsageError, "0", "give workers=1 or more"),
    (
        lambda w: chart(w, workers=1, scheduler="tcp://127.0.0.1:1"),
        UsageError,
        "workers or a scheduler",
        "give either",
    ),
    (lambda w: rb.load(w.folder / "no.nc"), FileError, "no.nc", "check its name and folder"),
    (broken, FileError, "broken.nc", "compute it again"),
    (lambda w: rb.save(w.branch, w.folder / "no" / "x.nc"), FileError, "x.nc", "choose"),
    (lambda w: rb.to_control(w.hopf, inputs=["z"]), ParameterError, "'z'", "there are: "),
    (lambda w: rb.to_control(w.hopf, outputs=["z"]), UsageError, "output 'z'", "there are: "),
    (lambda w: rb.to_control(w.loaded["H1"]), UsageError, "H1", "branch.at("),
    (lambda w: rb.from_control(3), UsageError, "int is no system of control", "give a StateSpace"),
    (lambda w: rb.element_response(w.model), UsageError, "no fractional element", "take a model"),
    (lambda w: rb.element_response(w.element, "Q"), UsageError, "no element 'Q'", "there are: Z"),
    (
        lambda w: rb.element_response(w.element, omega=[2.0, 1.0]),
        UsageError,
        "omega",
        "must be finite and ascend",
    ),
    (lambda w: rb.with_feedback(w.model, {"z": {"x": 1.0}}), ModelError, "'z'", "there are: "),
]

COMMANDS = [
    ("", "which verb?", "see racs-bif --help"),
    ("contineu mu 0 1", "unknown verb 'contineu'", "did you mean 'continue'?"),
    ("continue mu", "LOW", "see racs-bif continue --help"),
    ("continue mu 0 1 --modl x", "--modl", "did you mean '--model'?"),
    ("continue mu 1 0 --model van_der_pol", "here 1 and 0", "swap them"),
    ("continue mu 0 1 --model van_der_pool", "'van_der_pool'", "did you mean 'van_der_pol'?"),
    ("continue nu 0 1 --model van_der_pol", "'nu'", "there are: mu, g"),
    ("continue mu 0 1 --model van_der_pol --set mu=1", "--set mu", "leave it out"),
    ("continue mu 0 1 --model van_der_pol --set mu", "mu", "NAME=VALUE"),
    ("continue mu 0 1 --model van_der_pol --at 3", "--at 3", "widen the span"),
    ("continue mu 0 1 --model van_der_pol --state z", "unknown state 'z'", "there are: x, y"),
    ("continue mu 0 a --model van_der_pol", "'a'", "see racs-bif continue --help"),
    ("continue u 5 30 --variant x", "unknown variant 'x'", "there are: "),
    ("models --set a=1", "--set", "write racs-bif models NAME"),
    ("models van_der_pool", "'van_der_pool'", "did you mean 'van_der_pol'?"),
    ("run no_such", "'no_such'", "there are: "),
    ("new 2x", "'2x'", "use letters, digits and _"),
    ("orbit --model van_der_pol", "along which parameter?", "--set NAME=VALUE"),
    ("orbit --model van_der_pol --set g=1 --state z", "state 'z'", "there are: x, y"),
    ("chart mu mu --model van_der_pol", "'mu' twice", "needs two different parameters"),
    ("chart mu g --model van_der_pol --span z 0 1", "--span z", "name one of them"),
    ("chart mu g --model van_der_pol --resume", "--resume", "give --map"),
    ("chart mu g --model van_der_pol --workers 2", "--workers", "give --map or --slices"),
    ("chart mu g --model van_der_pol --cells 9 9", "--cells", "give --map"),
    ("curve hopf mu g --model van_der_pol --span z 0 1", "--span z", "name one of them"),
    ("simulate --time 1 --model van_der_pol --initial z=1 --state z", "state 'z'", "there are: "),
    (
        "simulate --time 1 --model van_der_pol --change a mu=1",
        "--change: 'a' is not a number",
        "write for example",
    ),
    ("plot po.nc --to no/x.png", "'no/x.png' cannot be written", "choose another place"),
    ("report history", "'history/branches.nc' holds no branches", "give the folder"),
    ("plot eq.nc", "'eq.nc' holds no branch of orbits", "give branches.nc"),
    ("run study.py --set depth=1.5", "'depth' of analysis 'study'", "must be a whole number"),
    ("run study.py --set dept=1", "no number 'dept'", "did you mean 'depth'?"),
    ("run study.py", "line 2 raises ZeroDivisionError", "mend the file"),
    ("run other.py", "no function 'run'", "add 'def run(out, ...)'"),
    ("plot no.nc --what orbit", "no file 'no.nc'", "check its name"),
    ("report no_such", "no folder 'no_such'", "continue --out DIR"),
    ("certify no.nc", "no file 'no.nc'", "check its name"),
]


@pytest.mark.parametrize(("mistake", "kind", "thing", "mend"), MODELS + VERBS)
def test_a_mistake_in_python(world, mistake, kind, thing, mend):
    with pytest.raises(RacsBifError) as told:
        mistake(world)
    message = str(told.value)
    assert isinstance(told.value, kind), message
    assert thing in message
    assert mend in message
    assert "\n" not in message


@pytest.mark.parametrize(("command", "thing", "mend"), COMMANDS)
def test_a_mistake_on_the_command_line(world, capsys, tmp_path, monkeypatch, command, thing, mend):
    (tmp_path / "study.py").write_text("def run(out, depth=3):\n    1 / 0\n", encoding="utf-8")
    (tmp_path / "other.py").write_text("", encoding="utf-8")
    (tmp_path / "history").mkdir()
    rb.save(world.history, tmp_path / "history" / "branches.nc")
    rb.save(world.orbits, tmp_path / "po.nc")
    rb.save(world.branch, tmp_path / "eq.nc")
    there = sorted(tmp_path.iterdir())
    monkeypatch.chdir(tmp_path)
    assert main(shlex.split(command)) == 2
    message = capsys.readouterr().err
    assert thing in message
    assert mend in message
    assert message.startswith("racs-bif")
    assert message.count("\n") == 1
    assert [p for p in sorted(tmp_path.iterdir()) if p.name != "__pycache__"] == there
