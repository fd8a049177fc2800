"""Frequency responses of the exact fractional operator, and its elements as control's objects."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.errors import UsageError, nearest
from racs_bif.interop.channels import choose_channels, linearised_core
from racs_bif.interop.operating import operating_point
from racs_bif.shelf.load import system_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from racs_bif.fractional.laws import Complex
    from racs_bif.fractional.system import System
    from racs_bif.interop.operating import OperatingPoint
    from racs_bif.results.special import SpecialPoint
    from racs_bif.symbolic.field import Array
    from racs_bif.symbolic.model import Model

_MARGIN = 100.0
"""How far beyond the model's band frequencies reach that the user leaves to us."""
_COUNT = 1000


def frequency_response(
    point: SpecialPoint | System | Model,
    omega: ArrayLike | None = None,
    *,
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] | None = None,
    forces: Sequence[str] = (),
) -> Any:  # noqa: ANN401 - control has no types
    """Return the frequency response of the exact fractional operator: nothing is realised.

    Parameters
    ----------
    point, inputs, outputs, forces
        As for `racs_bif.to_control`.
    omega : array (m,), optional
        Ascending frequencies [rad/s]; a thousand from a hundredth of the realisation's band to a
        hundred times it where left out.

    Returns
    -------
    control.FrequencyResponseData
        (outputs, inputs, m), with named inputs and outputs; on its own frequencies only.

    Raises
    ------
    UsageError
        If a name is unknown, or frequencies are not ascending or negative.
    ParameterError
        If a parameter is unknown, or a law depends on it.

    Examples
    --------
    >>> import racs_bif as rb
    >>> vehicle = rb.load_model("racs", parameters={"u": 12})
    >>> exact = rb.frequency_response(vehicle, [1.0, 9.0], inputs=["delta_f"], outputs=["w"])
    >>> [round(float(gain), 4) for gain in abs(exact.frdata[0, 0])]
    [1.5457, 6.7976]
    """
    place = operating_point(point)
    system, at = place.system, frequencies(place.system, omega)
    channels = choose_channels(place, inputs, outputs, forces)
    X = exact_point(place)
    core = linearised_core(place, channels, X, system.compiled.padded(place.p))
    left, right = exact_weights(place, at)
    delta = -right[:, :, None] * core.J
    k = np.arange(len(X))
    delta[:, k, k] += left
    answer = np.linalg.solve(delta, right[:, :, None] * core.B)
    response: Complex = np.asarray(core.G @ answer + core.D, dtype=np.complex128)
    return response_data(response, at, channels.inputs, channels.outputs, system.name)


def element_response(
    model: Model | System, element: str | None = None, omega: ArrayLike | None = None
) -> Any:  # noqa: ANN401 - control has no types
    """Return the exact frequency response Z(i omega) of a fractional element.

    Parameters
    ----------
    model : Model or System
        The model, with its parameter values.
    element : str, optional
        Output of the element, for example ``"delta_z"``; may be left out where there is but one.
    omega : array (m,), optional
        As for `frequency_response`.

    Returns
    -------
    control.FrequencyResponseData

    Raises
    ------
    UsageError
        If there is no such element, or frequencies are not ascending or negative.

    Examples
    --------
    >>> import racs_bif as rb
    >>> spring = rb.model_from_strings("spring", {"x": "-w"}, parameters={},
    ...                                elements=[("w", "x", "s**0.5")])
    >>> complex(rb.element_response(spring, "w", [4.0]).frdata[0, 0, 0].round(6))
    (1.414214+1.414214j)
    """
    system = system_of(model)
    k, name = find_element(system, element)
    law = system.exact.laws(system.values)[k]
    at = frequencies(system, omega, above_zero=law.integrates)
    s: Complex = np.asarray(1j * at, dtype=np.complex128)
    response = np.asarray(law(s))[:, None, None]
    return response_data(response, at, (f"input_of_{name}",), (name,), f"exact {name}")


