r"""The vehicle with rear axle compliance steering (RACS).

Source
------
"Hopf Bifurcation Characteristics of the Vehicle with Rear Axle Compliance Steering", research
article. Our copy of the text names neither its authors nor the journal. Equation, table and section
numbers below are the paper's.

The vehicle
-----------
A bicycle model at constant forward speed u, whose rear axle hangs on a hinge Q (the main axle of
the torsion beam) and is held straight by a viscoelastic unit. x points forward, y left, z up;
angles and yaw rate are counter-clockwise, lateral forces point left. On the vehicle's centre line::

    rear axle  O_2  Q       O_3            O_1                     front axle
        *-------*----*-------*--------------*---------------------------*-----> x
        |-- e --|    |       |              |                           |
        |----- c ----|       |              |                           |
        |---------- d -------|              |                           |
        |---------------- b ----------------|------------- a -----------|

O_1 is the centre of gravity of the body (m, I_z), O_2 that of the RACS body (m_c, I_cs), and O_3
the viscoelastic unit, ahead of Q by the arm d-c that (9) gives its force.

States: lateral velocity v, yaw rate w (the paper's omega), compliance steering angle delta_c of the
rear wheel and its rate ddelta_c. The equations of motion, with ' for the time derivative::

    (9)  (m+m_c) v' - (b-e) m_c w' + e m_c delta_c''                  = -m u w + F_f + F_r
         (b-c) m_c v' - ((b-e)(b-c) m_c + I_z) w' + e (b-c) m_c delta_c''
                                                         = -a F_f + (b-c) F_r + (d-c) F_d
         (c-e) m_c v' - ((c-e)(b-e) m_c + I_cs) w' + (e (c-e) m_c - I_cs) delta_c''
                                                         = c F_r - (d-c) F_d
    (8)  F = D sin(C atan(B (1-E) x + E atan(B x)))      tyres, x the slip angle, S_h = S_v = 0
    (7)  alpha_f = (v + a w)/u - delta_f,   alpha_r = (v - b w)/u - delta_c
    (5)  (1 + tau_eps^alpha D^alpha) F_d = C_s (1 + tau_sig^gamma D^gamma) delta_c
    (6)  C_s = d A E_0 / h

The table gives S_h and S_v no values: they are zero and left out. In Laplace form (5) reads
F_d = C_s Z(s) delta_c with Z(s) = (1 + (tau_sig s)^gamma) / (1 + (tau_eps s)^alpha), Z(0) = 1.
The fractional element of the model has the output delta_z = Z(s) delta_c.

The signs: what is printed cannot be what was computed
------------------------------------------------------
In (9) and (7) delta_c is counter-clockwise, like the yaw rate. In (9) F_d > 0 turns the rear axle
counter-clockwise, so F_d = +C_s Z delta_c of (5) pushes the axle *away* from straight. Taken
verbatim (variant `printed`) the equilibrium near straight running has a real unstable root at every
u up to 100 m/s and every C_s from 5e2 to 1e7 N/rad: it is never stable, and no Hopf point is where
the paper has one. (At the calibrated C_s a pair of roots joins the real one near u = 40.8 m/s.)
Two mends, which do not give the same vehicle:

* turn F_d round (`restoring`): one orientation throughout, the mechanically consistent reading.
  At the paper's parameters it shows no shimmy at any stiffness, only divergence or loss of the
  equilibrium and a slow instability that comes from the law (2a);
* turn F_d *and* the delta_c in the slip angle (7) round (`paper`, the default). This is (5), (7)
  verbatim with delta_c'' -> -delta_c'' in (9). It alone shows what the paper reports: one
  supercritical Hopf point, an amplitude that grows with u. It is therefore the default, although
  its slip term has the opposite sense to its inertia terms.

Three more variants. The printed state space (10)-(12) is not what (9) gives: `printed12`, and
`paper12` with the signs of `paper`. And `lagrange` derives the mechanics again by Kane's method,
the axle turning about Q as its hinge demands; in (9) and (7) it moves as if it turned about the
middle of the rear wheels, though the moments are taken about Q (see `multibody`).

What is not given
-----------------
A and h in (6). The paper prints E_0 = 0.5e5 MPa, a modulus like steel's; we read 0.5e5 Pa, a soft
elastomer's, and *calibrate* A_h = A/h so that the exact fractional Hopf point of variant `paper` is
at the 10.2 m/s of figure 3. C_s may be set like a parameter and then changes A_h. (6) takes the
strain arm for d where (d-c) belongs; that is absorbed in A_h.

With the default orders and tau_eps = tau_sig the law (2a) is not passive: Im Z(i omega) < 0, the
element gives energy, below 0.0921 rad/s.
"""

