"""Langford's system: a torus whose beginning is known exactly.

::

    x' = (z - 0.7) x - omega y
    y' = omega x + (z - 0.7) y
    z' = 0.6 + alpha z - z^3/3 - (x^2 + y^2) (1 + rho z)

The circle z = 0.7, x^2 + y^2 = (0.6 + 0.7 alpha - 0.343/3)/(1 + 0.7 rho) is an orbit.

Source
------
W. F. Langford, Numerical studies of torus bifurcations, in: Numerical Methods for Bifurcation
Problems, Birkhaeuser 1984, 285-295.

Known result
------------
The circle is born at a Hopf point at alpha = (0.343/3 - 0.6)/0.7 with the frequency omega, and a
torus leaves it at a Neimark-Sacker point at alpha = 0.49 + (1.457/3 + 0.343) rho, T = 2 pi/omega
(exact). With alpha = 0.95 that is rho = 0.55510860820595.

Try ``racs-bif continue alpha -1.5 1.2 --model langford``.
"""

from __future__ import annotations

import sympy as sp

from racs_bif import Model, Parameter


def model() -> Model:
    """Build the system."""
    x, y, z, alpha, omega, rho = sp.symbols("x y z alpha omega rho")
    b, c = sp.Rational(7, 10), sp.Rational(6, 10)
    return Model(
        name="langford",
        equations={
            "x": (z - b) * x - omega * y,
            "y": omega * x + (z - b) * y,
            "z": c + alpha * z - z**3 / 3 - (x**2 + y**2) * (1 + rho * z),
        },
        parameters=(
            Parameter("alpha", -1.0, description="growth of z"),
            Parameter("omega", 3.5, description="frequency of the circle"),
            Parameter("rho", 0.6, description="coupling of radius and z"),
        ),
        guess={"z": 0.55},
        descriptions={
            "x": "first coordinate in the plane of rotation",
            "y": "second coordinate in the plane of rotation",
            "z": "growth rate of the rotation, plus 0.7",
        },
        time_unit="",
        title="Langford's torus",
        source="W. F. Langford, in: Numerical Methods for Bifurcation Problems (1984)",
    )
