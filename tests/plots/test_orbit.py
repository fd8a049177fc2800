import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import UsageError
from racs_bif.plots.orbit import KINDS, draw_period, orbit_picture, picture
from racs_bif.plots.orbit_multipliers import draw_circle, draw_multipliers
from racs_bif.plots.orbit_profiles import draw_phase, draw_profile


@pytest.fixture(scope="module")
def branch():
    hopf = rb.continue_equilibria(rb.load_model("adaptive_control"), "alpha", (0.5, 1.5))["H1"]
    return rb.continue_orbits(hopf, (0.0, 1.5), method="collocation", at=[0.9])


@pytest.fixture
def ax():
    from matplotlib.figure import Figure

    return Figure().add_subplot()


@pytest.mark.parametrize("what", KINDS)
def test_every_picture_is_drawn_again_from_a_file(branch, what, tmp_path):
    loaded = rb.load(rb.save(branch, tmp_path / "po.nc"))
    figure = picture(loaded, what)
    (axes,) = figure.axes
    assert axes.get_xlabel()
    assert axes.get_ylabel()
    assert len(axes.lines) > 0


def test_profiles_are_those_of_the_orbits(branch, ax):
    draw_profile(branch, ("UZ1", "PD1"), ax=ax)
    assert [line.get_label().split(",")[0] for line in ax.lines] == ["UZ1", "PD1"]
    drawn = ax.lines[0].get_ydata()
    k = branch["UZ1"].index
    assert drawn.max() == pytest.approx(branch.column("max x")[k], abs=1e-3)
    assert ax.lines[0].get_xdata()[-1] == 1.0


def test_the_phase_portrait_takes_other_states(branch, ax):
    draw_phase(branch, ("UZ1",), ("x", "z"), ax=ax)
    assert ax.get_ylabel() == "$z$"
    with pytest.raises(UsageError, match="unknown state 'q'"):
        draw_phase(branch, ("UZ1",), ("x", "q"), ax=ax)


def test_multipliers_on_the_circle_and_beyond_it(branch, ax):
    draw_circle(branch, "EP1", ax=ax)  # -16.8 lies beyond the picture
    assert [text.get_text() for text in ax.texts] == ["-17"]
    titles = [text.get_text() for text in ax.get_legend().get_texts()]
    assert titles == ["trivial", "unstable", "stable"]


def test_moduli_along_the_branch(branch, ax):
    draw_multipliers(branch, ax=ax)
    largest = ax.lines[0].get_ydata()
    k = branch["PD1"].index
    assert largest[k] == pytest.approx(1.0, abs=1e-6)
    assert ax.get_yscale() == "log"
    assert [text.get_text() for text in ax.texts] == ["PD1"]


def test_the_period_changes_its_pattern_with_stability(branch, ax):
    draw_period(branch, ax=ax)
    titles = [text.get_text() for text in ax.get_legend().get_texts()]
    assert titles == ["stable", "unstable"]
    drawn = np.concatenate([line.get_ydata() for line in ax.lines])
    assert np.nanmax(drawn) == pytest.approx(branch.column("period").max())


def test_the_picture_of_one_orbit_has_all_its_parts(branch):
    figure = orbit_picture(branch, "PD1")
    labels = {axes.get_ylabel() for axes in figure.axes}
    assert {"$x$", "$y$", "$z$", r"$\mathrm{Im}\,\mu$"} <= labels
    assert "period 6.364071" in figure.get_suptitle()


@pytest.mark.parametrize(
    ("draw", "names", "label"),
    [
        ("plot_profiles", ("UZ1",), "$x$"),
        ("plot_phase", ("UZ1",), "$y$"),
        ("plot_period", (), "period"),
        ("plot_multipliers", (), r"$|\mu|$"),
        ("plot_multipliers", ("PD1",), r"$\mathrm{Im}\,\mu$"),
    ],
)
def test_a_branch_draws_itself(branch, ax, draw, names, label):
    assert getattr(branch, draw)(*names, ax=ax) is ax
    assert ax.get_ylabel() == label


def test_what_cannot_be_drawn_says_so(branch):
    with pytest.raises(UsageError, match="unknown picture 'phases'; did you mean 'phase'"):
        picture(branch, "phases")
    with pytest.raises(UsageError, match="no orbit of PO1 is kept at 'PD7'"):
        picture(branch, "phase", ("PD7",))
    equilibria = rb.continue_equilibria(rb.load_model("adaptive_control"), "alpha", (0.5, 1.5))
    with pytest.raises(UsageError, match="must be a branch of orbits"):
        picture(equilibria, "period")
