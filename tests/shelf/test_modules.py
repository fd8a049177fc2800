import importlib
import multiprocessing
import pickle
import sys
from concurrent.futures import ProcessPoolExecutor

import pytest

from racs_bif.errors import ModelError
from racs_bif.shelf import find, load_module


def test_a_file_of_the_package_is_imported_by_name():
    module = load_module(find("models", "racs"))
    assert module.__name__ == "racs_bif.shelf.models.racs"
    assert callable(module.model)
    assert load_module(find("models", "racs")) is module


def test_it_can_be_imported_by_statement():
    from racs_bif.shelf.models import racs

    assert racs is load_module(find("models", "racs"))


@pytest.mark.parametrize("folder", ["plain", "with.dots and %2E"])
def test_any_file_is_imported_by_its_path(tmp_path, folder, model_source):
    file = tmp_path / folder / "my.duffing.py"
    file.parent.mkdir()
    file.write_text(model_source.format(name="duffing"), encoding="utf-8")
    module = load_module(file)
    assert module.model() == "duffing"
    assert module.__file__ == str(file)
    assert pickle.loads(pickle.dumps(module.model)) is module.model


def test_two_files_of_one_name_are_two_modules(tmp_path, model_source):
    modules = []
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        file = tmp_path / name / "duffing.py"
        file.write_text(model_source.format(name=name), encoding="utf-8")
        modules.append(load_module(file))
    assert [module.model() for module in modules] == ["one", "two"]


def test_an_edit_is_seen_at_once(tmp_path, model_source):
    file = tmp_path / "duffing.py"
    for name in ("old", "new"):  # same length, same second
        file.write_text(model_source.format(name=name), encoding="utf-8")
        assert load_module(file).model() == name
    assert not (tmp_path / "__pycache__").exists()


@pytest.mark.parametrize("shelved", [True, False])
def test_functions_reach_a_spawned_worker(tmp_path, shelve, shelved, analysis_source):
    (tmp_path / "analyses").mkdir()
    file = tmp_path / "analyses" / "sweep.py"
    file.write_text(analysis_source, encoding="utf-8")
    if shelved:
        shelve(tmp_path)
    module = load_module(file)
    expected = "racs_bif.shelf.analyses.sweep" if shelved else "racs_bif.shelf.files."
    assert module.__name__.startswith(expected)
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        assert list(pool.map(module.cube, [2, 3])) == [8, 27]


@pytest.mark.parametrize(
    ("source", "complaint"),
    [
        ("x = 1\ny = x / 0\n", "line 2 raises ZeroDivisionError: division by zero"),
        ("def model(:\n", "line 1 raises SyntaxError: invalid syntax"),
        ("import no_such_package\n", "line 1 raises ModuleNotFoundError: No module named"),
        ("raise ValueError('two\\nlines')\n", "line 1 raises ValueError: two lines"),
        ("raise SystemExit(3)\n", "line 1 raises SystemExit: 3"),
        ("def f():\n    raise KeyError\n\n\nf()\n", "line 2 raises KeyError"),
    ],
)
def test_a_file_that_raises_is_one_line(tmp_path, source, complaint):
    file = tmp_path / "broken.py"
    file.write_text(source, encoding="utf-8")
    with pytest.raises(ModelError) as caught:
        load_module(file)
    message = str(caught.value)
    assert message.startswith(f"{file} cannot be used, {complaint}")
    assert "\n" not in message
    assert not any(tmp_path.name in name for name in sys.modules)


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(ModelError, match="there is no file"):
        load_module(tmp_path / "gone.py")


def test_nothing_else_is_found():
    for name in ("models.gone", "files.gone", "elsewhere.racs"):
        with pytest.raises(ModuleNotFoundError):
            importlib.import_module(f"racs_bif.shelf.{name}")


def test_only_the_folders_of_the_shelf_are_looked_into():
    from racs_bif.shelf.modules import _Finder

    assert _Finder.find_spec("racs_bif.shelf.models.racs") is not None
    assert _Finder.find_spec("racs_bif.shelf.recipes.racs") is None
    assert _Finder.find_spec("racs_bif.models.racs") is None
