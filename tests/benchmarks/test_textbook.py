"""The comparison on textbook problems: what is read, scored and shown; no peer is needed."""

import json
from dataclasses import replace

import numpy as np
import pytest

import racs_bif as rb


@pytest.fixture
def textbook(benchmark_module):
    return benchmark_module("_textbook")


@pytest.fixture
def peers(benchmark_module):
    return benchmark_module("_peers")


@pytest.fixture
def table(benchmark_module):
    return benchmark_module("textbook")


@pytest.fixture
def found(textbook):
    axon = textbook.PROBLEMS["hodgkin_huxley"]
    special = [("H", 9.7796380), ("H", 154.5266337), *axon.points[2:]]
    return textbook.Found(version="1", points=9, special=special, end=(154.5, 5.9))


def test_everything_found(textbook, found):
    score = textbook.score(textbook.PROBLEMS["hodgkin_huxley"], found)
    assert (score.found, score.missed, score.wrong) == (7, (), ())
    assert score.error == pytest.approx(abs(9.7796380 / 9.779637995393126 - 1.0))


def test_a_missed_point_a_wrong_one_and_one_met_again(textbook, found):
    special = [p for p in found.special if p[0] != "PD"]
    special += [("LPC", 6.2645), ("NS", 12.5), ("BPC", 154.526), ("EP", 154.5)]
    score = textbook.score(textbook.PROBLEMS["hodgkin_huxley"], replace(found, special=special))
    assert score.missed == ("PD at 7.84954", "PD at 7.92198")
    assert score.wrong == ("NS at 12.5",)
    assert score.error < 1e-8  # the second meeting does not count


def test_where_orbits_end(textbook):
    lorenz, brusselator = textbook.PROBLEMS["lorenz"], textbook.PROBLEMS["brusselator"]
    ends = textbook.Found(version="1", points=1, special=[("H", 470 / 19)], end=(13.95, 3.0))
    assert textbook.score(lorenz, ends).missed == ("the homoclinic orbit",)
    assert textbook.score(lorenz, replace(ends, limit=13.926557407520)).missed == ()
    short = textbook.Found(version="1", points=1, special=[("H", 2.0)], end=(3.0, 7.15691992118))
    assert textbook.score(brusselator, short).missed == ("orbits up to 4 (they end at 3)",)


def test_the_period_of_a_cycle(textbook):
    assert textbook.brusselator_period(3.0) == pytest.approx(7.15691992118, rel=1e-10)


@pytest.mark.parametrize("name", ["brusselator", "lorenz", "hodgkin_huxley", "chain"])
def test_texts_are_the_equations_of_our_models(textbook, name):
    problem = textbook.PROBLEMS[name]
    system = rb.load_model(problem.model, parameters={problem.parameter: 2.5})
    rng = np.random.default_rng(1)
    x = rng.uniform(0.5, 2.0, len(problem.equations))
    space = dict(zip(problem.equations, x, strict=True)) | {problem.parameter: 2.5}
    space["exp"] = np.exp
    space |= {k: eval(text, {}, space) for k, text in problem.given.items()}
    ours = system.field.f(x, system.values)
    texts = [eval(text, {}, space) for text in problem.equations.values()]
    np.testing.assert_allclose(texts, ours, rtol=1e-12, atol=1e-12)


def test_files_of_auto(benchmark_module):
    lines = [
        "   0            PT  TY LAB    PAR(1)        L2-NORM",
        "   1   -11   3    2  1.9999999922E+000  2.2360679E+000",
        "   1    12   0    0  2.2000000000E+000  1.0000000-101",
        "   1    13   9    3  4.1213205477E+000  1.0000000E+000",
    ]
    auto, driven = benchmark_module("_by_auto"), benchmark_module("_driven")
    rows = auto.rows(lines)
    assert rows[0] == (3, 2, [1.9999999922, 2.2360679])
    assert rows[1] == (0, 0, [2.2, 1e-101])
    assert driven.in_our_names(auto.named(rows), orbits=False) == [("H", 1.9999999922)]
    on_orbits = [("LP", 1.0), ("TR", 2.0), ("EP", 3.0), ("PD", 4.0)]
    assert driven.in_our_names(on_orbits, orbits=True) == [("LPC", 1.0), ("NS", 2.0), ("PD", 4.0)]


def test_problems_as_peers_have_them(textbook, benchmark_module):
    from dataclasses import asdict

    problem = json.loads(json.dumps(asdict(textbook.PROBLEMS["brusselator"])))
    ode = benchmark_module("_by_xpplab").written(problem)
    assert "x'=1-(B+1)*x+x^2*y\n" in ode
    assert ode.endswith("init y=1.0\ndone\n")
    func = benchmark_module("_by_bifpy").right_hand_side(problem)
    assert func([1.0, 2.0], [3.0]) == [-1.0, 1.0]


def test_what_a_driver_prints_is_read_whatever_comes_before(peers):
    line = {"version": "1", "points": 3, "special": [["H", 2.0]], "end": [4.0, 9.0], "seconds": [1]}
    found = peers.told("AUTO says hello\n{}\n" + json.dumps(line) + "\n\n")
    assert (found.special, found.end, found.limit) == ([("H", 2.0)], (4.0, 9.0), None)


def test_the_table_is_narrow_and_never_silent(textbook, peers, table, found):
    axon = textbook.PROBLEMS["hodgkin_huxley"]
    ours = peers.Cost(12.34, 10.25, 8.5, found)
    theirs = peers.Cost(None, 2.0, 1.7, replace(found, special=found.special[:2]))
    costs = {"racs_bif": ours, "xpplab 0.1.2": theirs, "bifpy 0.3.0": "no compiler"}
    rows, beneath = table.table(axon, costs)
    assert [row.count("|") for row in (*table.HEAD, *rows)] == [11] * 5
    assert max(map(len, (*table.HEAD, *rows))) <= 100
    assert "| 2.00 | 1.70 | 0.20 |" in rows[1]
    assert "| 2 of 7 |" in rows[1]
    assert "not run" in rows[2]
    assert "- Hodgkin-Huxley: bifpy 0.3.0 was not run: no compiler." in beneath
    assert "- Hodgkin-Huxley: xpplab 0.1.2 misses PD at 7.84954." in beneath


def test_why_a_program_failed_is_told(table):
    def fails():
        raise RuntimeError("Traceback ...\nModuleNotFoundError: No module named 'xpplab'\n")

    assert table.attempt(fails) == "ModuleNotFoundError: No module named 'xpplab'"
