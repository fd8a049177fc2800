"""The steps of a branch in the log."""

import logging

import numpy as np

from racs_bif.continuation import trace
from racs_bif.continuation.points import Point, SpecialPoint
from racs_bif.continuation.told import Table


def rows(caplog):
    """Return the rows of points, split into their columns."""
    return [line.split() for line in caplog.messages if line.split()[0].isdigit()]


def test_a_heading_stands_over_every_twenty_points(kinds, fold, caplog):
    with caplog.at_level(logging.INFO, logger="racs_bif.continuation"):
        branch = trace(fold, [1.0, 1.0], (0.0, 1.0), [kinds.Fold()], direction=-1)
    lines = caplog.messages
    rows = [line.split() for line in lines if line.split()[0].isdigit()]
    heads = [k for k, line in enumerate(lines) if line.split()[:2] == ["BR", "PT"]]
    assert [int(row[1]) for row in rows] == list(range(1, len(branch.points) + 1))
    assert len(rows) > 40
    assert heads == [1 + 21 * k for k in range(len(heads))]
    assert len(heads) == -(-len(rows) // 20)
    assert [row[2] for row in rows if row[2].isalpha()] == ["LP"]


def test_the_table_says_which_way_and_how_many_are_unstable(kinds, fold, caplog):
    with caplog.at_level(logging.INFO, logger="racs_bif.continuation"):
        trace(fold, [0.5, 0.25], (-0.5, 1.0))
    ways = [line.split()[-1] for line in caplog.messages if " in p, " in line]
    assert ways == ["forwards", "backwards"]
    first, last = rows(caplog)[0], rows(caplog)[-1]
    assert float(first[4]) > 0.0 > float(last[4])
    assert (first[5], last[5]) == ("0", "1")
    caplog.clear()
    blind = kinds.Scalar(lambda x, p: x - p, lambda x, p: 1.0, lambda x, p: -1.0, spectral=False)
    with caplog.at_level(logging.INFO, logger="racs_bif.continuation"):
        trace(blind, [0.0, 0.0], (0.0, 1.0))
    assert caplog.messages[0].endswith("in p, forwards")
    assert {row[5] for row in rows(caplog)} == {"-"}
    assert 0 < int(first[0]) < int(rows(caplog)[0][0])


def test_a_last_point_that_becomes_special_is_told_again(line, caplog):
    def at(p):
        z = np.array([p, p])
        return Point(z, np.ones(2), np.zeros(0, complex), None, 0, {"x": p}, p, 1)

    event = SpecialPoint("LP", "LP1", 1, np.ones(2), np.ones(2), np.zeros(0, complex), {}, 0.0)
    with caplog.at_level(logging.INFO, logger="racs_bif.continuation"):
        table = Table(line, 7, 1)
        nodes = [(at(0.0), None), (at(0.9), event), (at(2.0), None)]
        table.tell([nodes[0], (at(1.0), None)])
        table.tell(nodes[:2])
        assert [row[1] for row in rows(caplog)] == ["1", "2", "2"]
        table.tell(nodes)
    assert [row[1] for row in rows(caplog)] == ["1", "2", "2", "3"]
    assert [row[2:4] for row in rows(caplog) if row[2].isalpha()] == [["LP", "1"]]
    assert [row[-2] for row in rows(caplog)[1:]] == ["1.00E+00", "1.00E-01", "1.10E+00"]


def test_the_table_shows_all_of_few_unknowns_and_their_norm(line, caplog):
    z = np.array([3.0, 4.0, 0.5])
    point = Point(z, np.ones(3), np.zeros(0, complex), None, 0, {}, 0.0, 1)
    with caplog.at_level(logging.INFO, logger="racs_bif.continuation"):
        Table(line, 7, 1).tell([(point, None)])
    assert caplog.messages[1].split()[4:8] == ["p", "norm", "U(1)", "U(2)"]
    ((_, _, *shown, _, _),) = rows(caplog)
    assert [float(number) for number in shown] == [0.5, 5.0, 3.0, 4.0]


def test_the_table_shows_the_first_three_of_many_unknowns(line, caplog):
    point = Point(np.arange(6.0), np.ones(6), np.zeros(0, complex), None, 0, {}, 0.0, 1)
    with caplog.at_level(logging.INFO, logger="racs_bif.continuation"):
        Table(line, 7, 1).tell([(point, None)])
    head = caplog.messages[1].split()
    assert [name for name in head if name.startswith("U(")] == ["U(1)", "U(2)", "U(3)"]


def test_names_that_are_too_long_for_their_column_are_cut(kinds, caplog):
    problem = kinds.Scalar(lambda x, p: x - p, lambda x, p: 1.0, lambda x, p: -1.0)
    problem.parameter = "a_parameter_of_a_long_name"
    with caplog.at_level(logging.INFO, logger="racs_bif.continuation"):
        trace(problem, [0.0, 0.0], (0.0, 1.0))
    head = next(line for line in caplog.messages if line.split()[0] == "BR")
    assert head.split()[4:7] == ["a_parameter..", "norm", "x"]
    assert len(head) == len(next(line for line in caplog.messages if line.split()[0].isdigit()))
