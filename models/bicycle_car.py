"""The bicycle model of a car at constant speed: what is left of the RACS vehicle without RACS.

Both wheels of an axle in one, lateral velocity v and yaw rate w (x forward, y left)::

    m (v' + u w) = F_f + F_r
    I_z w'       = a F_f - b F_r
    F = D sin(C atan(B (1-E) alpha + E atan(B alpha)))         magic formula, D < 0
    alpha_f = (v + a w)/u - delta_f,   alpha_r = (v - b w)/u

Tyres, mass and inertia are those of `racs`. Its centre of gravity is moved back by 0.34 m: the car
oversteers, and has a critical speed.

Source
------
P. Riekert and T. E. Schunck, Zur Fahrmechanik des gummibereiften Kraftfahrzeugs, Ingenieur-Archiv
11 (1940) 210-224; H. B. Pacejka, Tyre and Vehicle Dynamics, 3rd ed. 2012, chapter 1; the numbers of
"Hopf Bifurcation Characteristics of the Vehicle with Rear Axle Compliance Steering".

Known result
------------
With the cornering stiffnesses K = |B C D| straight running is unstable above the critical speed
u_c = (a + b) sqrt(K_f K_r/(m (a K_f - b K_r))) = 43.66373 m/s, a pitchfork (exact). Below it
steady cornering with the yaw rate w needs delta_f = (a + b) w/u - (alpha_f - alpha_r), where both
slip angles are functions of the lateral acceleration u w; its extremes are folds, for u = 30 m/s at
delta_f = +-0.004039293 rad: the car spins if steered further.

Try ``racs-bif continue u 20 60 --model bicycle_car`` and
``racs-bif continue delta_f -0.05 0.05 --model bicycle_car --set u=30``.
"""

from __future__ import annotations

from math import inf, pi

import sympy as sp

from racs_bif import Model, Parameter

POSITIVE = (0.0, inf)
PAPER = "table 1 of the paper on racs"


def tyre(slip: sp.Expr, axle: str) -> sp.Expr:
    """Return the lateral force of an axle [N] at a slip angle [rad]."""
    B, C, D, E = sp.symbols(f"B_{axle} C_{axle} D_{axle} E_{axle}")
    return D * sp.sin(C * sp.atan(B * (1 - E) * slip + E * sp.atan(B * slip)))


def model() -> Model:
    """Build the car."""
    v, w, u, delta_f, m, I_z, a, b = sp.symbols("v w u delta_f m I_z a b")
    front, rear = (v + a * w) / u - delta_f, (v - b * w) / u
    F_f, F_r = tyre(front, "f"), tyre(rear, "r")
    return Model(
        name="bicycle_car",
        equations={"v": (F_f + F_r) / m - u * w, "w": (a * F_f - b * F_r) / I_z},
        parameters=(
            Parameter("u", 30.0, "m/s", "forward speed", valid=POSITIVE),
            Parameter("delta_f", 0.0, "rad", "front wheel steering angle", valid=(-pi / 2, pi / 2)),
            Parameter("m", 1740.0, "kg", "mass", PAPER, POSITIVE),
            Parameter("I_z", 3048.0, "kg m^2", "yaw inertia", PAPER, POSITIVE),
            Parameter("a", 1.8, "m", "centre of gravity to front axle", "ours", POSITIVE),
            Parameter("b", 1.2, "m", "centre of gravity to rear axle", "ours", POSITIVE),
            Parameter("B_f", 6.64, "1/rad", "front tyre stiffness factor", PAPER, POSITIVE),
            Parameter("C_f", 1.352, "", "front tyre shape factor", PAPER, POSITIVE),
            Parameter("D_f", -5822.0, "N", "front tyre peak factor", PAPER, (-inf, 0.0)),
            Parameter("E_f", -1.999, "", "front tyre curvature factor", PAPER, (-inf, 1.0)),
            Parameter("B_r", 8.76, "1/rad", "rear tyre stiffness factor", PAPER, POSITIVE),
            Parameter("C_r", 1.352, "", "rear tyre shape factor", PAPER, POSITIVE),
            Parameter("D_r", -5920.0, "N", "rear tyre peak factor", PAPER, (-inf, 0.0)),
            Parameter("E_r", -1.7098, "", "rear tyre curvature factor", PAPER, (-inf, 1.0)),
        ),
        outputs={"alpha_f": front, "alpha_r": rear, "beta": v / u, "a_y": (F_f + F_r) / m},
        units={
            **{"v": "m/s", "w": "rad/s", "a_y": "m/s^2"},
            **{"alpha_f": "rad", "alpha_r": "rad", "beta": "rad"},
        },
        descriptions={
            "v": "lateral velocity",
            "w": "yaw rate",
            "alpha_f": "slip angle of the front wheel",
            "alpha_r": "slip angle of the rear wheel",
            "beta": "sideslip angle",
            "a_y": "lateral acceleration",
        },
        title="bicycle model of a car",
        source="P. Riekert and T. E. Schunck, Ingenieur-Archiv 11 (1940) 210",
    )
