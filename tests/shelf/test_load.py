"""Loading models: by name, by path, through the cache, and what is said when it fails."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

import racs_bif as rb
from racs_bif.errors import ModelError, ParameterError, RacsBifError, UsageError
from racs_bif.shelf.load import load_model, system_of
from racs_bif.symbolic.model import Calibration, Model, Parameter

ROOT = Path(__file__).parents[2]
SPRING = """
import sympy as sp
from racs_bif import Model, Parameter

def model(*, variant="soft"):
    x, v, k = sp.symbols("x v k")
    force = -k*x if variant == "soft" else -k*x**3
    return Model("spring", {{"x": v, "v": force}}, (Parameter("k", {k}),), variant=variant)
"""
PLAIN = """
import sympy as sp
from racs_bif import Model

def model():
    return Model("plain", {"x": -sp.Symbol("x")})
"""


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """An empty cache."""
    folder = tmp_path / "cache"
    monkeypatch.setenv("RACS_BIF_CACHE", str(folder))
    return folder


@pytest.fixture
def write(tmp_path):
    """Write a model file and return its path as text."""

    def put(text, name="toy.py"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return str(path)

    return put


@pytest.fixture
def runs(monkeypatch):
    """Count how often model files are run."""
    from racs_bif.shelf import load

    calls = []
    inner = load.load_module
    monkeypatch.setattr(load, "load_module", lambda path: calls.append(path) or inner(path))
    return calls


TWICE = """
import sys
from racs_bif.shelf.load import load_model
system = load_model("racs")
print("sympy" in sys.modules, repr(system.parameters["C_s"]), system.compiled.digest)
"""


@pytest.fixture(scope="module")
def loaded_twice(tmp_path_factory):
    """Output of two runs of one script that share a cache."""
    environment = os.environ | {
        "PYTHONPATH": str(ROOT),
        "RACS_BIF_CACHE": str(tmp_path_factory.mktemp("shared")),
    }
    command = [sys.executable, "-c", TWICE]
    options = {"env": environment, "capture_output": True, "text": True, "check": True}
    return [subprocess.run(command, **options).stdout.split() for _ in range(2)]  # noqa: PLW1510


def test_a_second_run_does_not_import_sympy(loaded_twice):
    first, second = loaded_twice
    assert first[0] == "True"
    assert second[0] == "False"
    assert first[1:] == second[1:]


def test_the_default_stiffness_is_calibrated(loaded_twice):
    """model.md, section 3: computed, to the eight digits given there."""
    assert float(loaded_twice[0][1]) == pytest.approx(29661.065, abs=5e-4)


def test_vehicle_by_name_and_by_path():
    by_name = load_model("racs", parameters={"c": 0.3})
    by_path = load_model(str(ROOT / "models" / "racs.py"), parameters={"c": 0.3})
    assert by_name.parameters == by_path.parameters
    assert by_name.parameters["c"] == 0.3
    assert by_name.parameters["A_h"] == pytest.approx(0.741526625, abs=5e-10)
    assert by_name.states == ("v", "w", "delta_c", "ddelta_c")
    assert by_name.variant == "paper"
    assert by_name.title
    assert any("not passive" in note for note in by_name.notes)
    assert by_name.state_units["delta_c"] == "rad"


def test_setting_the_stiffness_moves_what_it_stands_for():
    system = load_model("racs", parameters={"C_s": 20_000.0})
    assert system.parameters["C_s"] == pytest.approx(20_000.0, rel=1e-14)
    assert system.parameters["A_h"] == pytest.approx(20_000.0 / (0.8 * 0.5e5), rel=1e-14)


def test_a_calibrated_default_does_not_depend_on_the_variant():
    assert load_model("racs", variant="printed").parameters["C_s"] == pytest.approx(
        29661.065, abs=5e-4
    )


def test_realisation_is_chosen():
    system = load_model("racs", realisation="oustaloup", band=(1e-2, 1e3), order=6)
    assert system.realisation.name == "oustaloup"
    assert system.realisation.band == (1e-2, 1e3)
    assert system.realisation.states == 12  # two powers
    default = load_model("racs")
    assert default.realisation.name == "diffusive"
    assert list(default.realisation.band) == default.compiled.meta["band"]


@pytest.mark.parametrize(
    ("arguments", "kind", "words"),
    [
        ({"name": "rac"}, UsageError, r"unknown model 'rac'.*did you mean 'racs'"),
        ({"name": "nowhere.py"}, UsageError, r"there is no file 'nowhere.py'"),
        ({"variant": "papper"}, UsageError, r"unknown variant 'papper'.*did you mean 'paper'"),
        ({"realisation": "diffusiv"}, UsageError, r"'diffusiv'.*did you mean 'diffusive'"),
        ({"parameters": {"alhpa": 0.3}}, ParameterError, r"'alhpa'; did you mean 'alpha'"),
        ({"parameters": {"u": -1.0}}, ParameterError, r"'u' = -1 m/s is outside.*above 0"),
        ({"parameters": {"u": float("nan")}}, ParameterError, r"'u' is nan"),
        ({"parameters": {"C_s": 1e4, "A_h": 1.0}}, ParameterError, r"'C_s' sets 'A_h'"),
        ({"band": (3.0, 1.0)}, UsageError, r"band 3 .. 1 rad/s"),
        ({"order": 1}, UsageError, r"order 1 is too small"),
    ],
)
def test_wrong_wishes(arguments, kind, words):
    with pytest.raises(kind, match=words) as caught:
        load_model(**({"name": "racs"} | arguments))
    assert "\n" not in str(caught.value)


BAD_FILES = {
    "no function": ("x = 1\n", r"defines no function 'model'; add"),
    "no callable": ("model = 3\n", r"defines no function 'model'"),
    "wrong result": ("def model():\n    return 3\n", r"returns int; return a racs_bif Model"),
    "raises": ("def model():\n    return 1/0\n", r"line 2 raises ZeroDivisionError"),
    "raises at import": ("1/0\n", r"line 1 raises ZeroDivisionError"),
    "bad syntax": ("def model(:\n", r"line 1 raises SyntaxError"),
    "exits": ("raise SystemExit\n", r"line 1 raises SystemExit"),
    "unknown symbol": (PLAIN.replace('Symbol("x")', 'Symbol("y")'), r"unknown symbol 'y'"),
    "cannot be compiled": (PLAIN.replace("-sp", "sp.gamma(sp").replace('x")}', 'x"))}'), "gamma"),
}


@pytest.mark.parametrize("case", BAD_FILES)
def test_bad_files(cache, write, case):
    text, words = BAD_FILES[case]
    for _ in range(2):  # a failure is not stored
        with pytest.raises(ModelError, match=words) as caught:
            load_model(write(text))
        assert "\n" not in str(caught.value)
    assert not [p for p in cache.glob("*") if p.suffix == ".py"]


def test_a_file_that_is_no_text(write, tmp_path):
    (tmp_path / "bad.py").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ModelError, match=r"bad\.py cannot be read"):
        load_model(str(tmp_path / "bad.py"))


def test_a_variant_where_there_is_none(write):
    with pytest.raises(UsageError, match="model 'toy' has no variants; leave --variant out"):
        load_model(write(PLAIN), variant="other")


def test_a_file_is_run_once(cache, write, runs):
    path = write(SPRING.format(k=2.0))
    first, second = load_model(path), load_model(path)
    assert len(runs) == 1
    assert first.parameters == second.parameters == {"k": 2.0}
    point = np.array([3.0, 1.0])
    np.testing.assert_array_equal(second.field.f(point, second.values), [1.0, -6.0])


def test_variants_do_not_share(cache, write):
    path = write(SPRING.format(k=2.0))
    point = np.array([3.0, 1.0])
    for _ in range(2):
        soft, hard = load_model(path, variant="soft"), load_model(path, variant="hard")
        assert soft.field.f(point, soft.values)[1] == -6.0
        assert hard.field.f(point, hard.values)[1] == -54.0
        assert (soft.variant, hard.variant) == ("soft", "hard")


def test_an_edited_file_is_another_model(cache, write):
    """Also where its length does not change."""
    for k in ("2.0", "3.0", "2.0", "4.0"):
        assert load_model(write(SPRING.format(k=k))).parameters == {"k": float(k)}


def test_files_of_one_name_do_not_share(cache, write, tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    paths = [write(SPRING.format(k=k), f"{k}/spring.py".replace("1", "a").replace("2", "b"))
             for k in (1, 2)]  # fmt: skip
    for _ in range(2):
        assert [load_model(path).parameters["k"] for path in paths] == [1.0, 2.0]


# import, and what opens the file
OPENERS = {
    "open": ("", "open({data!r})"),
    "io": ("import io", "io.open({data!r})"),
    "pathlib": ("from pathlib import Path", "Path({data!r}).open()"),
    "importlib": ("import importlib", "importlib.import_module('io').open({data!r})"),
    "eval": ("", "eval('op' + 'en')({data!r})"),
    "builtins": ("", "__builtins__['open']({data!r})"),
    "getattr": ("import sympy", "getattr(sympy, '__builtins__')['open']({data!r})"),
    "attribute": ("import sympy", "sympy.__builtins__['open']({data!r})"),
}


@pytest.mark.parametrize("way", OPENERS)
def test_a_file_that_reads_another_is_run_every_time(cache, write, tmp_path, way):
    data = tmp_path / "rate.txt"
    statement, opened = OPENERS[way]
    text = f"{statement}\n{SPRING.format(k='rate()')}\ndef rate():\n    with "
    text += f"{opened.format(data=str(data))} as stream:\n        return float(stream.read())\n"
    for rate in ("1.5", "2.5", "3.5"):
        data.write_text(rate)
        assert load_model(write(text)).parameters == {"k": float(rate)}


def test_a_file_that_reads_the_environment_is_run_every_time(cache, write, monkeypatch):
    text = "import os\n" + SPRING.format(k="float(os.environ['RATE'])")
    for rate in ("1.5", "2.5"):
        monkeypatch.setenv("RATE", rate)
        assert load_model(write(text)).parameters == {"k": float(rate)}


IMPORTS = {
    "import": ("import stiff_helper", "stiff_helper.RATE"),
    "from": ("from stiff_helper import RATE", "RATE"),
    "inside": ("", "__import__('stiff_helper').RATE"),
    "late": ("def late():\n    import stiff_helper\n    return stiff_helper.RATE", "late()"),
}


@pytest.mark.parametrize("way", IMPORTS)
def test_a_file_that_imports_a_local_module_is_run_every_time(
    cache, write, tmp_path, monkeypatch, way
):
    statement, rate = IMPORTS[way]
    text = f"{statement}\n{SPRING.format(k=rate)}"
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    for k in (1.5, 2.5):
        (tmp_path / "stiff_helper.py").write_text(f"RATE = {k}\n")
        for module in [m for m in sys.modules if "stiff_helper" in m or "toy" in m]:
            monkeypatch.delitem(sys.modules, module)
        sys.path_importer_cache.clear()
        assert load_model(write(text)).parameters == {"k": k}


SHELVED = {
    "from the shelf": "from racs_bif.shelf.models import stiff_base\nRATE = stiff_base.RATE",
    "as a module": "import racs_bif.shelf.models.stiff_base as base\nRATE = base.RATE",
    "loaded": "import racs_bif as rb\nRATE = rb.load_model('stiff_base').parameters['k']",
    "loaded, renamed": "from racs_bif import load_model as get\nRATE = get('stiff_base').values[0]",
    "by attribute": "import racs_bif\nRATE = racs_bif.load_model('stiff_base').values[0]",
    "deep": "from racs_bif.shelf.load import load_model\nRATE = load_model('stiff_base').values[0]",
}


@pytest.mark.parametrize("way", SHELVED)
def test_a_file_that_builds_on_another_model_is_run_every_time(
    cache, write, tmp_path, monkeypatch, way
):
    monkeypatch.setenv("RACS_BIF_PATH", str(tmp_path))
    text = f"{SHELVED[way]}\n{SPRING.format(k='float(RATE)')}"
    for k in (1.5, 2.5):
        base = f"{SPRING.format(k='RATE')}\nRATE = {k}\n"
        (tmp_path / "stiff_base.py").write_text(base)
        for module in [m for m in sys.modules if "stiff_base" in m or "toy" in m]:
            monkeypatch.delitem(sys.modules, module)
        from racs_bif.shelf import models

        monkeypatch.delattr(models, "stiff_base", raising=False)
        assert load_model(write(text)).parameters == {"k": k}


@pytest.mark.parametrize(
    "statement",
    [
        "from racs_bif import Model, Parameter",
        "import racs_bif as rb\nModel, Parameter = rb.Model, rb.Parameter",
        "from racs_bif.symbolic.model import Model, Parameter",
        "import math\nfrom functools import partial\nfrom racs_bif import Model, Parameter",
    ],
)
def test_files_of_models_alone_are_run_once(cache, write, runs, statement):
    text = SPRING.format(k=2.0).replace("from racs_bif import Model, Parameter", statement)
    path = write(text)
    load_model(path)
    load_model(path)
    assert len(runs) == 1


def test_systems_from_models_in_memory():
    model = rb.model_from_strings("decay", {"x": "-k*x"}, parameters={"k": 2.0})
    system = system_of(model, parameters={"k": 3.0})
    assert system.parameters == {"k": 3.0}
    assert system_of(system) is system
    assert system_of(system, parameters={"k": 5.0}).parameters == {"k": 5.0}
    assert system.parameters == {"k": 3.0}
    with pytest.raises(UsageError, match="str is no model"):
        system_of("racs")
    with pytest.raises(ParameterError, match="unknown parameter 'q'"):
        system_of(model, parameters={"q": 1.0})


def test_every_error_is_for_users():
    for kind in (ModelError, ParameterError, UsageError):
        assert issubclass(kind, RacsBifError)
        assert issubclass(kind, ValueError)


def test_a_calibration_must_set_what_it_is_the_default_of():
    growth = sp.sympify("a + b - 2")
    x, y = sp.symbols("x y")
    model = Model(
        name="turned",
        equations={"x": growth * x - y, "y": x + growth * y},
        parameters=(
            Parameter("a", 0.0),
            Parameter("b", 1.0),
            Parameter("k", Calibration("b", {"a": 0.0}, (1.0, 3.5))),
        ),
    )
    with pytest.raises(ModelError, match="calibrating 'b' does not set 'k'"):
        system_of(model)
