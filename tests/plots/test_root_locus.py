"""Pictures of root loci."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

import racs_bif as rb
from racs_bif.plots.root_locus import draw, picture


@pytest.fixture(scope="module")
def locus():
    return rb.root_locus(rb.continue_equilibria(rb.load_model("racs"), "u", (5, 30)))


@pytest.fixture
def ax():
    figure, axes = plt.subplots()
    yield axes
    plt.close(figure)


def test_pairs_are_in_the_window_and_fast_memory_is_not(locus, ax):
    assert draw(locus, ax=ax) is ax
    left, right = ax.get_xlim()
    pairs = locus.eigenvalues[np.abs(locus.eigenvalues.imag) > 1e-3]
    assert left < pairs.real.min() < pairs.real.max() < right
    assert left > locus.eigenvalues.real.min()
    low, high = ax.get_ylim()
    assert low < pairs.imag.min() < pairs.imag.max() < high


def test_hopf_points_and_both_ends_are_marked(locus, ax):
    draw(locus, ax=ax)
    assert "H1" in [text.get_text() for text in ax.texts]
    labels = [text.get_text() for text in ax.get_legend().get_texts()]
    assert labels == ["$u$ = 5", "$u$ = 30"]
    assert ax.get_xlabel() == "Re s [1/s]"


def test_a_window_is_obeyed(locus, ax):
    draw(locus, window=(-3.0, 3.0, 0.0, 15.0), ax=ax)
    assert (ax.get_xlim(), ax.get_ylim()) == ((-3.0, 3.0), (0.0, 15.0))


def test_multipliers_are_drawn_with_the_unit_circle(orbit_locus, ax):
    draw(orbit_locus, ax=ax)
    assert ax.get_xlim()[0] < -1.0
    assert ax.get_xlabel().endswith(r"\mu$")


@pytest.fixture
def orbit_locus(diagram):
    return rb.root_locus(diagram.branches[1])


def test_a_real_spectrum_has_a_picture_too():
    model = rb.model_from_strings("real", {"x": "-p*x"}, parameters={"p": 1.0})
    figure = picture(rb.root_locus(rb.continue_equilibria(model, "p", (0.5, 2.0))))
    assert len(figure.axes) == 2
