"""Bazykin's predator and prey: saturation, and competition within both species.

::

    x' = x - x y/(1 + alpha x) - epsilon x^2
    y' = -gamma y + x y/(1 + alpha x) - delta y^2

Source
------
A. D. Bazykin, Nonlinear Dynamics of Interacting Populations, World Scientific 1998; the standard
example of two parameters in Yu. A. Kuznetsov, Elements of Applied Bifurcation Theory, Springer.

Known result
------------
With gamma = 1, epsilon = 0.01 a Bogdanov-Takens point at (alpha, delta) = (0.453624327778129,
0.175127592950217) with |a| = 0.0394530911236764, |b| = 0.0525387764928562.

Try ``racs-bif continue alpha 0.1 0.6 --model bazykin`` and
``racs-bif curve fold alpha delta --model bazykin --span alpha 0.1 0.8 --span delta 0.05 0.5``.
"""

from __future__ import annotations

import sympy as sp

from racs_bif import Model, Parameter


def model() -> Model:
    """Build the pair of populations."""
    x, y, alpha, epsilon, gamma, delta = sp.symbols("x y alpha epsilon gamma delta")
    eaten = x * y / (1 + alpha * x)
    return Model(
        name="bazykin",
        equations={"x": x - eaten - epsilon * x**2, "y": -gamma * y + eaten - delta * y**2},
        parameters=(
            Parameter("alpha", 0.3, description="saturation of the predator"),
            Parameter("delta", 0.2, description="competition among predators"),
            Parameter("epsilon", 0.01, description="competition among prey"),
            Parameter("gamma", 1.0, description="death rate of the predator"),
        ),
        guess={"x": 3.0, "y": 2.0},
        descriptions={"x": "prey", "y": "predators"},
        time_unit="",
        title="Bazykin's predator and prey",
        source="A. D. Bazykin, Nonlinear Dynamics of Interacting Populations (1998)",
    )
