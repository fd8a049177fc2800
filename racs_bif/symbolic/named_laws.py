"""Constitutive laws by name, as sympy expressions in the Laplace variable.

Each function takes names of parameters, numbers or expressions, and returns Z(s), stress over
strain, to be used as the law of a `racs_bif.symbolic.model.FractionalElement`. The laws (1a) to
(2b) with two independent orders are numbered as in *Hopf Bifurcation Characteristics of the
Vehicle with Rear Axle Compliance Steering*.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

from racs_bif.symbolic.model import LAPLACE

if TYPE_CHECKING:
    import sympy as sp

    Quantity: TypeAlias = "str | float | sp.Expr"


def springpot(c: Quantity, alpha: Quantity) -> sp.Expr:
    """Return ``c s**alpha`` (G. W. Scott Blair): a spring at alpha = 0, a dashpot at 1.

    Parameters
    ----------
    c : str, float or sympy expression
        Stiffness [Pa s**alpha].
    alpha : str, float or sympy expression
        Order.

    Examples
    --------
    >>> springpot("c", "alpha")
    c*s**alpha
    """
    s, c, alpha = _symbols(c, alpha)
    return c * s**alpha


def kelvin_voigt(E: Quantity, tau: Quantity, alpha: Quantity) -> sp.Expr:
    """Return ``E (1 + (tau s)**alpha)``: spring and springpot in parallel.

    Parameters
    ----------
    E : str, float or sympy expression
        Relaxed modulus [Pa].
    tau : str, float or sympy expression
        Retardation time [s].
    alpha : str, float or sympy expression
        Order.
    """
    s, E, tau, alpha = _symbols(E, tau, alpha)
    return E * (1 + tau**alpha * s**alpha)


def maxwell(E: Quantity, tau: Quantity, alpha: Quantity) -> sp.Expr:
    """Return ``E (tau s)**alpha / (1 + (tau s)**alpha)``: spring and springpot in series.

    Parameters
    ----------
    E : str, float or sympy expression
        Glass modulus [Pa].
    tau : str, float or sympy expression
        Relaxation time [s].
    alpha : str, float or sympy expression
        Order.
    """
    s, E, tau, alpha = _symbols(E, tau, alpha)
    return E * tau**alpha * s**alpha / (1 + tau**alpha * s**alpha)


def zener(E_0: Quantity, tau_sig: Quantity, tau_eps: Quantity, alpha: Quantity) -> sp.Expr:
    """Return ``E_0 (1 + (tau_sig s)**alpha) / (1 + (tau_eps s)**alpha)``, the linear solid.

    Parameters
    ----------
    E_0 : str, float or sympy expression
        Relaxed modulus [Pa].
    tau_sig, tau_eps : str, float or sympy expression
        Creep and relaxation time [s]; passive for tau_sig >= tau_eps.
    alpha : str, float or sympy expression
        Order.
    """
    s, E_0, tau_sig, tau_eps, alpha = _symbols(E_0, tau_sig, tau_eps, alpha)
    return E_0 * (1 + tau_sig**alpha * s**alpha) / (1 + tau_eps**alpha * s**alpha)


def law_1a(E_inf: Quantity, tau_eps: Quantity, alpha: Quantity, gamma: Quantity) -> sp.Expr:
    """Return ``E_inf (tau_eps s)**gamma / (1 + (tau_eps s)**alpha)``: Maxwell with two orders.

    Parameters
    ----------
    E_inf : str, float or sympy expression
        Modulus [Pa].
    tau_eps : str, float or sympy expression
        Relaxation time [s].
    alpha, gamma : str, float or sympy expression
        Orders of stress and strain.
    """
    s, E_inf, tau_eps, alpha, gamma = _symbols(E_inf, tau_eps, alpha, gamma)
    return E_inf * tau_eps**gamma * s**gamma / (1 + tau_eps**alpha * s**alpha)


def law_1b(E_inf: Quantity, tau_eps: Quantity, alpha: Quantity, gamma: Quantity) -> sp.Expr:
    """Return the modified Maxwell law with two orders: `law_1a` with alpha's power added above.

    Parameters
    ----------
    E_inf, tau_eps, alpha, gamma : str, float or sympy expression
        As in `law_1a`.
    """
    s, E_inf, tau_eps, alpha, gamma = _symbols(E_inf, tau_eps, alpha, gamma)
    above = tau_eps**alpha * s**alpha + tau_eps**gamma * s**gamma
    return E_inf * above / (1 + tau_eps**alpha * s**alpha)


def law_2a(
    E_0: Quantity, tau_sig: Quantity, tau_eps: Quantity, alpha: Quantity, gamma: Quantity
) -> sp.Expr:
    """Return ``E_0 (1 + (tau_sig s)**gamma) / (1 + (tau_eps s)**alpha)``, Zener's with two orders.

    Not passive at low frequency where alpha < gamma: see `racs_bif.fractional.passivity`.

    Parameters
    ----------
    E_0 : str, float or sympy expression
        Relaxed modulus [Pa].
    tau_sig, tau_eps : str, float or sympy expression
        Creep and relaxation time [s].
    alpha, gamma : str, float or sympy expression
        Orders of stress and strain.
    """
    s, E_0, tau_sig, tau_eps, alpha, gamma = _symbols(E_0, tau_sig, tau_eps, alpha, gamma)
    return E_0 * (1 + tau_sig**gamma * s**gamma) / (1 + tau_eps**alpha * s**alpha)


def law_2b(
    E_0: Quantity, tau_sig: Quantity, tau_eps: Quantity, alpha: Quantity, gamma: Quantity
) -> sp.Expr:
    """Return `law_2a` with ``(tau_sig s)**alpha`` added above.

    Parameters
    ----------
    E_0, tau_sig, tau_eps, alpha, gamma : str, float or sympy expression
        As in `law_2a`.
    """
    s, E_0, tau_sig, tau_eps, alpha, gamma = _symbols(E_0, tau_sig, tau_eps, alpha, gamma)
    above = 1 + tau_sig**alpha * s**alpha + tau_sig**gamma * s**gamma
    return E_0 * above / (1 + tau_eps**alpha * s**alpha)


def _symbols(*quantities: Quantity) -> tuple[sp.Expr, ...]:
    """Return the Laplace variable and the quantities as expressions."""
    import sympy as sp

    # A string is a name: sympify would read E, I or gamma as something of its own.
    given = (sp.Symbol(q) if isinstance(q, str) else sp.sympify(q) for q in quantities)
    return (sp.Symbol(LAPLACE), *given)
