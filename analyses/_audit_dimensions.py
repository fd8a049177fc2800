"""Dimensions of the printed equations: every term of a sum must have the same."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import sympy as sp

if TYPE_CHECKING:  # the folder is no package; the shelf finds its files in every installation
    from models import racs
else:
    from racs_bif.shelf.models import racs

Dimension = tuple[Any, Any, Any]
"""Exponents of kg, m and s; those of fractional derivatives hold alpha and gamma."""

_NONE: Final[Dimension] = (0, 0, 0)
_FORCE: Final[Dimension] = (1, 1, -2)
_PRESSURE: Final[Dimension] = (1, -1, -2)
_TIME: Final[Dimension] = (0, 0, 1)
_LENGTH: Final[Dimension] = (0, 1, 0)
UNITS: Final[Mapping[str, Dimension]] = {
    **dict.fromkeys(("", "rad", "1/rad"), _NONE),
    **{"m": _LENGTH, "s": _TIME, "kg": (1, 0, 0), "kg m^2": (1, 2, 0)},
    **{"m/s": (0, 1, -1), "rad/s": (0, 0, -1), "m/s^2": (0, 1, -2)},
    **{"N": _FORCE, "N/rad": _FORCE, "Pa": _PRESSURE},
}
"""Dimensions of the units that the model uses; an angle has none."""


class MismatchError(Exception):
    """Terms of a sum, or an exponent or argument, that have another dimension than they must."""


@dataclass(frozen=True)
class Check:
    """An equation, its dimension, and what is wrong with it (empty: nothing)."""

    name: str
    unit: str
    wrong: str


def check_all() -> list[Check]:
    """Check every numbered equation of the paper."""
    table = _table()
    found = []
    for name, expression in _equations().items():
        try:
            unit, wrong = _words(dimension(expression, table)), ""
        except MismatchError as error:
            unit, wrong = "", str(error)
        found.append(Check(name, unit, wrong))
    return found


def dimension(expression: Any, table: Mapping[Any, Dimension]) -> Dimension:  # noqa: ANN401
    """Return the dimension of a sympy expression.

    Parameters
    ----------
    expression : sympy expression
        The expression.
    table : mapping of Symbol to Dimension
        Dimensions of its symbols.

    Raises
    ------
    MismatchError
        If terms of a sum differ, or an exponent or an angle has a dimension.
    """
    if expression.is_Number or expression.is_NumberSymbol:
        return _NONE
    if expression.is_Symbol:
        return table[expression]
    parts = [dimension(part, table) for part in expression.args]
    if expression.is_Mul:
        return _sum(parts)
    if expression.is_Pow:
        if not _same(parts[1], _NONE):
            msg = f"the exponent {expression.exp} has the dimension {_words(parts[1])}"
            raise MismatchError(msg)
        return tuple(sp.expand(k * expression.exp) for k in parts[0])
    wanted = parts[0] if expression.is_Add else _NONE
    for part, term in zip(parts, expression.args, strict=True):
        if not _same(part, wanted):
            msg = f"{term} has {_words(part)} where {_words(wanted)} is needed"
            raise MismatchError(msg)
    return wanted


def _sum(parts: list[Dimension]) -> Dimension:
    return tuple(sp.expand(sum(column)) for column in zip(*parts, strict=True))


def _same(one: Dimension, other: Dimension) -> bool:
    return all(sp.expand(a - b) == 0 for a, b in zip(one, other, strict=True))


def _words(wanted: Dimension) -> str:
    named = {"kg": wanted[0], "m": wanted[1], "s": wanted[2]}
    words = [unit if k == 1 else f"{unit}^({k})" for unit, k in named.items() if k != 0]
    return " ".join(words) or "1"


_STRESS, _STRAIN, _MODULUS = sp.symbols("sigma epsilon E_inf")
_X, _DX, _T, _XI = sp.symbols("x D_xi_x t xi")
_AREA, _HEIGHT, _C_S = sp.symbols("A h C_s")
_D_STRESS, _D_STRAIN_A, _D_STRAIN_G = sp.symbols("D_alpha_sigma D_alpha_eps D_gamma_eps")
_D_FORCE, _D_ANGLE = sp.symbols("D_alpha_F_d D_gamma_delta_c")


def _table() -> dict[Any, Dimension]:
    """Return the dimensions of all symbols; the model's own from its tables."""
    model = racs.model()
    table = {sp.Symbol(p.name): UNITS[p.unit] for p in model.parameters}
    table |= {sp.Symbol(name): UNITS[unit] for name, unit in racs.UNITS.items()}
    table |= {racs.dv: UNITS["m/s^2"], racs.dw: (0, 0, -2), racs.d2delta_c: (0, 0, -2)}
    alpha, gamma = racs.alpha, racs.gamma
    table |= {_STRESS: _PRESSURE, _MODULUS: _PRESSURE, _STRAIN: _NONE, _AREA: (0, 2, 0)}
    table |= {_HEIGHT: _LENGTH, _C_S: _FORCE, _X: _NONE, _T: _TIME, _XI: _NONE, _DX: (0, 0, -_XI)}
    table |= {_D_STRESS: (1, -1, -2 - alpha), _D_FORCE: (1, 1, -2 - alpha)}
    table |= {_D_STRAIN_A: (0, 0, -alpha), _D_STRAIN_G: (0, 0, -gamma), _D_ANGLE: (0, 0, -gamma)}
    return table


def _equations() -> dict[str, Any]:
    """Return all equations as expressions that vanish, by their numbers."""
    tau_e, tau_s = racs.tau_eps**racs.alpha, racs.tau_sig**racs.gamma
    stress = _STRESS + tau_e * _D_STRESS
    force = racs.F_d + tau_e * _D_FORCE
    under_e = racs.tau_eps**racs.gamma * _D_STRAIN_G
    angle = racs.delta_c + tau_s * _D_ANGLE
    found = {
        "(1a)": stress - _MODULUS * under_e,
        "(1b)": stress - _MODULUS * (tau_e * _D_STRAIN_A + under_e),
        "(2a)": stress - racs.E_0 * (_STRAIN + tau_s * _D_STRAIN_G),
        "(2b)": stress
        - racs.E_0 * (_STRAIN + racs.tau_sig**racs.alpha * _D_STRAIN_A + tau_s * _D_STRAIN_G),
        "(3)": _DX - _X * _T / _T**_XI / _T,
        "(4)": force - _AREA * racs.E_0 * (_STRAIN + tau_s * _D_STRAIN_G),
        "(5)": force - _C_S * angle,
        "(6)": _C_S - racs.d * _AREA * racs.E_0 / _HEIGHT,
        "(7) front": (racs.v + racs.a * racs.w) / racs.u - racs.delta_f,
        "(7) rear": (racs.v - racs.b * racs.w) / racs.u - racs.delta_c,
        "(8)": racs.F_f - racs.magic_formula(sp.Symbol("alpha_f"), racs.FRONT_TYRE),
    }
    newton, state_space = racs.newton(-1).equations, racs.state_space(-1).equations
    found |= {f"(9) row {k}": row for k, row in enumerate(newton, 1)}
    names = ("(10), (12) row 1", "(10), (12) row 2", "(11), (12)")
    return found | dict(zip(names, state_space, strict=True))
