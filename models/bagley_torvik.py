"""Bagley and Torvik's plate in a viscous fluid: where fractional derivatives entered mechanics.

A rigid plate on a spring, deep in a Newtonian fluid. The shear waves that it sends out pull it back
with a force that is of order 3/2 in its displacement::

    A y'' + B D^(3/2) y + C y = f

written with the velocity v = y' and w = D^(1/2) v.

Source
------
P. J. Torvik and R. L. Bagley, On the appearance of the fractional derivative in the behavior of
real materials, Journal of Applied Mechanics 51 (1984) 294-298; the numbers of I. Podlubny,
Fractional Differential Equations, Academic Press 1999, chapter 8.

Known result
------------
With A = 1, B = C = 1/2 its poles are -0.0973132111 +- 0.5668651135i. From rest, with f = 8 on
[0, 1] and 0 after, y(1) = 2.952583880, y(5) = 2.943935664, y(10) = -2.848380869 and
y(20) = -1.484329464.

Try ``racs-bif spectrum --model bagley_torvik``,
``racs-bif simulate --model bagley_torvik --set f=8 --change 1 f=0 --time 30`` and
``racs-bif continue C 0.1 2 --model bagley_torvik --set f=1 --state y``.
"""

from __future__ import annotations

from math import inf

import sympy as sp

from racs_bif import FractionalElement, Model, Parameter


def model() -> Model:
    """Build the plate."""
    y, v, w, A, B, C, f, s = sp.symbols("y v w A B C f s")
    return Model(
        name="bagley_torvik",
        equations={"y": v, "v": (f - B * w - C * y) / A},
        elements=(FractionalElement(output="w", input=v, law=sp.sqrt(s)),),
        parameters=(
            Parameter("A", 1.0, "kg", "mass of the plate", valid=(0.0, inf)),
            Parameter("B", 0.5, "kg/s^0.5", "drag of the fluid"),
            Parameter("C", 0.5, "N/m", "stiffness of the spring"),
            Parameter("f", 0.0, "N", "force on the plate"),
        ),
        units={"y": "m", "v": "m/s", "w": "m/s^1.5"},
        descriptions={"y": "displacement", "v": "velocity", "w": "D^(1/2) v"},
        title="Bagley-Torvik plate",
        source="P. J. Torvik and R. L. Bagley, J. Appl. Mech. 51 (1984) 294",
        band=(0.01, 100.0),
    )
