"""Roessler's equation for continuous chaos.

::

    x' = -y - z
    y' = x + a y
    z' = b + z (x - c)

Source
------
O. E. Roessler, An equation for continuous chaos, Physics Letters A 57 (1976) 397-398.

Known result
------------
With b = 0.2, c = 5.7 the inner equilibrium has a Hopf point at a = 0.00597844185, supercritical.
Its cycle doubles its period at a = 0.109638936518 (T = 6.04813182766), on the way to chaos; at a
= 0.2, Roessler's value, it has T = 5.88108845555 and the multiplier -2.40395353.

Try ``racs-bif continue a 0.001 0.2 --model roessler``.
"""

from __future__ import annotations

import sympy as sp

from racs_bif import Model, Parameter


def model() -> Model:
    """Build the equations."""
    x, y, z, a, b, c = sp.symbols("x y z a b c")
    return Model(
        name="roessler",
        equations={"x": -y - z, "y": x + a * y, "z": b + z * (x - c)},
        parameters=(
            Parameter("a", 0.002, description="excitation of the spiral"),
            Parameter("b", 0.2, description="inflow of z"),
            Parameter("c", 5.7, description="where z begins to grow"),
        ),
        guess={"y": -0.035, "z": 0.035},
        descriptions={
            "x": "first coordinate in the plane of rotation",
            "y": "second coordinate in the plane of rotation",
            "z": "what folds the spiral back",
        },
        time_unit="",
        title="Roessler equations",
        source="O. E. Roessler, Phys. Lett. A 57 (1976) 397",
    )
