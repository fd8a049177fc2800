from itertools import pairwise

import numpy as np
import pytest

from racs_bif import TimeHistory
from racs_bif.errors import UsageError
from racs_bif.plots.history import draw, picture
from racs_bif.plots.style import COLUMN, save_picture
from racs_bif.results.provenance import SystemInfo


@pytest.fixture
def history():
    t = np.linspace(0.0, 4.0, 401)
    return TimeHistory(
        times=t,
        state_names=("x", "delta_c"),
        states=np.column_stack([np.cos(2.0 * t), 40.0 * np.sin(t)]),
        outputs={"F": t},
        system=SystemInfo(model="m", units={"x": "m", "F": "N"}, shown="delta_c"),
        operator="exact",
        method="bdf2",
        history="rest",
        step=0.01,
        order=2.0,
    )


def test_one_column_is_drawn_against_time(history):
    ax = history.plot()
    (line,) = ax.get_lines()
    assert line.get_ydata() == pytest.approx(history.column("delta_c"))
    assert ax.get_xlabel() == "time [s]"
    assert ax.get_ylabel() == r"$\delta_{c}$"
    ax = draw(history, "x")
    assert ax.get_ylabel() == "$x$ [m]"


def test_several_columns_differ_in_pattern_and_have_a_legend(history):
    ax = draw(history, "x", "delta_c")
    assert len({line.get_linestyle() for line in ax.get_lines()}) == 2
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["$x$", r"$\delta_{c}$"]
    with pytest.raises(UsageError, match="no 'y'"):
        draw(history, "y")


def test_a_picture_has_a_strip_for_each(history, tmp_path):
    figure = picture(history, "x", "delta_c", "F")
    top, middle, bottom = figure.axes
    assert [ax.get_xlabel() for ax in figure.axes] == ["", "", "time [s]"]
    assert top.get_xlim() == middle.get_xlim() == bottom.get_xlim() == (0.0, 4.0)
    assert figure.get_figwidth() == pytest.approx(COLUMN)
    figure.draw_without_rendering()
    boxes = [ax.get_tightbbox() for ax in figure.axes]
    assert all(a.y0 >= b.y1 for a, b in pairwise(boxes))
    save_picture(figure, tmp_path / "h.svg")
    assert "<svg" in (tmp_path / "h.svg").read_text()
    assert len(picture(history).axes) == 1
