"""The printed equations of motion against what sympy derives: (10)-(12), and rigid bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import sympy as sp

if TYPE_CHECKING:  # the folder is no package; the shelf finds its files in every installation
    from models import racs
else:
    from racs_bif.shelf.models import racs


@dataclass(frozen=True)
class Entry:
    """An entry of the printed state space form.

    Parameters
    ----------
    name : str
        Matrix, row and column, ``A_2[1,1]``.
    printed : sympy expression, optional
        What is printed; None where nothing is.
    derived : sympy expression
        What follows from (9).
    """

    name: str
    printed: Any
    derived: Any

    @property
    def agrees(self) -> bool:
        """Whether both are the same function of the parameters."""
        return self.printed is not None and sp.simplify(self.printed - self.derived) == 0


def state_space_entries() -> list[Entry]:
    """Derive E_1, A_1, B_1, A_2, B_2 from (9) and set them beside the printed ones.

    (10) is the third row of (9) over the factor X of delta_c'' less the first and the second over
    theirs, (11) the third row solved for delta_c''.
    """
    first, second, third = racs.newton(-1).equations
    acceleration = racs.d2delta_c
    scaled = [sp.expand(row / row.expand().coeff(acceleration)) for row in (first, second, third)]
    rows = [sp.expand(scaled[2] - scaled[0]), sp.expand(scaled[2] - scaled[1])]
    derived = _matrices(rows, sp.expand(scaled[2]))
    *printed_rows, last = racs.state_space(-1).equations
    printed = _matrices(printed_rows, last)
    entries = []
    for name, matrix in derived.items():
        for i in range(matrix.rows):
            for j in range(matrix.cols):
                entry = _printed_b_2(j) if name == "B_2" else printed[name][i, j]
                entries.append(Entry(f"{name}[{i + 1},{j + 1}]", entry, sp.factor(matrix[i, j])))
    return entries


def _matrices(rows: list[Any], last: Any) -> dict[str, Any]:  # noqa: ANN401 - sympy: no types
    """Read the matrices off ``E_1 x' - A_1 x - B_1 F = 0`` and ``delta_c'' - A_2 x' - B_2 F``."""
    rates, states = [racs.dv, racs.dw], [racs.v, racs.w]
    both, alone = sp.Matrix(rows), sp.Matrix([last])
    return {
        "E_1": both.jacobian(rates),
        "A_1": -both.jacobian(states),
        "B_1": -both.jacobian(racs.FORCES),
        "A_2": -alone.jacobian(rates),
        "B_2": -alone.jacobian(racs.FORCES),
    }


def _printed_b_2(column: int) -> Any:  # noqa: ANN401 - sympy has no types
    """Return what (12) prints for B_2: two entries for three forces."""
    X = racs.e * (racs.c - racs.e) * racs.m_c - racs.I_cs
    return (sp.Integer(0), racs.c / X - (racs.d - racs.c) / X, None)[column]


def reading_agrees() -> bool:
    """Tell whether B_2, read with three entries as the variants do, follows from (9)."""
    printed = -sp.Matrix([racs.state_space(-1).equations[2]]).jacobian(racs.FORCES)
    derived = [entry.derived for entry in state_space_entries() if entry.name.startswith("B_2")]
    return all(sp.simplify(a - b) == 0 for a, b in zip(printed, derived, strict=True))


def missing_terms() -> dict[str, Any]:
    """Return what rigid-body mechanics has and (9), (7) have not, row by row and for alpha_r."""
    bodies, printed = racs.multibody(), racs.newton(-1)
    pairs = zip(bodies.equations, printed.equations, strict=True)
    names = ("lateral forces", "moments on the body about O_1", "moments on the RACS about Q")
    terms = {name: sp.factor(sp.expand(a - b)) for name, (a, b) in zip(names, pairs, strict=True)}
    return terms | {"alpha_r": sp.expand(bodies.alpha_r - printed.alpha_r)}


def lagrange_agrees() -> bool:
    """Tell whether Lagrange's equations in quasi-velocities give what Kane's method gives.

    With T(v, w, r, delta) of the two bodies, u held, the lateral, yaw and steering equations are
    ``(T_v)' + w T_u = Y``, ``(T_w)' + u T_v - v T_u = N``, ``(T_r)' - T_delta = Q``.
    """
    v, w, r, delta, u = racs.v, racs.w, racs.ddelta_c, racs.delta_c, racs.u
    m, m_c, b, c, d, e = racs.m, racs.m_c, racs.b, racs.c, racs.d, racs.e
    F_f, F_r, F_d = racs.FORCES
    lever = c - e
    along = u + (w + r) * lever * sp.sin(delta)
    across = v - (b - c) * w - (w + r) * lever * sp.cos(delta)
    T = (m * (u**2 + v**2) + racs.I_z * w**2) / 2
    T += (m_c * (along**2 + across**2) + racs.I_cs * (w + r) ** 2) / 2
    rates = {v: racs.dv, w: racs.dw, r: racs.d2delta_c, delta: r}

    def rate(momentum: Any) -> Any:  # noqa: ANN401 - sympy has no types
        return sum(momentum.diff(x) * dx for x, dx in rates.items())

    lateral = rate(T.diff(v)) + w * T.diff(u) - (F_f + F_r)
    yaw = rate(T.diff(w)) + u * T.diff(v) - v * T.diff(u) - (racs.a * F_f - b * F_r)
    steer = rate(T.diff(r)) - T.diff(delta) - (-c * F_r + (d - c) * F_d)
    rows = (lateral, -(yaw - steer), -steer)
    return all(
        sp.simplify(_first_order(mine) - kane) == 0
        for mine, kane in zip(rows, racs.multibody().equations, strict=True)
    )


def _first_order(expression: Any) -> Any:  # noqa: ANN401 - sympy has no types
    """Keep what is linear in motion and forces."""
    size = sp.Dummy("size")
    small = (*racs.STATES, *racs.ACCELERATIONS, *racs.FORCES)
    scaled = expression.subs({x: size * x for x in small}, simultaneous=True)
    return sp.expand(scaled.diff(size).subs(size, 0))
