import io
import sys
from types import SimpleNamespace

from racs_bif.cli.terminal import progress


class _Screen(io.StringIO):
    def isatty(self):
        return True


def _run(arguments):
    with progress(arguments) as task:
        report = task("equilibria", (5.0, 30.0))
        if report is not None:
            for value in (5.0, 30.0, 12.5):
                report(SimpleNamespace(parameter=value))
        return report


def test_a_bar_is_shown_on_an_interactive_terminal(monkeypatch):
    screen = _Screen()
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setenv("TERM", "xterm")
    assert _run(SimpleNamespace(quiet=False)) is not None
    assert "equilibria: 3 points, at 12.5" in screen.getvalue()


def test_no_bar_when_quiet_or_not_interactive(monkeypatch):
    screen = _Screen()
    monkeypatch.setattr(sys, "stderr", screen)
    assert _run(SimpleNamespace(quiet=True)) is None
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    assert _run(SimpleNamespace(quiet=False)) is None
    assert screen.getvalue() == ""