def element_transfer(model: Model | System, element: str | None = None) -> Any:  # noqa: ANN401
    """Return a fractional element as it is realised.

    Parameters
    ----------
    model, element
        As for `element_response`; the system's realisation is used.

    Returns
    -------
    control.TransferFunction
        Of integer order.

    Raises
    ------
    UsageError
        If there is no such element.

    Examples
    --------
    >>> import racs_bif as rb
    >>> realised = rb.element_transfer(rb.load_model("racs"), "delta_z")
    >>> len(realised.poles()), round(float(realised.dcgain()), 9)
    (14, 1.0)
    """
    import control

    system = system_of(model)
    k, name = find_element(system, element)
    f = system.field.frame(system.values).filters[k]
    # det(s - A + B C) = det(s - A) (1 + C (s - A)^-1 B), whatever the order of the filter.
    poles = np.poly(f.A) if len(f.B) else np.ones(1)
    zeros = np.poly(f.A - np.outer(f.B, f.C)) if len(f.B) else np.ones(1)
    return control.TransferFunction(
        np.real(zeros + (f.D - 1.0) * poles),
        np.real(poles),
        name=f"realised {name}",
        inputs=[f"input_of_{name}"],
        outputs=[name],
    )


def find_element(system: System, element: str | None) -> tuple[int, str]:
    """Return place and name of an element.

    Raises
    ------
    UsageError
        If there is no such element, or it has to be named.
    """
    known = system.compiled.elements
    if not known:
        msg = f"model '{system.name}' has no fractional element; take a model that has one"
        raise UsageError(msg)
    if element is None and len(known) > 1:
        msg = f"model '{system.name}' has several elements; name one of {', '.join(known)}"
        raise UsageError(msg)
    name = known[0] if element is None else element
    if name not in known:
        msg = f"model '{system.name}' has no element '{name}'; {nearest(name, known)}"
        raise UsageError(msg)
    return known.index(name), name


def frequencies(system: System, omega: ArrayLike | None, *, above_zero: bool = False) -> Array:
    """Return the frequencies that are meant, (m,).

    Raises
    ------
    UsageError
        If they are not ascending, not finite or negative; or zero where that is excluded.
    """
    if omega is None:
        low, high = system.settings.band
        return np.geomspace(low / _MARGIN, high * _MARGIN, _COUNT)
    at = np.atleast_1d(np.asarray(omega, dtype=float))
    usable = at.ndim == 1 and at.size and np.all(np.isfinite(at)) and at[0] >= 0.0
    if not usable or np.any(np.diff(at) <= 0.0):
        msg = "the frequencies omega must be finite and ascend from zero on, in rad/s"
        raise UsageError(msg)
    if above_zero and at[0] == 0.0:
        msg = "the element integrates: its gain at omega = 0 is infinite; begin above zero"
        raise UsageError(msg)
    return at


def exact_point(place: OperatingPoint) -> Array:
    """Return X = (y, w) of the exact model at an operating point."""
    return place.system.exact_point(place.x, place.p)


def exact_weights(place: OperatingPoint, omega: Array) -> tuple[Complex, Complex]:
    """Return the diagonals (m, size) of the characteristic matrix at i omega."""
    s: Complex = np.asarray(1j * omega, dtype=np.complex128)
    exact = place.system.exact
    laws = exact.laws(place.p)
    one = np.ones_like(s)
    left = [*[s] * exact.ny, *(law.denominator(s) for law in laws)]
    right = [*[one] * exact.ny, *(law.numerator(s) for law in laws)]
    return np.stack(left, axis=1), np.stack(right, axis=1)


def response_data(
    response: Complex,
    omega: Array,
    inputs: tuple[str, ...],
    outputs: tuple[str, ...],
    name: str,
) -> Any:  # noqa: ANN401 - control has no types
    """Return responses (m, q, k) as control's object."""
    import control

    return control.FrequencyResponseData(
        np.moveaxis(response, 0, 2),
        omega,
        inputs=list(inputs),
        outputs=list(outputs),
        name=name,
    )
