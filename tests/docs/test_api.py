"""Every public name is documented, and what is documented exists."""

import inspect
import sys
from importlib import import_module
from pathlib import Path

import pytest

import racs_bif
from racs_bif import errors

docscrape = pytest.importorskip("numpydoc.docscrape")
EXTENSION = Path(__file__).parents[2] / "docs" / "_ext"


@pytest.fixture(scope="module", autouse=True)
def _extension():
    sys.path.insert(0, str(EXTENSION))
    yield
    sys.path.remove(str(EXTENSION))


def further():
    """Return what users meet besides public names: settings, results, errors."""
    sys.path.insert(0, str(EXTENSION))
    try:
        return [path for paths in import_module("api_pages").FURTHER.values() for path in paths]
    finally:
        sys.path.remove(str(EXTENSION))


PATHS = [f"racs_bif.{name}" for name in racs_bif.__all__] + further()


def find(path):
    module, _, name = path.rpartition(".")
    return getattr(import_module(module), name)


def members(thing):
    """Yield the public methods and properties that a class defines itself."""
    for name, member in vars(thing).items():
        if not name.startswith("_") and (
            inspect.isfunction(member) or isinstance(member, property)
        ):
            yield name, member


def documented(doc, *sections):
    return [
        name.strip().lstrip("*")
        for section in sections
        for entry in doc[section]
        for name in entry.name.split(",")
    ]


def parameters(thing):
    return [name for name in inspect.signature(thing).parameters if name not in {"self", "cls"}]


@pytest.mark.parametrize("path", PATHS)
def test_parameters_are_those_of_the_signature(path):
    thing = find(path)
    if inspect.isclass(thing) and issubclass(thing, Exception):
        assert inspect.getdoc(thing)
        return
    doc = (
        docscrape.FunctionDoc(thing)
        if inspect.isfunction(thing)
        else docscrape.ClassDoc(thing, config={"show_class_members": False})
    )
    assert "".join(doc["Summary"]).strip().endswith((".", ":"))
    told = documented(doc, "Parameters", "Attributes")
    assert sorted(told) == sorted(parameters(thing)), path
    for entry in doc["Parameters"]:
        assert entry.desc, (path, entry.name)
        elsewhere = entry.desc[0].startswith(("As ", "See "))
        assert entry.type or elsewhere, (path, entry.name)


@pytest.mark.parametrize("path", [p for p in PATHS if inspect.isfunction(find(p))])
def test_a_function_tells_what_it_returns_and_raises(path):
    thing = find(path)
    doc = docscrape.FunctionDoc(thing)
    assert doc["Returns"], path
    for entry in doc["Raises"]:
        for name in entry.type.split(","):
            assert issubclass(getattr(errors, name.strip()), errors.RacsBifError), (path, name)


@pytest.mark.parametrize("path", [p for p in PATHS if inspect.isclass(find(p))])
def test_every_method_is_documented(path):
    thing = find(path)
    for name, member in members(thing):
        text = inspect.getdoc(member.fget if isinstance(member, property) else member)
        assert text, f"{path}.{name} has no docstring"
        if inspect.isfunction(member):
            doc = docscrape.FunctionDoc(member)
            told = documented(doc, "Parameters")
            if told:  # one line may do for a method that is plain
                assert sorted(told) == sorted(parameters(member)), f"{path}.{name}"


def test_every_name_has_a_page_that_exists():
    pages = import_module("api_pages")
    folder = EXTENSION.parent / "reference" / "api"
    told = [path for group in pages.GROUPS for path in pages.paths(group)]
    assert len(told) == len(set(told)) == len(PATHS)
    for group in pages.GROUPS:
        assert f"<!-- fill: api {group} -->" in (folder / f"{group}.md").read_text(encoding="utf-8")
