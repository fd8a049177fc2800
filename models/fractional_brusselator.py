"""The Brusselator with fractional orders: memory keeps the reaction at rest for longer.

::

    D^alpha x = A - (B + 1) x + x^2 y
    D^beta y = B x - x^2 y

x and y are the outputs of integrators s^-alpha and s^-beta; with alpha = beta = 1 it is the
Brusselator.

Source
------
Y. Wang and C. Li, Does the fractional Brusselator with efficient dimension less than 1 have a limit
cycle?, Physics Letters A 363 (2007) 414-419.

Known result
------------
With alpha = beta a Hopf point at B = 1 + A^2 + 2 A cos(alpha pi/2) with omega = A^(1/alpha)
(exact): 2.3128689301 for A = 1, alpha = 0.9, and 5.3138363829 with omega = 2.0743100889 for A =
2, alpha = 0.95. For the orders 0.8 and 0.9 and A = 1 it is at 2.456314723 with omega =
1.123584120.

Try ``racs-bif continue B 1.5 3.5 --model fractional_brusselator``.
"""

from __future__ import annotations

from math import inf

import sympy as sp

from racs_bif import FractionalElement, Model, Parameter


def model() -> Model:
    """Build the reaction."""
    x, y, A, B, alpha, beta, s = sp.symbols("x y A B alpha beta s")
    return Model(
        name="fractional_brusselator",
        equations={},
        elements=(
            FractionalElement(output="x", input=A - (B + 1) * x + x**2 * y, law=s**-alpha),
            FractionalElement(output="y", input=B * x - x**2 * y, law=s**-beta),
        ),
        parameters=(
            Parameter("A", 1.0, description="concentration of A", valid=(0.0, inf)),
            Parameter("B", 1.5, description="concentration of B"),
            Parameter("alpha", 0.9, description="order of the first derivative", valid=(0.0, 1.0)),
            Parameter("beta", 0.9, description="order of the second derivative", valid=(0.0, 1.0)),
        ),
        guess={"x": 1.0, "y": 1.5},
        descriptions={"x": "concentration of X", "y": "concentration of Y"},
        time_unit="",
        title="Brusselator of fractional orders",
        source="Y. Wang and C. Li, Phys. Lett. A 363 (2007) 414",
        band=(0.01, 100.0),
    )
