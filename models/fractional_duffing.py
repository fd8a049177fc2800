"""Duffing's oscillator with a springpot, free or driven.

::

    x' = y
    y' = -c D^a x - k x - b x^3 + F u

Free (the default) F = 0 is left out. The variant `driven` makes its own cosine: u and v turn with
the frequency Omega on the circle of radius sqrt(mu), which is born at a Hopf point at mu = 0::

    u' = mu u - Omega v - (u^2 + v^2) u
    v' = Omega u + mu v - (u^2 + v^2) v

so that a branch of orbits in mu is the response to a force of growing amplitude F sqrt(mu).

Source
------
J. Padovan and J. T. Sawicki, Nonlinear vibrations of fractionally damped systems, Nonlinear
Dynamics 16 (1998) 321-336.

Known result
------------
Free: a pitchfork at k = 0 (exact); the roots about x = 0 solve s^2 + c s^a + k = 0, for c = 0.2,
a = 1/2, k = 1 they are -0.0706227832 +- 1.0707870668i.
Driven with Omega = 1.5: the response jumps at folds of cycles at mu = 0.2594901223924743 and
0.0420747731813, between which it has two stable amplitudes.

Try ``racs-bif continue k -1 1 --model fractional_duffing`` and
``racs-bif continue mu -0.1 1 --model fractional_duffing --variant driven``.
"""

from __future__ import annotations

import sympy as sp

from racs_bif import FractionalElement, Model, Parameter
from racs_bif.errors import UsageError, nearest

VARIANTS = {"free": "no force: pitchfork and roots", "driven": "a cosine force: resonance, jumps"}


def model(*, variant: str = "free") -> Model:
    """Build the oscillator; `variant` is a key of `VARIANTS`."""
    if variant not in VARIANTS:
        msg = f"unknown variant '{variant}' of 'fractional_duffing'; {nearest(variant, VARIANTS)}"
        raise UsageError(msg)
    x, y, w, u, v = sp.symbols("x y w u v")
    c, a, k, b, F, mu, Omega, s = sp.symbols("c a k b F mu Omega s")
    equations = {"x": y, "y": -c * w - k * x - b * x**3}
    parameters = [
        Parameter("k", 1.0, description="stiffness"),
        Parameter("b", 1.0, description="cubic stiffness"),
        Parameter("c", 0.2, description="strength of the springpot"),
        Parameter("a", 0.5, description="order of the springpot", valid=(0.0, 1.0)),
    ]
    if variant == "driven":
        equations["y"] += F * u
        equations["u"] = mu * u - Omega * v - (u**2 + v**2) * u
        equations["v"] = Omega * u + mu * v - (u**2 + v**2) * v
        parameters += [
            Parameter("mu", -0.1, description="square of the amplitude of u"),
            Parameter("F", 1.0, description="force for u = 1"),
            Parameter("Omega", 1.5, description="frequency of the force"),
        ]
    return Model(
        name="fractional_duffing",
        equations=equations,
        elements=(FractionalElement(output="w", input=x, law=s**a),),
        parameters=tuple(parameters),
        descriptions={"x": "displacement", "y": "velocity", "w": "D^a x"},
        time_unit="",
        title="Duffing oscillator with a springpot",
        source="J. Padovan and J. T. Sawicki, Nonlinear Dynamics 16 (1998) 321",
        variant=variant,
        variants=VARIANTS,
        band=(0.01, 100.0),
    )
