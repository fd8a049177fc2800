"""What hostile models are given to: the library, and the command line."""

import pytest

import racs_bif as rb
from racs_bif.cli.main import main
from racs_bif.errors import RacsBifError


@pytest.fixture
def follow():
    """Continue the equilibria of equations; return the branch, or the error's one line."""

    def run(equations, parameter="a", span=(-1.0, 1.0), **options):
        options.setdefault("parameters", {"a": 1.0})
        try:
            model = rb.model_from_strings("hostile", equations, **options)
            return rb.continue_equilibria(model, parameter, span)
        except RacsBifError as error:
            return str(error)

    return run


@pytest.fixture
def command(tmp_path, monkeypatch, capsys):
    """Run `continue` on the text of a model's file; return the exit status and what it says."""
    monkeypatch.chdir(tmp_path)

    def run(text, name="hostile.py", parameter="a", span=("-1", "1")):
        (tmp_path / name).write_text(text, encoding="utf-8")
        words = ["continue", parameter, *span, "--model", name, "--orbits", "none"]
        status = main([*words, "--probes", "0", "--quiet"])
        said = capsys.readouterr()
        assert "Traceback" not in said.err
        assert "internal error" not in said.err
        return status, said.err.strip()

    return run
