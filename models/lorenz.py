"""Lorenz's three equations of convection.

::

    x' = sigma (y - x)
    y' = r x - y - x z
    z' = x y - b z

Source
------
E. N. Lorenz, Deterministic nonperiodic flow, Journal of the Atmospheric Sciences 20 (1963) 130-141;
C. Sparrow, The Lorenz Equations, Springer 1982.

Known result
------------
With sigma = 10, b = 8/3: pitchfork at r = 1, and on the branches x = y = +-sqrt(b (r - 1)) that
leave it Hopf points at r = sigma (sigma + b + 3)/(sigma - b - 1) = 470/19, where
omega^2 = b (r + sigma) = 1760/19; they are subcritical. The orbits born there end in the homoclinic
orbit at r = 13.926557407520.

Try ``racs-bif continue r 0 30 --model lorenz``.
"""

from __future__ import annotations

import sympy as sp

from racs_bif import Model, Parameter


def model() -> Model:
    """Build the equations."""
    x, y, z, sigma, r, b = sp.symbols("x y z sigma r b")
    return Model(
        name="lorenz",
        equations={"x": sigma * (y - x), "y": r * x - y - x * z, "z": x * y - b * z},
        parameters=(
            Parameter("r", 0.5, description="Rayleigh number over its critical value"),
            Parameter("sigma", 10.0, description="Prandtl number"),
            Parameter("b", 8 / 3, description="shape of the convection cell"),
        ),
        descriptions={
            "x": "speed of the convection",
            "y": "temperature between rising and sinking fluid",
            "z": "distortion of the vertical temperature profile",
        },
        time_unit="",
        title="Lorenz equations",
        source="E. N. Lorenz, J. Atmos. Sci. 20 (1963) 130",
    )
