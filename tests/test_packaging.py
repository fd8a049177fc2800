"""What is promised about installing: README's commands, dependencies, the wheel, start-up."""

import ast
import os
import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

import racs_bif

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
SLOW = ("numpy", "scipy", "sympy", "matplotlib", "control", "xarray", "pandas", "h5py", "rich")
MAIN = "pip install . && python -m racs_bif continue u 5 30"
TESTS = 'pip install -e ".[test]" && python -m pytest'
OWN = {"racs_bif", "models", "analyses"}
OPTIONAL = {"flint", "distributed", "plotly"}  # of extras; where one is missing, a user is told so


def run(*command, **options):
    return subprocess.run(command, capture_output=True, text=True, check=False, **options)


def python(code, **options):
    done = run(sys.executable, "-c", code, **options)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def distribution(requirement):
    return re.match(r"[\w.-]+", requirement)[0].lower()


# ------------------------------------------------------------------------------------- README


@pytest.mark.parametrize(
    ("name", "command"),
    [("main", MAIN), ("tests", TESTS)],
)
def test_the_gate_reads_its_commands_from_the_readme(name, command):
    done = run("bash", str(ROOT / ".ci" / "command"), name)
    assert (done.returncode, done.stdout.strip()) == (0, command)


def test_the_gate_fails_without_its_command():
    done = run("bash", str(ROOT / ".ci" / "command"), "nothing")
    assert done.returncode != 0
    assert "no block" in done.stderr


def test_the_readme_has_exactly_two_set_up_commands():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert text.count("<!-- ci: ") == 2
    assert re.findall(r"^pip install.*$", text, re.MULTILINE) == [MAIN, TESTS]


# ------------------------------------------------------------------------------- dependencies


def imported(folder):
    """Yield every top-level name that a folder's files import outside type checking."""
    for file in (ROOT / folder).rglob("*.py"):
        for node in at_run_time(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                yield from ((alias.name.partition(".")[0], file) for alias in node.names)
            elif isinstance(node, ast.ImportFrom):
                yield node.module.partition(".")[0], file


def at_run_time(node):
    yield node
    for child in ast.iter_child_nodes(node):
        typing_only = isinstance(child, ast.If) and ast.unparse(child.test) == "TYPE_CHECKING"
        if not typing_only:
            yield from at_run_time(child)


def test_every_import_is_declared():
    declared = {distribution(requirement) for requirement in PROJECT["dependencies"]}
    allowed = declared | set(sys.stdlib_module_names) | OWN | OPTIONAL
    found = [pair for folder in OWN for pair in imported(folder)]
    undeclared = {(name, str(file)) for name, file in found if name not in allowed}
    assert len(found) > 100  # the search works
    assert not undeclared


def test_every_dependency_is_justified():
    text = (ROOT / "docs" / "dependencies.md").read_text(encoding="utf-8")
    extras = PROJECT["optional-dependencies"].values()
    required = [r for group in (PROJECT["dependencies"], *extras) for r in group]
    declared = {distribution(requirement) for requirement in required} - {"racs-bif"}
    justified = set(re.findall(r"^\| `([\w-]+)` \|", text, re.MULTILINE))
    assert justified == declared


# ---------------------------------------------------------------------------------- the wheel


def build(version, folder):
    hook = f"import hatchling.build as b; print(b.build_{version}({str(folder)!r}))"
    wheel = folder / python(hook, cwd=ROOT).splitlines()[-1]
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder / "site")
        return set(archive.namelist())


def test_a_wheel_carries_the_models(tmp_path):
    contents = build("wheel", tmp_path)
    assert "racs_bif/_models/racs.py" in contents
    assert "racs_bif/py.typed" in contents
    sources = {f"racs_bif/_models/{file.name}" for file in (ROOT / "models").glob("*.py")}
    sources |= {f"racs_bif/_analyses/{file.name}" for file in (ROOT / "analyses").glob("*.py")}
    sources |= {str(file.relative_to(ROOT)) for file in (ROOT / "racs_bif").rglob("*.py")}
    assert {name for name in contents if name.endswith(".py")} == sources

    ask = "import racs_bif.shelf as s; print(s.load_module(s.find('models', 'racs')).__file__)"
    site = tmp_path / "site"
    file = python(ask, cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(site)})
    assert Path(file) == site / "racs_bif" / "_models" / "racs.py"


def test_an_editable_install_reads_the_checkout(tmp_path):
    contents = build("editable", tmp_path)
    assert not any("_models" in name for name in contents)
    links = [name for name in contents if name.endswith(".pth")]
    assert [(tmp_path / "site" / link).read_text().strip() for link in links] == [str(ROOT)]


def test_the_version_is_written_once():
    assert "version" in PROJECT["dynamic"]
    written = [
        file
        for file in (ROOT / "racs_bif").rglob("*.py")
        if racs_bif.__version__ in file.read_text(encoding="utf-8")
    ]
    assert written == [ROOT / "racs_bif" / "__init__.py"]


# --------------------------------------------------------------------------- the public names


@pytest.mark.parametrize("name", racs_bif.__all__)
def test_every_public_name_can_be_imported(name):
    thing = getattr(racs_bif, name)
    assert thing.__name__ == name
    assert thing.__doc__
    assert name in dir(racs_bif)


def test_the_tables_of_public_names_agree():
    tree = ast.parse(Path(racs_bif.__file__).read_text(encoding="utf-8"))
    block = next(n for n in tree.body if isinstance(n, ast.If))
    typed = {alias.name: node.module for node in block.body for alias in node.names}
    assert typed == racs_bif._HOMES
    assert sorted(typed) == racs_bif.__all__


def test_an_unknown_name_is_refused():
    with pytest.raises(AttributeError, match="no attribute 'continue_everything'"):
        racs_bif.continue_everything  # noqa: B018  # the access is what is tested


# ----------------------------------------------------------------------------------- start-up


@pytest.mark.parametrize("statement", ["import racs_bif", "import racs_bif.shelf"])
def test_importing_the_package_loads_nothing_slow(statement):
    slow = f"import sys; {statement}; print([m for m in {SLOW!r} if m in sys.modules])"
    assert python(slow, cwd=ROOT) == "[]"


def test_help_loads_nothing_slow():
    code = (
        "import atexit, runpy, sys\n"
        f"show = lambda: print('LOADED', [m for m in {SLOW!r} if m in sys.modules])\n"
        "atexit.register(show)\n"
        "sys.argv = ['racs-bif', '--help']\n"
        "runpy.run_module('racs_bif', run_name='__main__')\n"
    )
    output = python(code, cwd=ROOT)
    assert "continue" in output
    assert output.splitlines()[-1] == "LOADED []"
