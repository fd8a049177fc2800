"""The oscillator of Van der Pol: from a sine to relaxation oscillations.

The equations, with ' for the time derivative::

    x' = y
    y' = mu (g - x^2) y - x

At g = 1 they are x'' - mu (1 - x^2) x' + x = 0, the usual form. There the equilibrium is unstable
for every mu > 0, and the limit cycle is born nowhere: at mu = 0 all orbits are circles. With the
gain g of the triode there is a Hopf point, from which the cycle can be followed to g = 1.

Source
------
B. van der Pol, On relaxation-oscillations, Philosophical Magazine 2 (1926) 978-992.

Known result
------------
Hopf point at g = 0 with omega = 1 and c1 = -mu/4, supercritical (exact). At g = 1 the period is
6.2871112722887 for mu = 0.1, 6.6632868593231 for mu = 1 (there max x = 2.00861986), 11.61223066772
for mu = 5 and 19.078369566939 for mu = 10.

Try ``racs-bif continue g -0.5 1.5 --model van_der_pol --at 1``.
"""

from __future__ import annotations

import sympy as sp

from racs_bif import Model, Parameter


def model() -> Model:
    """Build the oscillator."""
    x, y, mu, g = sp.symbols("x y mu g")
    return Model(
        name="van_der_pol",
        equations={"x": y, "y": mu * (g - x**2) * y - x},
        parameters=(
            Parameter("mu", 1.0, description="strength of the nonlinear damping"),
            Parameter("g", -0.5, description="gain; 1 in the usual form"),
        ),
        descriptions={"x": "anode voltage, scaled", "y": "its rate"},
        time_unit="",
        title="Van der Pol oscillator",
        source="B. van der Pol, Phil. Mag. 2 (1926) 978",
    )
