"""The realised model, linearised, as a state-space system of python-control."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from racs_bif.interop.channels import choose_channels, linearised_core
from racs_bif.interop.operating import operating_point

if TYPE_CHECKING:
    from collections.abc import Sequence

    from racs_bif.fractional.system import System
    from racs_bif.results.special import SpecialPoint
    from racs_bif.symbolic.model import Model


def to_control(
    point: SpecialPoint | System | Model,
    *,
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] | None = None,
    forces: Sequence[str] = (),
) -> Any:  # noqa: ANN401 - control has no types
    """Linearise a model at an equilibrium.

    All derivatives are exact. Signals are deviations from the equilibrium. The memory states of a
    fractional element's realisation are states of the result; what the exact operator makes of the
    same inputs and outputs is `racs_bif.frequency_response`.

    Parameters
    ----------
    point : SpecialPoint, System or Model
        A point of a branch of equilibria, for example ``branch.at(u=12)``; or a model, which is
        linearised at its own parameter values.
    inputs : sequence of str, optional
        Parameters, base or derived, that act as inputs [their units]. Where left out: those that
        the model names (`Model.inputs`), or, if it names none, all base parameters in no law.
    outputs : sequence of str, optional
        States, outputs of the model, outputs of its elements. States and outputs of the model
        where left out.
    forces : sequence of str
        States on whose equation of motion something acts: an input ``force_STATE`` is added to
        the right-hand side of each, before the mass matrix is inverted.

    Returns
    -------
    control.StateSpace
        With named inputs, outputs and states.

    Raises
    ------
    UsageError
        If a name is unknown or given twice, or the point is no equilibrium.
    ParameterError
        If a parameter is unknown, or a law depends on it.
    ConvergenceError
        If a model's equilibrium is not found.

    Examples
    --------
    >>> import racs_bif as rb
    >>> vehicle = rb.load_model("racs", parameters={"u": 12})
    >>> plant = rb.to_control(vehicle, inputs=["delta_f"], outputs=["w"], forces=["v"])
    >>> plant.input_labels, plant.nstates
    (['delta_f', 'force_v'], 18)
    """
    import control

    place = operating_point(point)
    system = place.system
    channels = choose_channels(place, inputs, outputs, forces)
    frame = system.field.frame(place.p)
    core = linearised_core(place, channels, system.field.core_point(place.x, place.p), frame.P)
    bank = frame.bank
    A = system.field.f_x(place.x, place.p)
    return control.StateSpace(
        A,
        bank.spread(core.B),
        core.G @ bank.right,
        core.D,
        name=system.name,
        inputs=list(channels.inputs),
        outputs=list(channels.outputs),
        states=list(system.field.states),
    )