from __future__ import annotations

from functools import partial
from math import inf, pi
from typing import TYPE_CHECKING, NamedTuple

import sympy as sp

from racs_bif.errors import UsageError, nearest
from racs_bif.symbolic.model import (
    Calibration,
    DerivedParameter,
    FractionalElement,
    Model,
    Parameter,
)

if TYPE_CHECKING:
    from collections.abc import Callable

# states, their accelerations, and the output of the viscoelastic element
v, w, delta_c, ddelta_c = STATES = sp.symbols("v w delta_c ddelta_c")
dv, dw, d2delta_c = ACCELERATIONS = sp.symbols("dv dw d2delta_c")
delta_z = sp.Symbol("delta_z")
# forces
F_f, F_r, F_d = FORCES = sp.symbols("F_f F_r F_d")
# parameters
u, delta_f, m, I_z, a, b = sp.symbols("u delta_f m I_z a b")
m_c, I_cs, e, d, c = sp.symbols("m_c I_cs e d c")
tau_eps, tau_sig, alpha, gamma, E_0, A_h = sp.symbols("tau_eps tau_sig alpha gamma E_0 A_h")
B_f, C_f, D_f, E_f = FRONT_TYRE = sp.symbols("B_f C_f D_f E_f")
B_r, C_r, D_r, E_r = REAR_TYRE = sp.symbols("B_r C_r D_r E_r")

