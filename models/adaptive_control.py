"""A feedback control system of Lur'e type, the first example of the MatCont manual.

::

    x' = y
    y' = z
    z' = -alpha z - beta y - x + x^2

Source
------
R. Genesio and A. Tesi, Harmonic balance methods for the analysis of chaotic dynamics in nonlinear
systems, Automatica 28 (1992) 531-548; the MatCont manual ("adaptive control system").

Known result
------------
With beta = 1 a Hopf point at alpha = 1, omega = 1, c1 = -0.3 (exact). The cycle doubles its
period at alpha = 0.63030200616, where T = 6.36407133944; at alpha = 0 it has T = 6.43381794597
and multipliers -16.790652 and -0.059557: their product is 1, but that is no Neimark-Sacker point.

Try ``racs-bif continue alpha 0 1.5 --model adaptive_control``.
"""

from __future__ import annotations

import sympy as sp

from racs_bif import Model, Parameter


def model() -> Model:
    """Build the loop."""
    x, y, z, alpha, beta = sp.symbols("x y z alpha beta")
    return Model(
        name="adaptive_control",
        equations={"x": y, "y": z, "z": -alpha * z - beta * y - x + x**2},
        parameters=(
            Parameter("alpha", 1.5, description="damping of the acceleration"),
            Parameter("beta", 1.0, description="damping of the velocity"),
        ),
        descriptions={"x": "controlled quantity", "y": "its rate", "z": "its acceleration"},
        time_unit="",
        title="adaptive control system",
        source="R. Genesio and A. Tesi, Automatica 28 (1992) 531; MatCont manual",
    )
