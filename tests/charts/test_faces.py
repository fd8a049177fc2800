import numpy as np
import pytest

from racs_bif.charts.faces import divide


def circle(radius, middle=(0.5, 0.5), points=200):
    angle = np.linspace(0.0, 2.0 * np.pi, points + 1)
    line = np.array(middle) + radius * np.column_stack([np.cos(angle), np.sin(angle)])
    line[-1] = line[0]
    return line


def areas(*lines):
    return sorted(face.area for face in divide([np.array(line, dtype=float) for line in lines]))


def test_nothing_leaves_the_square_whole():
    assert areas() == [1.0]


def test_a_line_across_parts_it():
    assert areas([[0.25, 0.0], [0.25, 1.0]]) == pytest.approx([0.25, 0.75])


def test_two_lines_that_cross_give_four():
    found = areas([[0.25, 0.0], [0.25, 1.0]], [[0.0, 0.5], [1.0, 0.5]])
    assert found == pytest.approx([0.125, 0.125, 0.375, 0.375])


def test_a_line_that_crosses_itself_gives_a_loop():
    found = areas([[0.0, 0.2], [0.8, 0.2], [0.8, 0.8], [0.4, 0.8], [0.4, 0.0]])
    assert found == pytest.approx([0.08, 0.24, 0.68])


def test_an_island_is_a_hole():
    inner, outer = sorted(divide([circle(0.2)]), key=lambda face: face.area)
    assert inner.area == pytest.approx(np.pi * 0.04, rel=1e-3)
    assert outer.area == pytest.approx(1.0 - inner.area)
    assert len(outer.holes) == 1
    assert outer.contains(np.array([[0.5, 0.5], [0.9, 0.9]])).tolist() == [False, True]


def test_an_island_in_a_lake_on_an_island():
    found = areas(circle(0.4), circle(0.3), circle(0.1))
    rings = np.pi * np.array([0.01, 0.09 - 0.01, 0.16 - 0.09])
    assert found == pytest.approx(sorted([*rings, 1.0 - np.pi * 0.16]), rel=1e-3)


def test_islands_side_by_side_are_two_holes_of_one_region():
    found = divide([circle(0.1, (0.3, 0.5)), circle(0.1, (0.7, 0.5))])
    assert len(found) == 3
    assert len(found[0].holes) == 2


def test_a_line_that_almost_reaches_another_ends_on_it():
    found = areas([[0.5, 0.0], [0.5, 1.0]], [[0.501, 0.5], [1.0, 0.5]])
    assert found == pytest.approx([0.25, 0.25, 0.5])


def test_a_line_that_ends_within_parts_nothing():
    assert areas([[0.5, 0.0], [0.5, 0.5]]) == pytest.approx([1.0])
