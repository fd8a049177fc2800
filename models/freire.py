"""Freire's electronic oscillator: three states, odd symmetry, and nearly everything cycles can do.

::

    r x' = -(beta + nu) x + beta y - a_3 x^3 + b_3 (y - x)^3
      y' = beta x - (beta + gamma) y - z - b_3 (y - x)^3
      z' = y

Source
------
E. Freire, A. Rodriguez-Luis, E. Gamero and E. Ponce, A case study for homoclinic chaos in an
autonomous electronic circuit, Physica D 62 (1993) 230-253; the MatCont manual.

Known result
------------
In nu a Hopf point at -0.589336477991794 (omega 0.773448606134865, c1 -0.456363001829). Its cycles
have a fold at -0.584334771866 (T = 8.42647292) and break their symmetry at a branch point at
-0.587028974365 (T = 8.68966962). On the branch that leaves there is a Neimark-Sacker point at
-0.591650195032 and a period doubling at -0.614955221138.

Try ``racs-bif continue nu -0.75 -0.45 --model freire --orbits collocation``.
"""

from __future__ import annotations

from math import inf

import sympy as sp

from racs_bif import Model, Parameter


def model() -> Model:
    """Build the circuit."""
    x, y, z = sp.symbols("x y z")
    nu, beta, gamma, r, a_3, b_3 = sp.symbols("nu beta gamma r a_3 b_3")
    across = b_3 * (y - x) ** 3
    return Model(
        name="freire",
        equations={
            "x": (-(beta + nu) * x + beta * y - a_3 * x**3 + across) / r,
            "y": beta * x - (beta + gamma) * y - z - across,
            "z": y,
        },
        parameters=(
            Parameter("nu", -0.7, description="linear conductance of the active element"),
            Parameter("beta", 0.5, description="coupling conductance"),
            Parameter("gamma", -0.6, description="conductance across the coil"),
            Parameter("r", 0.6, description="ratio of the capacitors", valid=(0.0, inf)),
            Parameter("a_3", 0.328578, description="cubic conductance of the active element"),
            Parameter("b_3", 0.933578, description="cubic coupling conductance"),
        ),
        descriptions={"x": "first voltage", "y": "second voltage", "z": "current of the coil"},
        time_unit="",
        title="Freire's circuit",
        source="E. Freire et al., Physica D 62 (1993) 230",
    )