TITLE = "vehicle with rear axle compliance steering (RACS)"
SOURCE = "Hopf Bifurcation Characteristics of the Vehicle with Rear Axle Compliance Steering"
POSITIVE = (0.0, inf)
PARAMETERS = (
    Parameter("u", 10.0, "m/s", "forward speed", "figure 4 (also 20 in figure 5)", POSITIVE),
    Parameter("delta_f", 0.01, "rad", "front wheel steering angle", "section 3", (-pi / 2, pi / 2)),
    Parameter("m", 1740.0, "kg", "mass of the vehicle body", "section 3", POSITIVE),
    Parameter("I_z", 3048.0, "kg m^2", "yaw inertia of the body about O_1", "section 3", POSITIVE),
    Parameter("a", 1.46, "m", "O_1 to front axle", "section 3", POSITIVE),
    Parameter("b", 1.54, "m", "O_1 to rear axle", "section 3", POSITIVE),
    Parameter("m_c", 100.0, "kg", "mass of the RACS body", "section 3", POSITIVE),
    Parameter("I_cs", 100.0, "kg m^2", "yaw inertia of the RACS body", "section 3", POSITIVE),
    Parameter("e", 0.15, "m", "rear axle to O_2, the RACS body's centre", "section 3", POSITIVE),
    Parameter("d", 0.8, "m", "rear axle to the viscoelastic unit", "section 3", POSITIVE),
    Parameter("c", 0.35, "m", "rear axle to the hinge Q", "section 3", POSITIVE),
    Parameter("tau_eps", 1.0, "s", "relaxation time, eq. (2a)", "section 3", POSITIVE),
    Parameter("tau_sig", 1.0, "s", "creep time, eq. (2a)", "section 3", POSITIVE),
    Parameter("alpha", 0.3, "", "fractional order of the stress", "section 3", (0.0, 1.0)),
    Parameter("gamma", 0.7, "", "fractional order of the strain", "section 3", (0.0, 1.0)),
    Parameter("E_0", 0.5e5, "Pa", "relaxed modulus", "section 3, printed in MPa", POSITIVE),
    Parameter(
        "A_h",
        Calibration(
            parameter="C_s", hopf={"u": 10.2}, span=(5e3, 2e5), options={"variant": "paper"}
        ),
        "m",
        "A/h of the viscoelastic unit: cross-section over length",
        "not in the paper; calibrated to the Hopf point of figure 3",
        POSITIVE,
    ),
    Parameter("B_f", 6.64, "1/rad", "front tyre stiffness factor", "table 1", POSITIVE),
    Parameter("C_f", 1.352, "", "front tyre shape factor", "table 1", POSITIVE),
    Parameter("D_f", -5822.0, "N", "front tyre peak factor", "table 1", (-inf, 0.0)),
    Parameter("E_f", -1.999, "", "front tyre curvature factor", "table 1", (-inf, 1.0)),
    Parameter("B_r", 8.76, "1/rad", "rear tyre stiffness factor", "table 1", POSITIVE),
    Parameter("C_r", 1.352, "", "rear tyre shape factor", "table 1", POSITIVE),
    Parameter("D_r", -5920.0, "N", "rear tyre peak factor", "table 1", (-inf, 0.0)),
    Parameter("E_r", -1.7098, "", "rear tyre curvature factor", "table 1", (-inf, 1.0)),
)
C_S = DerivedParameter(
    "C_s",
    d * A_h * E_0,
    sets="A_h",
    unit="N/rad",
    description="stiffness of the compliance steering, eq. (6)",
    source="not in the paper; calibrated with A_h",
    valid=POSITIVE,
)
BAND = (0.1, 50.0)
"""Shimmy is near 10 rad/s, and its harmonics matter to 50.

With 8 states on 1.5 to 50 rad/s the Hopf speed and the orbits to 21 m/s are good to 3e-4 as well.
But beyond it the period climbs to 29 s (0.2 rad/s), where such a narrow band shows folds and period
doublings that the exact operator does not have.
"""
UNITS = {
    **{"v": "m/s", "w": "rad/s", "delta_c": "rad", "ddelta_c": "rad/s", "delta_z": "rad"},
    **{"alpha_f": "rad", "alpha_r": "rad", "beta": "rad"},
    **{"F_f": "N", "F_r": "N", "F_d": "N", "a_y": "m/s^2"},
}
DESCRIPTIONS = {
    "v": "lateral velocity of O_1",
    "w": "yaw rate",
    "delta_c": "compliance steering angle of the rear wheel",
    "ddelta_c": "rate of the compliance steering angle",
    "delta_z": "delta_c as the viscoelastic unit feels it, Z(s) delta_c",
    "alpha_f": "slip angle of the front wheel",
    "alpha_r": "slip angle of the rear wheel",
    "beta": "sideslip angle at O_1",
    "F_f": "lateral force of the road on the front wheel",
    "F_r": "lateral force of the road on the rear wheel",
    "F_d": "force of the viscoelastic unit, turning the axle counter-clockwise",
    "a_y": "lateral acceleration of O_1",
}
NOTES = (
    "A_h = A/h, and with it C_s = d A_h E_0, is not in the paper: its default is calibrated so "
    "that the exact Hopf point of variant 'paper' is at the paper's 10.2 m/s. E_0 is read in Pa.",
    "With the default orders and times the viscoelastic law (2a) is not passive below "
    "0.0921 rad/s: slow motion there is a property of the law, not of the vehicle.",
)


class Mechanics(NamedTuple):
    """Motion of the two bodies under given forces, before the force laws are put in."""

    equations: tuple[sp.Expr, ...]
    """Three expressions in `ACCELERATIONS`, `FORCES`, states and parameters; they vanish."""
    alpha_r: sp.Expr
    """Slip angle of the rear wheel [rad]."""


