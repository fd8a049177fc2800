"""Bode diagrams."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import UsageError
from racs_bif.plots.bode import draw, picture


@pytest.fixture(scope="module")
def vehicle():
    return rb.load_model("racs", parameters={"u": 8.0})


def test_gain_phase_and_error_are_what_they_say(vehicle):
    exact, realised = rb.element_response(vehicle), rb.element_transfer(vehicle)
    axes = draw(exact, realised)
    gain = axes[0].get_lines()[0].get_ydata()
    np.testing.assert_allclose(gain, 20 * np.log10(np.abs(exact.frdata[0, 0])))
    error = axes[2].get_lines()[0].get_ydata()
    inside = (exact.omega > 0.1) & (exact.omega < 50)
    assert error[inside].max() == pytest.approx(vehicle.realisation.error, rel=0.1)
    assert [ax.get_ylabel() for ax in axes] == ["gain [dB]", "phase [°]", "rel. error"]
    plt.close("all")


def test_one_of_several_channels_is_named(vehicle):
    exact = rb.frequency_response(vehicle, outputs=["v", "w"])
    realised = rb.to_control(vehicle, outputs=["w", "v"])  # in another order
    figure = picture(exact, realised, channel=("w", "delta_f"))
    known = 20 * np.log10(np.abs(exact.frdata[1, 0]))
    lines = figure.axes[0].get_lines()
    np.testing.assert_allclose(lines[0].get_ydata(), known)
    np.testing.assert_allclose(lines[1].get_ydata(), known, atol=0.5)
    with pytest.raises(UsageError, match="choose with channel"):
        picture(exact)
    with pytest.raises(UsageError, match="no 'x'; there are: v, w"):
        picture(exact, channel=("x", "delta_f"))


def test_without_a_realisation_there_are_two_panels(vehicle):
    figure = picture(rb.element_response(vehicle))
    assert len(figure.axes) == 2
    assert figure.axes[1].get_xlabel() == "frequency [rad/s]"
