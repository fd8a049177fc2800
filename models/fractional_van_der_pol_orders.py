"""Van der Pol's oscillator with both integrators of one fractional order q.

::

    D^q x = y
    D^q y = -x - epsilon (x^2 - 1) y

Below q = 1 every rate is taken back a little by memory, and a low enough order holds the oscillator
at rest. x and y are the outputs of two integrators s^-q.

Source
------
R. S. Barbosa, J. A. T. Machado, B. M. Vinagre and A. J. Calderon, Analysis of the Van der Pol
oscillator containing derivatives of fractional order, Journal of Vibration and Control 13 (2007)
1291-1301; the condition |arg lambda| = q pi/2 is D. Matignon's (1996).

Known result
------------
Hopf point at q = (2/pi) acos(epsilon/2) with omega = 1 (exact): 0.8391387535 for epsilon = 0.5,
2/3 for epsilon = 1, 0.4601069123 for epsilon = 1.5.

Try ``racs-bif continue q 0.5 0.95 --model fractional_van_der_pol_orders``.
"""

from __future__ import annotations

import sympy as sp

from racs_bif import FractionalElement, Model, Parameter


def model() -> Model:
    """Build the oscillator."""
    x, y, epsilon, q, s = sp.symbols("x y epsilon q s")
    return Model(
        name="fractional_van_der_pol_orders",
        equations={},
        elements=(
            FractionalElement(output="x", input=y, law=s**-q),
            FractionalElement(output="y", input=-x - epsilon * (x**2 - 1) * y, law=s**-q),
        ),
        parameters=(
            Parameter("q", 0.6, description="order of both derivatives", valid=(0.0, 1.0)),
            Parameter("epsilon", 1.0, description="strength of the nonlinear damping"),
        ),
        descriptions={"x": "displacement", "y": "its derivative of order q"},
        time_unit="",
        title="Van der Pol oscillator of fractional order",
        source="R. S. Barbosa et al., J. Vib. Control 13 (2007) 1291",
        band=(0.01, 100.0),
    )