class Variant(NamedTuple):
    """One reading of the paper."""

    summary: str
    mechanics: Callable[[], Mechanics]
    unit_sign: int
    """F_d = unit_sign * C_s * delta_z."""


def newton(slip_sign: int) -> Mechanics:
    """Write equations (9) and (7) as printed, but for the sign of delta_c in the slip angle.

    Parameters
    ----------
    slip_sign : int
        -1 as printed, +1 turned round.

    Returns
    -------
    Mechanics
        The rows of (9), left side minus right side [N, N m, N m], and alpha_r.
    """
    equations = (
        (m + m_c) * dv - (b - e) * m_c * dw + e * m_c * d2delta_c - (-m * u * w + F_f + F_r),
        (b - c) * m_c * dv
        - ((b - e) * (b - c) * m_c + I_z) * dw
        + e * (b - c) * m_c * d2delta_c
        - (-a * F_f + (b - c) * F_r + (d - c) * F_d),
        (c - e) * m_c * dv
        - ((c - e) * (b - e) * m_c + I_cs) * dw
        + (e * (c - e) * m_c - I_cs) * d2delta_c
        - (c * F_r - (d - c) * F_d),
    )
    return Mechanics(equations, (v - b * w) / u + slip_sign * delta_c)


def state_space(slip_sign: int) -> Mechanics:
    """Write the state space form (10)-(12) as printed.

    E_1, A_1 and B_1 agree with (9). A_2 does not: it has e for c-e, and (b-c+e) e for (c-e)(b-e).
    B_2 is printed with two entries for three forces and is read [0, c/X, -(d-c)/X].

    Parameters
    ----------
    slip_sign : int
        As in `newton`.

    Returns
    -------
    Mechanics
        E_1 [v', w'] - A_1 [v, w] - B_1 F and delta_c'' - A_2 [v', w'] - B_2 F, and alpha_r.
    """
    X = e * (c - e) * m_c - I_cs
    Y = e * (b - c) * m_c
    e_11 = (c - e) * m_c / X - (m + m_c) / (e * m_c)
    e_12 = (b - e) * m_c / (e * m_c) - ((b - e) * (c - e) * m_c + I_cs) / X
    e_21 = (c - e) * m_c / X - 1 / e
    e_22 = ((b - e) * (b - c) * m_c + I_z) / Y - ((c - e) * (b - e) * m_c + I_cs) / X
    E_1 = sp.Matrix([[e_11, e_12], [e_21, e_22]])
    A_1 = sp.Matrix([[0, m * u / (e * m_c)], [0, 0]])
    A_2 = sp.Matrix([[-e * m_c / X, (e * (b - c + e) * m_c + I_cs) / X]])
    b_1 = [-1 / (e * m_c), c / X - 1 / (e * m_c), -(d - c) / X]
    b_2 = [a / Y, c / X - (b - c) / Y, (c - d) / X - (d - c) / Y]
    B_1 = sp.Matrix([b_1, b_2])
    B_2 = sp.Matrix([[0, c / X, -(d - c) / X]])
    rates, forces = sp.Matrix([dv, dw]), sp.Matrix(FORCES)
    rows_10 = E_1 * rates - A_1 * sp.Matrix([v, w]) - B_1 * forces
    row_11 = sp.Matrix([d2delta_c]) - A_2 * rates - B_2 * forces
    return Mechanics((*rows_10, *row_11), (v - b * w) / u + slip_sign * delta_c)


