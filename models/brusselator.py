"""The Brusselator: a chemical reaction that begins to oscillate, everything in closed form.

The concentrations x and y of two intermediates, with A and B held constant::

    x' = A - (B + 1) x + x^2 y
    y' = B x - x^2 y

Equilibrium: x = A, y = B/A.

Source
------
I. Prigogine and R. Lefever, Symmetry breaking instabilities in dissipative systems II, Journal of
Chemical Physics 48 (1968) 1695-1700.

Known result
------------
Hopf point at B = 1 + A^2 with omega = A, supercritical; for A = 1 at B = 2 with c1 = -1/2 (exact).
The cycle of A = 1 has the period 6.577284341906 at B = 2.5 and 7.15691992118 at B = 3.

Try ``racs-bif continue B 1 4 --model brusselator``.
"""

from __future__ import annotations

from math import inf

import sympy as sp

from racs_bif import Model, Parameter


def model() -> Model:
    """Build the reaction."""
    x, y, A, B = sp.symbols("x y A B")
    return Model(
        name="brusselator",
        equations={"x": A - (B + 1) * x + x**2 * y, "y": B * x - x**2 * y},
        parameters=(
            Parameter("A", 1.0, description="concentration of A", valid=(0.0, inf)),
            Parameter("B", 1.5, description="concentration of B"),
        ),
        guess={"x": 1.0, "y": 1.5},
        descriptions={"x": "concentration of X", "y": "concentration of Y"},
        time_unit="",
        title="Brusselator",
        source="I. Prigogine and R. Lefever, J. Chem. Phys. 48 (1968) 1695",
    )
