"""Van der Pol's oscillator held by a springpot: a half-order element against negative damping.

::

    x' = y
    y' = mu (1 - x^2) y - c w - x,   w = D^a x

The springpot c D^a x is a spring at a = 0 and a dashpot at a = 1.

Source
------
After R. S. Barbosa, J. A. T. Machado, B. M. Vinagre and A. J. Calderon, Analysis of the Van der Pol
oscillator containing derivatives of fractional order, Journal of Vibration and Control 13 (2007)
1291-1301.

Known result
------------
A Hopf point where omega^2 = 1 + c omega^a cos(a pi/2), mu = c omega^(a-1) sin(a pi/2) (exact): with
a = c = 1/2 at mu = 0.3259981216, omega = 1.1761963238. The steady orbit has the frequency
1.1758762053 and max x = 0.8601611934 at mu = 0.4, and 1.1503136123 and 1.6432206 at mu = 1.

Try ``racs-bif continue mu 0.1 1 --model fractional_van_der_pol --orbits harmonic-balance``.
"""

from __future__ import annotations

import sympy as sp

from racs_bif import FractionalElement, Model, Parameter


def model() -> Model:
    """Build the oscillator."""
    x, y, w, mu, c, a, s = sp.symbols("x y w mu c a s")
    return Model(
        name="fractional_van_der_pol",
        equations={"x": y, "y": mu * (1 - x**2) * y - c * w - x},
        elements=(FractionalElement(output="w", input=x, law=s**a),),
        parameters=(
            Parameter("mu", 0.2, description="negative damping"),
            Parameter("c", 0.5, description="strength of the springpot"),
            Parameter("a", 0.5, description="order of the springpot", valid=(0.0, 1.0)),
        ),
        descriptions={"x": "displacement", "y": "velocity", "w": "D^a x"},
        time_unit="",
        title="Van der Pol oscillator with a springpot",
        source="after R. S. Barbosa et al., J. Vib. Control 13 (2007) 1291",
        band=(0.01, 100.0),
    )