def multibody() -> Mechanics:
    """Derive the motion by Kane's method: body and RACS body, hinged at Q, at constant u.

    "Geometrical nonlinearity is ignored", as in the paper: everything is of first order in the
    lateral and angular velocities, delta_c and the forces. delta_c and all else counter-clockwise.
    Compared with (9) its rows gain m_c (u w - c delta_c'') times 1, (b-c), (c-e): the centripetal
    term of the RACS body, and its centre of gravity moving by -(c-e) delta_c (about Q) where (9)
    has +e delta_c (about the middle of the rear wheels). The slip angle gains -c ddelta_c/u.

    Returns
    -------
    Mechanics
        Rows combined as those of (9): all lateral forces, minus the moments on the body alone about
        O_1, minus the moments on the RACS body about Q; and alpha_r.
    """
    from sympy.physics import mechanics as me

    y, psi, delta = me.dynamicsymbols("y psi delta")
    speeds = me.dynamicsymbols("v w r")  # lateral velocity, yaw rate, rate of delta
    ground = me.ReferenceFrame("N")
    body = ground.orientnew("B", "Axis", [psi, ground.z])
    axle = body.orientnew("R", "Axis", [delta, ground.z])
    body.set_ang_vel(ground, speeds[1] * ground.z)
    axle.set_ang_vel(body, speeds[2] * ground.z)
    origin = me.Point("O_1")
    origin.set_vel(ground, u * body.x + speeds[0] * body.y)

    def ahead(start: me.Point, distance: sp.Expr, frame: me.ReferenceFrame) -> me.Point:
        point = me.Point(f"{start.name}_{frame.name}_{distance}")
        point.set_pos(start, distance * frame.x)
        point.v2pt_theory(start, ground, frame)
        return point

    hinge = ahead(origin, -(b - c), body)
    centre = ahead(hinge, -(c - e), axle)
    wheel = ahead(hinge, -c, axle)
    bodies = [
        me.RigidBody("body", origin, body, m, (me.inertia(body, 0, 0, I_z), origin)),
        me.RigidBody("racs", centre, axle, m_c, (me.inertia(axle, 0, 0, I_cs), centre)),
    ]
    loads = [
        (ahead(origin, a, body), F_f * body.y),
        (wheel, F_r * axle.y),
        (ahead(hinge, d - c, axle), F_d * axle.y),  # at O_3, on the axle
        (ahead(hinge, d - c, body), -F_d * body.y),  # and back on the body
    ]
    rates = (u * sp.sin(psi) + speeds[0] * sp.cos(psi), speeds[1], speeds[2])
    kane = me.KanesMethod(
        ground,
        q_ind=[y, psi, delta],
        u_ind=speeds,
        kd_eqs=[q.diff() - rate for q, rate in zip((y, psi, delta), rates, strict=True)],
    )
    active, inertial = kane.kanes_equations(bodies, loads)

    size = sp.Dummy("size")
    accelerations = dict(zip((s.diff() for s in speeds), ACCELERATIONS, strict=True))
    values = dict(zip((*speeds, delta), (v, w, ddelta_c, delta_c), strict=True))
    values |= {force: force for force in FORCES}

    def first_order(expression: sp.Expr) -> sp.Expr:
        small = expression.subs({k: size * x for k, x in accelerations.items()})
        small = small.subs({k: size * x for k, x in values.items()}, simultaneous=True)
        return sp.expand(small.diff(size).subs(size, 0))

    lateral, yaw, steer = (first_order(row) for row in active + inertial)
    sideways = first_order(wheel.vel(ground).dot(axle.y))
    unknowns = (*ACCELERATIONS, *FORCES, *STATES)
    rows = (sp.collect(row, unknowns, sp.factor) for row in (-lateral, yaw - steer, steer))
    return Mechanics(tuple(rows), sp.expand(sideways / u))


