"""Ziegler's pendulum with springpots in its joints: damping that destabilises.

Two rods of length l upright on each other, a mass 2m on the lower joint between them and m on top,
both joints held by a spring k and a springpot, and a load P that follows the upper rod. With the
angles theta_1 and theta_2 of the rods from the vertical, time in sqrt(m l^2/k) and P in k/l::

    3 theta_1'' + cos(delta) theta_2'' = -theta_2'^2 sin(delta) - M_1 + M_2 + P sin(delta)
    cos(delta) theta_1'' + theta_2''   =  theta_1'^2 sin(delta) - M_2

    M_1 = theta_1 + c D^a theta_1
    M_2 = -delta - c D^a delta,   delta = theta_1 - theta_2

Source
------
H. Ziegler, Die Stabilitaetskriterien der Elastomechanik, Ingenieur-Archiv 20 (1952) 49-56 (a = 1);
G. Herrmann and I.-C. Jong, On the destabilizing effect of damping in nonconservative elastic
systems, Journal of Applied Mechanics 32 (1965) 592-597.

Known result
------------
Linearised, with kappa(s) = 1 + c s^a, the roots are those of 2 s^4 + (7 kappa - 2 P) s^2 + kappa^2.
Without damping the pendulum flutters from P = 7/2 - sqrt(2) = 2.0858 on; with it from
P = 41 p/28 + 7 q^2/(4 p), where kappa(i omega) = p + i q and omega^2 = 2 p/7 (exact). As c vanishes
that tends to 41/28 = 1.4643 for every order: a little damping costs a third of the load.

Try ``racs-bif continue P 1 2 --model zieglers_pendulum``.
"""

from __future__ import annotations

import sympy as sp

from racs_bif import FractionalElement, Model, Parameter


def model() -> Model:
    """Build the pendulum."""
    theta_1, theta_2, omega_1, omega_2 = sp.symbols("theta_1 theta_2 omega_1 omega_2")
    w_1, w_2, P, c, a, s = sp.symbols("w_1 w_2 P c a s")
    turn = theta_1 - theta_2
    lower, upper = theta_1 + c * w_1, -turn + c * w_2
    return Model(
        name="zieglers_pendulum",
        equations={
            "theta_1": omega_1,
            "theta_2": omega_2,
            "omega_1": -(omega_2**2) * sp.sin(turn) - lower + upper + P * sp.sin(turn),
            "omega_2": omega_1**2 * sp.sin(turn) - upper,
        },
        mass=sp.diag(1, 1, sp.Matrix([[3, sp.cos(turn)], [sp.cos(turn), 1]])),
        elements=(
            FractionalElement(output="w_1", input=theta_1, law=s**a),
            FractionalElement(output="w_2", input=theta_2 - theta_1, law=s**a),
        ),
        parameters=(
            Parameter("P", 1.0, description="load that follows, in k/l"),
            Parameter("c", 0.1, description="strength of the springpots, springs are 1"),
            Parameter("a", 0.5, description="order of the springpots", valid=(0.0, 1.0)),
        ),
        units={"theta_1": "rad", "theta_2": "rad", "w_1": "rad", "w_2": "rad"},
        descriptions={
            "theta_1": "angle of the lower rod",
            "theta_2": "angle of the upper rod",
            "omega_1": "rate of theta_1",
            "omega_2": "rate of theta_2",
            "w_1": "D^a theta_1",
            "w_2": "D^a (theta_2 - theta_1)",
        },
        time_unit="",
        title="Ziegler's pendulum with springpots",
        source="H. Ziegler, Ingenieur-Archiv 20 (1952) 49",
        band=(0.01, 100.0),
    )
