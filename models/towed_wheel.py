"""Shimmy of a towed wheel: a rigid wheel on a caster whose king pin gives way.

The king pin is towed at the speed v and held sideways by a spring k and a damper d at the lateral
displacement y. Behind it, at the distance l, the wheel touches the ground in one point; the centre
of gravity of wheel and caster (mass m, moment of inertia J about it) is at the distance b::

    <-- v   king pin --------- G --------- wheel
               |----- b -----|               |
               |-------------- l ------------|

The point of contact does not slip sideways, which fixes the rate of y (psi is the caster angle)::

    psi' = omega
    y'   = v tan psi + l omega/cos psi
    M omega' = -m p (v omega/cos^2 psi + (l tan psi/cos psi + b sin psi) omega^2)
               - m b^2 omega^2 sin psi cos psi - (k y + d y') l/cos psi
    M = J + m (b^2 sin^2 psi + p^2),   p = l/cos psi - b cos psi

(Jourdain's principle; the spin of the wheel does not couple to psi.)

Source
------
G. Stepan, Chaotic motion of wheels, Vehicle System Dynamics 20 (1991) 341-351; D. Takacs, G. Stepan
and S. J. Hogan, Isolated large amplitude periodic motions of towed rigid wheels, Nonlinear Dynamics
52 (2008) 27-34.

Known result
------------
With I = J + m (l - b)^2 straight running has a Hopf point where
(m v (l - b) + d l^2) (k l + d v) = I k v, with omega^2 = k l v/(m v (l - b) + d l^2) (exact). The
numbers below have b = l, for which v = d l^3 k/(J k - d^2 l^2) = 40/9 m/s, omega = 200/3 rad/s, and
it is subcritical: shimmy is there already from the fold of cycles at v = 3.5428321910 m/s on.

Try ``racs-bif continue v 1 8 --model towed_wheel``.
"""

from __future__ import annotations

from math import inf

import sympy as sp

from racs_bif import Model, Parameter


def model() -> Model:
    """Build the wheel."""
    psi, omega, y = sp.symbols("psi omega y")
    v, m, J, b, l, k, d = sp.symbols("v m J b l k d")
    sine, cosine = sp.sin(psi), sp.cos(psi)
    rate = v * sine / cosine + l * omega / cosine
    arm = l / cosine - b * cosine  # dy'_G/domega, y_G the lateral position of G
    bent = l * sine / cosine**2 + b * sine
    moment = -m * arm * (v * omega / cosine**2 + bent * omega**2)
    moment -= m * b**2 * omega**2 * sine * cosine + (k * y + d * rate) * l / cosine
    return Model(
        name="towed_wheel",
        equations={
            "psi": omega,
            "omega": moment / (J + m * (b**2 * sine**2 + arm**2)),
            "y": rate,
        },
        parameters=(
            Parameter("v", 1.0, "m/s", "towing speed", valid=(0.0, inf)),
            Parameter("m", 10.0, "kg", "mass of wheel and caster", valid=(0.0, inf)),
            Parameter("J", 0.1, "kg m^2", "yaw inertia about G", valid=(0.0, inf)),
            Parameter("b", 0.2, "m", "king pin to centre of gravity G", valid=(0.0, inf)),
            Parameter("l", 0.2, "m", "king pin to wheel", valid=(0.0, inf)),
            Parameter("k", 1e4, "N/m", "lateral stiffness of the king pin", valid=(0.0, inf)),
            Parameter("d", 50.0, "N s/m", "lateral damping of the king pin"),
        ),
        units={"psi": "rad", "omega": "rad/s", "y": "m"},
        descriptions={
            "psi": "caster angle",
            "omega": "its rate",
            "y": "lateral displacement of the king pin",
        },
        title="towed wheel",
        source="D. Takacs, G. Stepan and S. J. Hogan, Nonlinear Dynamics 52 (2008) 27",
    )
