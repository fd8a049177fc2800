"""Right-hand sides that raise, return what they must not, or change their minds."""

import math

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import ModelError

HEAD = "import math\nimport racs_bif as rb\n\n\ndef rates(x, p):\n"
TAIL = (
    "\n\n\ndef model():\n    return rb.model_from_function('toy', rates, states=['x', 'y'], "
    "parameters={'a': 1.0})\n"
)
FAILING = {
    "raises": ("    raise RuntimeError('no data')", "raises RuntimeError at x = 0, y = 0, a = 1"),
    "exits": ("    raise SystemExit(3)", "raises SystemExit"),
    "divides": ("    return [1 // 0 if p.a is None else None, 1]", "returns NoneType for 'x'"),
    "wrong length": ("    return [p.a]", "returns 1 number; return 2"),
    "nothing": ("    x[0] + 1", "returns nothing"),
    "complex": ("    return [1j, x[1]]", "returns a complex number"),
    "text": ("    return 'ab'", "returns str"),
    "recursion": ("    return rates(x, p)", "raises RecursionError"),
    "a name": ("    return [b, x[1]]", "raises NameError"),
    "NaN": ("    return [math.nan, x[1]]", "not finite"),
    "infinity": ("    return [math.inf, x[1]]", "not finite"),
}


@pytest.mark.parametrize("case", FAILING)
def test_failing_functions_through_the_command_line(case, command):
    body, words = FAILING[case]
    status, said = command(HEAD + body + TAIL)
    assert status == 2
    assert words in said
    assert "toy" in said or "hostile.py" in said
    assert len(said.splitlines()) == 1


def test_integers_are_numbers(command):
    assert command(HEAD + "    return [int(1) - x[0], 2 * x[1]]" + TAIL) == (0, "")


def test_a_function_that_fails_on_the_way_ends_the_run_in_one_line(command):
    body = (
        "    if float(p.a) > 0.5:\n        raise LookupError('off the table')\n"
        "    return [float(p.a) - x[0], -x[1]]"
    )
    tail = TAIL.replace("'a': 1.0", "'a': -1.0")
    status, said = command(HEAD + body + tail)
    assert status in {1, 2}
    assert "raises LookupError" in said
    assert "off the table" in said


def test_infinite_loops_of_errors_do_not_reach_the_user():
    def rates(x, p):
        return [math.sqrt(x[0]) - p.a]

    model = rb.model_from_function(
        "root", rates, states="x", parameters={"a": 1.0}, guess={"x": 1.0}
    )
    branch = rb.continue_equilibria(model, "a", (-1.0, 2.0))
    assert branch.parameter.max() == 2.0
    assert 0.0 <= branch.parameter.min() < 1e-3
    assert branch.early


def test_two_models_of_one_name_and_different_equations():
    found = []
    for k in (1.0, 2.0, 3.0):

        def rates(x, p, k=k):
            return [p.a - k * x[0]]

        for make in (
            lambda r=rates: rb.model_from_function("one", r, states="x", parameters={"a": 1.0}),
            lambda k=k: rb.model_from_strings("one", {"x": f"a - {k}*x"}, parameters={"a": 1.0}),
        ):
            branch = rb.continue_equilibria(make(), "a", (0.5, 2.0))
            found.append(branch.states[-1, 0] * k / branch.parameter[-1])
    np.testing.assert_allclose(found, 1.0, rtol=1e-12)


def test_two_called_functions_of_one_name_are_told_apart():
    digests = set()
    for k in (1, 2):

        def rates(x, p, k=k):
            return [float(p.a) - k * float(x[0])]

        model = rb.model_from_function("one", rates, states="x", parameters={"a": 1.0})
        branch = rb.continue_equilibria(model, "a", (0.5, 2.0))
        np.testing.assert_allclose(branch.states[:, 0] * k, branch.parameter, rtol=1e-9)
        assert any("differences" in note for note in branch.system.notes)
        digests.add(branch.system.equations)
    assert len(digests) == 2


def test_a_jump_that_the_function_hides_from_nobody():
    def rates(x, p):
        return [p.a - x[0] if x[0] < 1 else p.a - 2 * x[0]]

    model = rb.model_from_function("jump", rates, states="x", parameters={"a": 0.5})
    branch = rb.continue_equilibria(model, "a", (0.0, 3.0))
    assert branch.parameter.max() == pytest.approx(1.0, abs=1e-3)
    assert branch.early
    assert branch.special == ()


def test_functions_through_workers_need_a_home():
    import pickle

    model = rb.model_from_function(
        "far", lambda x, p: [float(x[0]) - p.a], states="x", parameters={"a": 1.0}
    )
    with pytest.raises(ModelError, match="top level of a file"):
        pickle.dumps(rb.continue_equilibria and model.external)
