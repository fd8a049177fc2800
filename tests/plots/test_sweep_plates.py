"""Panels, sweeps, portraits and multipliers, and the files of a plate."""

from __future__ import annotations

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import FileError
from racs_bif.plots import multipliers, phase, sweep
from racs_bif.plots.panels import common_legend, letter, panels
from racs_bif.plots.plate import Plate, plain, read_plate, stated, write_plate
from racs_bif.verbs.shed import shed_diagram
from racs_bif.verbs.sweep import sweep as computed


@pytest.fixture(scope="module")
def model():
    return rb.model_from_strings(
        "normal_form",
        {"x": "mu*x-y-x*(x**2+y**2)", "y": "x+mu*y-y*(x**2+y**2)"},
        parameters={"mu": -0.2},
    )


@pytest.fixture(scope="module")
def case(model):
    diagram, _ = shed_diagram(model, "mu", (-0.5, 0.5), at=(0.25,))
    found = computed(
        model, "mu", np.linspace(-0.5, 0.5, 6), quantity="x", initial={"x": 0.1}, duration=30.0
    )
    return sweep.Case(r"at $k_{1}$ = 3", found, diagram, {"a mark": 0.1})


def inside(figure):
    """Say whether all texts of a figure are on it."""
    figure.draw_without_rendering()
    width, height = figure.bbox.size
    texts = [t for ax in figure.axes for t in (ax.xaxis.label, ax.yaxis.label, ax.title)]
    boxes = [t.get_window_extent() for t in texts if t.get_text()]
    boxes += [legend.get_window_extent() for legend in figure.legends]
    return all(b.x0 >= 0 and b.y0 >= 0 and b.x1 <= width and b.y1 <= height for b in boxes)


def test_panels_have_their_places_letters_and_one_legend(case):
    figure = sweep.picture([case, case], columns=2)
    assert [ax.get_title(loc="left")[:3] for ax in figure.axes] == ["(a)", "(b)"]
    assert all(ax.get_legend() is None for ax in figure.axes)
    (legend,) = figure.legends
    titles = [text.get_text() for text in legend.get_texts()]
    assert len(titles) == len(set(titles))
    assert "a mark" in titles
    assert inside(figure)


def test_what_is_next_to_nothing_is_not_magnified(case):
    (ax,) = sweep.picture([case], least=10.0).axes
    assert np.ptp(ax.get_ylim()) >= 10.0


def test_a_sweep_is_told_in_words(case):
    text = sweep.describe(case)
    assert text.startswith("at k_1 = 3: ")
    assert "Hopf point H1 at mu = 0, 1 rad/s, supercritical" in text
    assert "PO1 followed from 0 to 0.5" in text
    assert "oscillating 0.1 to 0.5" in text


def test_portrait_of_a_stable_orbit(model, case):
    history = rb.simulate(model, 20.0, initial={"x": 0.1}, step=0.05)
    orbits = case.diagram["PO1"]
    profile = orbits.profiles[orbits.at(mu=0.25).name]
    figure, (ax,) = panels(1, 1, legend_rows=3)
    phase.draw(
        history,
        ("x", "y"),
        orbits=((profile, True),),
        equilibria=(({"x": 0.0, "y": 0.0}, False),),
        late=10.0,
        ax=ax,
    )
    common_legend(figure, [ax], columns=2)
    loop = next(line for line in ax.get_lines() if line.get_label() == "orbit, stable")
    assert np.hypot(*loop.get_xydata().T) == pytest.approx(np.full(1201, 0.5), rel=1e-5)
    assert inside(figure)


def test_multipliers_are_drawn_about_the_unit_circle():
    _, (ax,) = panels(1, 1, legend_rows=0)
    multipliers.draw({"one": np.array([1.0, 0.5j, np.nan])}, ax=ax)
    circle, *_, dots = ax.get_lines()
    assert np.hypot(*circle.get_xydata().T) == pytest.approx(np.ones(361))
    assert dots.get_xydata().tolist() == [[1.0, 0.0], [0.0, 0.5]]
    letter([ax], ["alone"])
    assert ax.get_title(loc="left") == "alone"


def test_a_plate_is_read_as_it_was_written(tmp_path):
    figure, _ = panels(1, 1)
    plate = Plate("A title", ("One.", "Two."), {"u": np.array([1.0, np.nan]), "kinds": ["rest"]})
    path = write_plate(tmp_path / "new", "name", figure, plate)
    assert path == tmp_path / "new" / "name.png"
    found = read_plate(path.parent, "name")
    assert (found.title, found.caption) == (plate.title, plate.caption)
    assert found.numbers == {"u": [1.0, None], "kinds": ["rest"]}
    text = (path.parent / "name.md").read_text(encoding="utf-8")
    assert text == "# A title\n\n![A title](name.png)\n\nOne.\n\nTwo.\n"
    assert read_plate(tmp_path, "other") is None
    (path.parent / "name.json").write_text("{}", encoding="utf-8")
    with pytest.raises(FileError, match="describes no figure"):
        read_plate(path.parent, "name")


def test_parameters_are_stated_with_units():
    assert stated(rb.load_model("racs", parameters={"u": 12}), "u", "alpha") == (
        "u = 12 m/s, alpha = 0.3"
    )
    assert plain(r"$\delta_{f}$ = 1") == "delta_f = 1"
