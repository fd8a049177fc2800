"""The picture of a phase response curve."""

import numpy as np
import pytest

from racs_bif.errors import UsageError
from racs_bif.orbits.phase_response import PhaseResponse
from racs_bif.plots.phase_response import draw, picture


@pytest.fixture
def response():
    times = np.linspace(0.0, 2.0, 101)
    wave = np.stack((np.cos(np.pi * times), np.sin(np.pi * times)))
    return PhaseResponse(
        states=("v", "delta_c"),
        times=times,
        profile=wave,
        orbit=3.0 * wave[::-1],
        period=2.0,
        error=1e-9,
        units={"v": "m/s", "delta_c": "rad"},
    )


def test_a_strip_for_each_state(response):
    figure = picture(response)
    left, right = figure.axes[:2], figure.axes[2:]
    assert [ax.get_ylabel() for ax in left] == [
        r"advance $\partial t / \partial$$v$ [s/(m/s)]",
        r"advance $\partial t / \partial$$\delta_{c}$ [s/rad]",
    ]
    assert [ax.get_ylabel() for ax in right] == ["$v$ [m/s]", r"$\delta_{c}$ [rad]"]
    assert [ax.get_xlabel() for ax in left] == ["", "time of the kick [s]"]
    for k, (ax, behind) in enumerate(zip(left, right, strict=True)):
        np.testing.assert_array_equal(ax.lines[-1].get_ydata(), response.profile[k])
        np.testing.assert_array_equal(behind.lines[0].get_ydata(), response.orbit[k])
        assert ax.get_xlim() == (0.0, 2.0)
        assert ax.get_zorder() > behind.get_zorder()


def test_one_state_on_given_axes(response):
    from matplotlib.figure import Figure

    ax = Figure().add_subplot()
    assert draw(response, "delta_c", ax=ax) is ax
    np.testing.assert_array_equal(ax.lines[-1].get_ydata(), response.profile[1])
    assert len(picture(response, "delta_c").axes) == 2


def test_a_state_that_is_not_there_is_named(response):
    with pytest.raises(UsageError, match=r"no state 'delta'.*delta_c"):
        picture(response, "delta")
