"""The loop through a fractional element, cut open at its output, and its margins.

The rest of the model, linearised, answers the output w of the element with its input e = H(s) w,
and the element closes the loop by w = Z(s) e. The loop transfer is L = -Z H, in the convention of
negative feedback: the roots of 1 + L are the characteristic roots, and a Hopf point is where
L(i omega) = -1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.interop.operating import operating_point
from racs_bif.interop.response import (
    exact_point,
    exact_weights,
    find_element,
    frequencies,
    response_data,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from racs_bif.fractional.laws import Complex
    from racs_bif.fractional.system import System
    from racs_bif.interop.operating import OperatingPoint
    from racs_bif.results.special import SpecialPoint
    from racs_bif.symbolic.field import Array
    from racs_bif.symbolic.model import Model

_TOLERANCE: Final = 1e-13


@dataclass(frozen=True, kw_only=True, eq=False)
class Margins:
    """Stability margins, named as `control.stability_margins` names them.

    Parameters
    ----------
    gm : float
        Gain margin: the factor nearest to 1 by which the element may be multiplied until a root
        reaches the imaginary axis. Infinite where there is none.
    pm : float
        Phase margin, of least modulus [deg]; infinite where there is none.
    sm : float
        Least distance of L(i omega) from -1.
    wpc, wgc, wms : float
        Their frequencies [rad/s]; NaN where there is none.
    gains, phases : array (k,), array (l,)
        All gain and phase margins in the range searched.
    gain_omega, phase_omega : array (k,), array (l,)
        Their frequencies [rad/s].
    """

    gm: float
    pm: float
    sm: float
    wpc: float
    wgc: float
    wms: float
    gains: Array
    phases: Array
    gain_omega: Array
    phase_omega: Array


def loop_response(
    point: SpecialPoint | System | Model,
    element: str | None = None,
    omega: ArrayLike | None = None,
) -> Any:  # noqa: ANN401 - control has no types
    """Return the exact loop transfer L(i omega) through a fractional element.

    Parameters
    ----------
    point : SpecialPoint, System or Model
        As for `racs_bif.to_control`.
    element : str, optional
        Output of the element at which the loop is cut; may be left out where there is but one.
    omega : array (m,), optional
        As for `racs_bif.frequency_response`.

    Returns
    -------
    control.FrequencyResponseData
        1 + L = 0 gives the characteristic roots; `control.nyquist_plot` and `control.margin` take
        it as it is.

    Raises
    ------
    UsageError
        If there is no such element, or frequencies are not ascending or negative.

    Examples
    --------
    >>> import racs_bif as rb
    >>> at_hopf = rb.load_model("racs", parameters={"u": 10.2})
    >>> complex(rb.loop_response(at_hopf, "delta_z", [9.5200832]).frdata[0, 0, 0].round(6))
    (-1+0j)
    """
    place = operating_point(point)
    k, name = find_element(place.system, element)
    at = frequencies(place.system, omega, above_zero=place.system.exact.laws(place.p)[k].integrates)
    response = _loop(place, k)(at)[:, None, None]
    return response_data(response, at, (name,), (f"returned_{name}",), f"exact loop of {name}")


def loop_transfer(point: SpecialPoint | System | Model, element: str | None = None) -> Any:  # noqa: ANN401
    """Return the loop transfer through a fractional element as it is realised.

    Parameters
    ----------
    point, element
        As for `loop_response`.

    Returns
    -------
    control.StateSpace
        The poles of ``control.feedback(loop)`` are the eigenvalues of the linearised model.

    Raises
    ------
    UsageError
        If there is no such element.
    """
    import control

    place = operating_point(point)
    system = place.system
    k, name = find_element(system, element)
    frame = system.field.frame(place.p)
    ny, bank, f = len(system.states), frame.bank, frame.filters[k]
    # Without its feedthrough the core takes the element's output itself, not its memory alone.
    P, X = frame.P.copy(), system.field.core_point(place.x, place.p).copy()
    P[len(place.p) + k] = 0.0
    X[ny + k] = exact_point(place)[ny + k]
    J = system.compiled.core_jacobian(X, P)
    through = J[:, ny + k].copy()
    J[:, ny + k] = 0.0
    A = bank.left @ J @ bank.right
    A[ny:, ny:] += bank.A
    read = bank.C[k] @ np.eye(len(A))[ny:] + f.D * (J[ny + k] @ bank.right)
    return control.StateSpace(
        A,
        bank.spread(through[:, None]),
        -read[None, :],
        [[-f.D * through[ny + k]]],
        name=f"loop of {name}",
        inputs=[name],
        outputs=[f"returned_{name}"],
        states=list(system.field.states),
    )


def margins(
    point: SpecialPoint | System | Model,
    element: str | None = None,
    omega: ArrayLike | None = None,
) -> Margins:
    """Return the stability margins of the exact loop through a fractional element.

    Crossings are looked for between the frequencies given and then solved for on the exact
    operator; two crossings between the same two frequencies are missed.

    Parameters
    ----------
    point, element, omega
        As for `loop_response`.

    Returns
    -------
    Margins

    Raises
    ------
    UsageError
        If there is no such element, or frequencies are not ascending or negative.

    Examples
    --------
    >>> import racs_bif as rb
    >>> found = rb.margins(rb.load_model("racs", parameters={"u": 8}))
    >>> round(found.gm, 4), round(found.pm, 3)
    (0.908, 7.14)
    """
    place = operating_point(point)
    k, _ = find_element(place.system, element)
    at = frequencies(place.system, omega)
    at = at[at > 0.0]
    loop = _loop(place, k)

    def one(w: float) -> complex:
        return complex(loop(np.array([w]))[0])

    values = loop(at)
    turned = _crossings(lambda w: one(w).imag, at, values.imag)
    turned = np.array([w for w in turned if one(w).real < 0.0])
    level = _crossings(lambda w: abs(one(w)) - 1.0, at, np.abs(values) - 1.0)
    gains = np.array([1.0 / abs(one(w)) for w in turned])
    phases = np.array([np.degrees(np.angle(-one(w))) for w in level])
    gm, wpc = _least(gains, turned, np.abs(np.log(gains)))
    pm, wgc = _least(phases, level, np.abs(phases))
    sm, wms = _nearest_to_critical(one, at, values)
    return Margins(
        gm=gm,
        pm=pm,
        sm=sm,
        wpc=wpc,
        wgc=wgc,
        wms=wms,
        gains=gains,
        phases=phases,
        gain_omega=turned,
        phase_omega=level,
    )


def _loop(place: OperatingPoint, k: int) -> Callable[[Array], Complex]:
    """Return L as a function of frequencies (m,), all other elements closed."""
    system = place.system
    X, row = exact_point(place), len(system.states) + k
    J = system.compiled.core_jacobian(X, system.compiled.padded(place.p))
    others = np.delete(np.arange(len(X)), row)
    inner, drive = J[np.ix_(others, others)], J[others, row]
    diagonal = np.arange(len(others))

    def loop(omega: Array) -> Complex:
        left, right = exact_weights(place, omega)
        delta = -right[:, others, None] * inner
        delta[:, diagonal, diagonal] += left[:, others]
        answer = np.linalg.solve(delta, (right[:, others] * drive)[:, :, None])[:, :, 0]
        back = answer @ J[row, others] + J[row, row]
        return np.asarray(-right[:, row] / left[:, row] * back)

    return loop


def _crossings(function: Callable[[float], float], omega: Array, values: Array) -> Array:
    from scipy.optimize import brentq

    before = np.flatnonzero(np.sign(values[:-1]) * np.sign(values[1:]) < 0)
    found = [brentq(function, omega[i], omega[i + 1], xtol=1e-300, rtol=_TOLERANCE) for i in before]
    return np.sort(np.array([*found, *omega[values == 0.0]], dtype=float))


def _least(values: Array, omega: Array, sizes: Array) -> tuple[float, float]:
    if not len(values):
        return float("inf"), float("nan")
    k = int(np.argmin(sizes))
    return float(values[k]), float(omega[k])


def _nearest_to_critical(
    one: Callable[[float], complex], omega: Array, values: Complex
) -> tuple[float, float]:
    from scipy.optimize import minimize_scalar

    k = int(np.argmin(np.abs(values + 1.0)))
    low, high = omega[max(k - 1, 0)], omega[min(k + 1, len(omega) - 1)]
    if not low < high:
        return float(abs(values[k] + 1.0)), float(omega[k])
    found = minimize_scalar(
        lambda w: abs(one(w) + 1.0), bounds=(low, high), method="bounded", options={"xatol": 1e-12}
    )
    return float(found.fun), float(found.x)
