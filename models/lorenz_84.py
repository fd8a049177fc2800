"""Lorenz's general circulation of the atmosphere of 1984, extended by a fourth mode.

Westerly wind X, two phases Y and Z of large eddies, and a baroclinic mode U::

    X' = -Y^2 - Z^2 - alpha X + alpha F - gamma U^2
    Y' = X Y - beta X Z - Y + G
    Z' = beta X Y + X Z - Z
    U' = -delta U + gamma U X + T

Source
------
E. N. Lorenz, Irregularity: a fundamental property of the atmosphere, Tellus A 36 (1984) 98-110;
with U: Yu. A. Kuznetsov, H. G. E. Meijer and L. van Veen, The fold-flip bifurcation, International
Journal of Bifurcation and Chaos 14 (2004) 2253-2282.

Known result
------------
In F: Hopf points at 2.85987541274829, 2.46722212311275 and 1.61965782094258 with omega
1.1715226466894, 0.723205920022479 and 0.295286816712987 and c1 0.303845582, -0.134874605 and
0.864734632, and a fold at 1.54664837259813. In (F, T): Bogdanov-Takens points at
(1.44671670111536, +-0.0209401696833226), zero-Hopf points at (1.28341929613827, +-1.26540834e-4).

Try ``racs-bif continue F 1 3.5 --model lorenz_84``.
"""

from __future__ import annotations

import sympy as sp

from racs_bif import Model, Parameter


def model() -> Model:
    """Build the circulation."""
    X, Y, Z, U = sp.symbols("X Y Z U")
    F, G, T, alpha, beta, gamma, delta = sp.symbols("F G T alpha beta gamma delta")
    return Model(
        name="lorenz_84",
        equations={
            "X": -(Y**2) - Z**2 - alpha * X + alpha * F - gamma * U**2,
            "Y": X * Y - beta * X * Z - Y + G,
            "Z": beta * X * Y + X * Z - Z,
            "U": -delta * U + gamma * U * X + T,
        },
        parameters=(
            Parameter("F", 2.0, description="heating between equator and pole"),
            Parameter("G", 0.25, description="heating between sea and land"),
            Parameter("T", 0.04, description="forcing of the fourth mode"),
            Parameter("alpha", 0.25, description="damping of the westerlies"),
            Parameter("beta", 1.0, description="displacement of the eddies by the westerlies"),
            Parameter("gamma", 0.987, description="coupling of the fourth mode"),
            Parameter("delta", 1.04, description="damping of the fourth mode"),
        ),
        guess={"X": 1.1, "Z": 0.2, "U": -0.4},
        descriptions={
            "X": "westerly wind",
            "Y": "eddies, cosine phase",
            "Z": "eddies, sine phase",
            "U": "baroclinic mode",
        },
        time_unit="",
        title="Lorenz-84 circulation, extended",
        source="E. N. Lorenz, Tellus A 36 (1984) 98; Kuznetsov, Meijer and van Veen (2004)",
    )
