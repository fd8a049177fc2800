"""Rosenzweig and MacArthur's predator and prey, and the paradox of enrichment.

Prey x grows logistically and is eaten by y with saturation (Holling's second type)::

    x' = r x (1 - x/K) - a x y/(1 + a h x)
    y' = e a x y/(1 + a h x) - m y

Source
------
M. L. Rosenzweig and R. H. MacArthur, Graphical representation and stability conditions of
predator-prey interactions, The American Naturalist 97 (1963) 209-223; M. L. Rosenzweig, Paradox of
enrichment, Science 171 (1971) 385-387.

Known result
------------
The predator lives on x* = m/(a (e - m h)). It enters where K = x* (a branch point), and the
equilibrium begins to oscillate where K = 2 x* + 1/(a h) (a supercritical Hopf point): more food
makes the pair unstable. With the numbers below K = 1, and K = 3 with omega = 1/sqrt(6) (exact).

Try ``racs-bif continue K 0.5 6 --model rosenzweig_macarthur``.
"""

from __future__ import annotations

from math import inf

import sympy as sp

from racs_bif import Model, Parameter


def model() -> Model:
    """Build the pair of populations."""
    x, y, r, K, a, h, e, m = sp.symbols("x y r K a h e m")
    eaten = a * x * y / (1 + a * h * x)
    return Model(
        name="rosenzweig_macarthur",
        equations={"x": r * x * (1 - x / K) - eaten, "y": e * eaten - m * y},
        parameters=(
            Parameter("K", 2.0, description="prey that the land can feed", valid=(0.0, inf)),
            Parameter("r", 1.0, description="growth rate of the prey"),
            Parameter("a", 1.0, description="search rate of the predator"),
            Parameter("h", 1.0, description="time to handle one prey"),
            Parameter("e", 1.0, description="predators made of one prey"),
            Parameter("m", 0.5, description="death rate of the predator"),
        ),
        guess={"x": 1.0, "y": 1.0},
        descriptions={"x": "prey", "y": "predators"},
        time_unit="",
        title="Rosenzweig-MacArthur predator and prey",
        source="M. L. Rosenzweig and R. H. MacArthur, Am. Nat. 97 (1963) 209",
    )
