"""Active parameters, base and derived."""

import math

import numpy as np
import pytest
import sympy as sp

from racs_bif.errors import ParameterError, UsageError
from racs_bif.symbolic.compiled import compile_model
from racs_bif.symbolic.compiled_path import CompiledPath, assign, check_values
from racs_bif.symbolic.model import DerivedParameter, Model, Parameter
from racs_bif.symbolic.paths import BasePath

x, a, b, c, d, e = sp.symbols("x a b c d e")
POSITIVE = (0.0, math.inf)


@pytest.fixture(scope="module")
def core():
    """k = a b c sets b; r = b + d, which holds what k sets, sets d; g = e/c sets e."""
    parameters = [Parameter(n, 1.0, "m", valid=POSITIVE) for n in "abc"]
    parameters += [Parameter("d", 1.0, valid=(-1.0, 1.0))]
    parameters += [Parameter("e", 1.0, valid=(-math.inf, 9.0))]
    derived = (
        DerivedParameter("k", a * b * c, sets="b", unit="N", valid=POSITIVE),
        DerivedParameter("r", b + d, sets="d"),
        DerivedParameter("g", e / c, sets="e"),
    )
    return compile_model(Model("derived", {"x": -x}, tuple(parameters), derived=derived))


VALUES = np.array([2.0, 3.0, 5.0, 0.5, 7.0])
PATHS = [
    (("a",), [1.7]),
    (("k",), [44.0]),
    (("k", "c"), [44.0, 1.3]),
    (("c", "k"), [1.3, 44.0]),
    (("k", "r"), [44.0, 6.0]),
    (("r", "k"), [6.0, 44.0]),
    (("g", "k"), [0.3, 12.0]),
    (("g", "c"), [0.3, 4.0]),
]


@pytest.mark.parametrize(("names", "active"), PATHS)
def test_path_reaches_what_it_is_asked_for(core, names, active):
    path = CompiledPath(core, names, VALUES)
    p = path.vector(active)
    table = dict(zip("abcde", p, strict=True))
    table |= dict(zip(("k", "r", "g"), core.derived_values(p), strict=True))
    for name, value in zip(names, active, strict=True):
        assert table[name] == pytest.approx(value, rel=1e-14)
    targets = {"k": "b", "r": "d", "g": "e"}
    moved = {targets.get(name, name) for name in names}
    for name, value in zip("abcde", VALUES, strict=True):
        if name not in moved:
            assert table[name] == value


@pytest.mark.parametrize(("names", "active"), PATHS)
def test_direction_is_the_derivative_of_the_path(core, names, active):
    path = CompiledPath(core, names, VALUES)
    for k in range(len(names)):
        step = 1e-6 * np.eye(len(names))[k]
        difference = (path.vector(active + step) - path.vector(active - step)) / 2e-6
        np.testing.assert_allclose(path.direction(active, k), difference, rtol=1e-8, atol=1e-8)


def test_one_active_parameter_may_be_a_number(core):
    path = CompiledPath(core, ("k",), VALUES)
    np.testing.assert_array_equal(path.vector(44.0), path.vector([44.0]))
    np.testing.assert_array_equal(path.direction(44.0), [0, 1 / 10, 0, 0, 0])


def test_a_path_does_not_touch_the_values_it_was_given(core):
    before = VALUES.copy()
    CompiledPath(core, ("k",), VALUES).vector(1.0)
    np.testing.assert_array_equal(VALUES, before)


def test_two_names_for_one_parameter(core):
    with pytest.raises(UsageError, match="k and b move the same parameter"):
        CompiledPath(core, ("k", "b"), VALUES)
    with pytest.raises(UsageError, match="a and a move the same parameter"):
        CompiledPath(core, ("a", "a"), VALUES)


def test_unknown_names(core):
    with pytest.raises(ParameterError, match=r"unknown parameter 'q'; there are: a, b, c, d, e, k"):
        CompiledPath(core, ("q",), VALUES)
    with pytest.raises(ParameterError, match="unknown parameter 'q'"):
        assign(core, VALUES, {"q": 1.0})


def test_parameters_that_need_each_other():
    """m = a + b sets a, n = a - b sets b: neither can be set while the other moves."""
    derived = (
        DerivedParameter("m", a + 2 * b, sets="a"),
        DerivedParameter("n", b + 2 * a, sets="b"),
    )
    parameters = (Parameter("a", 1.0), Parameter("b", 1.0))
    core = compile_model(Model("tied", {"x": -x}, parameters, derived=derived))
    np.testing.assert_array_equal(assign(core, np.ones(2), {"m": 5.0}), [3.0, 1.0])
    with pytest.raises(ParameterError, match="m and n cannot be set together"):
        assign(core, np.ones(2), {"m": 5.0, "n": 1.0})


@pytest.mark.parametrize(
    ("wanted", "words"),
    [
        ({"q": 1.0}, "unknown parameter 'q'"),
        ({"a": math.nan}, "'a' is nan; give a finite number"),
        ({"a": math.inf}, "'a' is inf; give a finite number"),
        ({"a": -1.0}, r"'a' = -1 m is outside the model's validity; choose it above 0"),
        ({"a": 0.0}, "choose it above 0"),
        ({"d": 2.0}, r"'d' = 2 is outside .* choose it between -1 and 1"),
        ({"e": 9.0}, "choose it below 9"),
        ({"k": -3.0}, r"'k' = -3 N is outside"),
        ({"k": 1.0, "b": 1.0}, "'k' sets 'b': give one of the two"),
    ],
)
def test_values_are_checked(core, wanted, words):
    with pytest.raises(ParameterError, match=words):
        check_values(core, wanted)


def test_good_values_pass(core):
    check_values(core, {"a": 1.0, "k": 2.0, "d": 0.5, "e": -100.0})


def test_base_path():
    path = BasePath(("u", "v"), (2, 0), np.array([1.0, 2.0, 3.0]))
    np.testing.assert_array_equal(path.vector([7.0, 8.0]), [8.0, 2.0, 7.0])
    np.testing.assert_array_equal(path.direction([7.0, 8.0], 0), [0.0, 0.0, 1.0])
    np.testing.assert_array_equal(path.direction([7.0, 8.0], 1), [1.0, 0.0, 0.0])
    single = BasePath(("u",), (1,), np.array([1.0, 2.0]))
    np.testing.assert_array_equal(single.vector(5.0), [1.0, 5.0])
