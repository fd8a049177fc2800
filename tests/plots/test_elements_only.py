"""What is drawn where the model's first choice is nothing to look at."""

from __future__ import annotations

import pytest

import racs_bif as rb
from racs_bif.plots.diagram import shown_quantity


@pytest.mark.parametrize(
    ("name", "values", "parameter", "span", "shown"),
    [
        ("bagley_torvik", {"f": 1.0}, "C", (0.1, 2.0), "y"),  # its element's input v is zero
        ("fractional_brusselator", {}, "B", (2.0, 2.2), "y"),  # x = A, and no state is its own
        ("racs", {}, "u", (9.0, 11.0), "delta_c"),
    ],
)
def test_a_flat_line_is_not_shown(name, values, parameter, span, shown):
    branch = rb.continue_equilibria(rb.load_model(name, parameters=values), parameter, span)
    assert shown_quantity(rb.Diagram(branch)) == shown