VARIANTS = {
    "paper": Variant(
        "default, the signs under which the paper's results appear: delta_c in the slip angle (7) "
        "and F_d of (5) turned round",
        partial(newton, slip_sign=+1),
        unit_sign=-1,
    ),
    "printed": Variant(
        "(5), (7), (9) verbatim: the viscoelastic unit pushes the axle away, always unstable",
        partial(newton, slip_sign=-1),
        unit_sign=+1,
    ),
    "printed12": Variant(
        "(5), (7) and the state space (10)-(12) verbatim, which is not what (9) gives",
        partial(state_space, slip_sign=-1),
        unit_sign=+1,
    ),
    "paper12": Variant(
        "the state space (10)-(12) with the signs of 'paper'",
        partial(state_space, slip_sign=+1),
        unit_sign=-1,
    ),
    "restoring": Variant(
        "(7), (9) verbatim, F_d of (5) turned round: one orientation throughout",
        partial(newton, slip_sign=-1),
        unit_sign=-1,
    ),
    "lagrange": Variant(
        "rigid bodies hinged at Q, derived by sympy.physics.mechanics, F_d restoring",
        multibody,
        unit_sign=-1,
    ),
}
SIGNS = (
    "The signs in print disagree: (9) and (7) count delta_c counter-clockwise, (5) clockwise. "
    "Verbatim ('printed') the viscoelastic unit pushes the axle away from straight: the vehicle "
    "has a real unstable root at every speed and no Hopf point in the paper's range. With F_d and "
    "the delta_c of (7) turned round ('paper', the default) the paper's results appear, though its "
    "slip and inertia terms then have opposite senses. F_d alone turned round ('restoring') is "
    "consistent but shows no shimmy."
)


def magic_formula(slip: sp.Expr, tyre: tuple[sp.Symbol, ...]) -> sp.Expr:
    """Return the lateral force of a tyre [N], equation (8) with S_h = S_v = 0.

    Parameters
    ----------
    slip : sympy expression
        Slip angle [rad].
    tyre : tuple of four symbols
        B, C, D, E of table 1.
    """
    B, C, D, E = tyre
    return D * sp.sin(C * sp.atan(B * (1 - E) * slip + E * sp.atan(B * slip)))


def model(*, variant: str = "paper") -> Model:
    """Build the vehicle in one reading of the paper.

    Parameters
    ----------
    variant : str
        A key of `VARIANTS`.

    Returns
    -------
    Model
        States v [m/s], w [rad/s], delta_c [rad], ddelta_c [rad/s], in this order.

    Raises
    ------
    UsageError
        If there is no such variant.
    """
    if variant not in VARIANTS:
        msg = f"unknown variant '{variant}' of model 'racs'; {nearest(variant, VARIANTS)}"
        raise UsageError(msg)
    chosen = VARIANTS[variant]
    mechanics = chosen.mechanics()
    alpha_f, alpha_r = (v + a * w) / u - delta_f, mechanics.alpha_r
    laws = {
        F_f: magic_formula(alpha_f, FRONT_TYRE),
        F_r: magic_formula(alpha_r, REAR_TYRE),
        F_d: chosen.unit_sign * C_S.expression * delta_z,
    }
    inertia, right = sp.linear_eq_to_matrix(mechanics.equations, ACCELERATIONS)
    normal = inertia.col(1).cross(inertia.col(2))
    a_y = right.dot(normal) / inertia.col(0).dot(normal) + u * w  # v' by Cramer's rule

    mass = sp.eye(4)
    mechanical = (0, 1, 3)  # the states' order has delta_c' = ddelta_c third
    for i, row in enumerate(mechanical):
        for j, column in enumerate(mechanical):
            mass[row, column] = inertia[i, j]
    forced = [row.xreplace(laws) for row in right]
    s = sp.Symbol("s")
    law = (1 + (tau_sig * s) ** gamma) / (1 + (tau_eps * s) ** alpha)
    return Model(
        name="racs",
        equations={"v": forced[0], "w": forced[1], "delta_c": ddelta_c, "ddelta_c": forced[2]},
        mass=mass,
        parameters=PARAMETERS,
        derived=(C_S,),
        elements=(FractionalElement(output=str(delta_z), input=delta_c, law=law),),
        guess={str(state): 0.0 for state in STATES},
        outputs={
            "alpha_f": alpha_f,
            "alpha_r": alpha_r,
            **{str(force): law for force, law in laws.items()},
            "beta": v / u,
            "a_y": a_y.xreplace(laws),
        },
        units=UNITS,
        descriptions=DESCRIPTIONS,
        title=TITLE,
        source=SOURCE,
        variant=variant,
        variants={name: row.summary for name, row in VARIANTS.items()},
        notes=(SIGNS, *NOTES),
        band=BAND,
        inputs=("delta_f",),
    )
