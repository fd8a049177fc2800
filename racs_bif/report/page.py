"""One page of HTML that holds a diagram, its script and Plotly, and asks nothing of any network."""

from __future__ import annotations

import json
from html import escape
from importlib.resources import files
from string import Template
from typing import TYPE_CHECKING, Final

from racs_bif.errors import UsageError
from racs_bif.report import tables
from racs_bif.report.data import page_data, quantities

if TYPE_CHECKING:
    from collections.abc import Sequence

    from racs_bif.results.diagram import Diagram

SCRIPTS: Final = ("diagram.js", "panels.js", "vehicle.js", "page.js")
_MISSING: Final = "the report needs Plotly, which is not installed; pip install 'racs-bif[report]'"


def page(diagram: Diagram, command: Sequence[str] | None = None, state: str | None = None) -> str:
    """Return a diagram as one self-contained page of HTML.

    Nothing is loaded from anywhere: script, style, numbers and Plotly are part of it, and its
    content security policy forbids every request.

    Parameters
    ----------
    diagram : Diagram
        Branches of one system.
    command : sequence of str, optional
        The arguments it was computed with.
    state : str, optional
        The quantity on the vertical axis to begin with. By default what the model suggests.

    Returns
    -------
    str
        The page.

    Raises
    ------
    UsageError
        If Plotly is not installed, or no branch has the quantity.
    """
    plotly = plotly_script()
    system = diagram.branches[0].system
    data = page_data(diagram, _shown(diagram, state))
    numbers = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    variant = f", variant {system.variant}" if system.variant else ""
    return Template(_part("page.html")).substitute(
        title=escape(f"{system.model}: bifurcation diagram"),
        heading=escape(f"{system.title or system.model}{variant}"),
        style=_part("page.css"),
        layout="with-vehicle" if data["vehicle"] is not None else "without-vehicle",
        special=tables.special_table(diagram),
        branches=tables.branch_table(diagram),
        origin=tables.origin_table(diagram, command),
        parameters=tables.parameter_table(diagram),
        notes=tables.notes(system),
        # a script ends at the first such tag, wherever it stands
        data=numbers.replace("</", "<\\/"),
        plotly=plotly,
        script="\n".join(_part(name) for name in SCRIPTS),
    )


def plotly_script() -> str:
    """Return Plotly's script.

    Raises
    ------
    UsageError
        If Plotly is not installed.
    """
    try:
        from plotly.offline import get_plotlyjs
    except ImportError as error:
        raise UsageError(_MISSING) from error
    return str(get_plotlyjs())


def _shown(diagram: Diagram, state: str | None) -> str:
    """Return the quantity on the vertical axis.

    Raises
    ------
    UsageError
        If no branch has the one that is wanted.
    """
    from racs_bif.errors import nearest

    known = list(dict.fromkeys(name for branch in diagram for name in quantities(branch)))
    suggested = diagram.branches[0].system.shown
    if state is None:
        return suggested if suggested in known else known[0]
    if state not in known:
        msg = f"nothing called '{state}' to show; {nearest(state, known)}"
        raise UsageError(msg)
    return state


def _part(name: str) -> str:
    return files("racs_bif.report").joinpath(name).read_text(encoding="utf-8")
