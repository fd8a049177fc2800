"""Transfer laws in numbers: values, slopes, derivatives by parameters."""

import cmath

import mpmath
import numpy as np
import pytest

from racs_bif.errors import ParameterError

# text of the law -> the same as a function of s and parameters, on the principal branch
LAWS = {
    "(1 + (ts*s)**g)/(1 + (te*s)**a)": (
        {"ts": 0.6, "te": 1.3, "a": 0.3, "g": 0.7},
        lambda s, ts, te, a, g: (1 + ts**g * s**g) / (1 + te**a * s**a),
    ),
    "k*s**q*(1 + s**a)/(2 + s**g)": (
        {"k": 2.5, "q": 0.2, "a": 0.35, "g": 0.9},
        lambda s, k, q, a, g: k * s**q * (1 + s**a) / (2 + s**g),
    ),
    "s**(-q)": ({"q": 0.9}, lambda s, q: s**-q),
    "s**(a - g)": ({"a": 0.3, "g": 0.7}, lambda s, a, g: s ** (a - g)),
    "s**(g - a)": ({"a": 0.3, "g": 0.7}, lambda s, a, g: s ** (g - a)),
    "1/(1 + s**q)": ({"q": 0.5}, lambda s, q: 1 / (1 + s**q)),
    "k/s**q + 1": ({"k": 3.0, "q": 0.4}, lambda s, k, q: k * s**-q + 1),
    "k": ({"k": 3.0}, lambda s, k: k + 0 * s),
    "(1 + s)**2/(k + s)**3": ({"k": 3.0}, lambda s, k: (1 + s) ** 2 / (k + s) ** 3),
}
POINTS = [0.5, 3.0, 2.0j, -2.0j, 0.3 + 40.0j, -0.5 + 1.5j, 1e-3j, 1e4j]


@pytest.mark.parametrize("text", LAWS)
def test_value(law_of, text):
    parameters, formula = LAWS[text]
    law = law_of(text, **parameters)[0]
    for s in POINTS:
        exact = formula(complex(s), **parameters)
        assert complex(law(s)) == pytest.approx(exact, rel=1e-13)
    np.testing.assert_allclose(
        law(np.array(POINTS)), [formula(complex(s), **parameters) for s in POINTS], rtol=1e-13
    )


@pytest.mark.parametrize("text", LAWS)
def test_slope_by_s(law_of, text):
    """dZ/ds from the slopes of numerator and denominator against mpmath."""
    parameters, formula = LAWS[text]
    law = law_of(text, **parameters)[0]
    for s in POINTS:
        n, d = law.numerator, law.denominator
        slope = complex((n.slope(s) - law(s) * d.slope(s)) / d(s))
        with mpmath.workdps(40):
            exact = complex(mpmath.diff(lambda z: formula(z, **parameters), mpmath.mpc(s)))
        assert slope == pytest.approx(exact, rel=1e-11, abs=1e-12 * abs(law(s) / s))


@pytest.mark.parametrize("text", LAWS)
def test_derivative_by_parameters(law_of, text):
    parameters, formula = LAWS[text]
    law, field, p = law_of(text, **parameters)
    for k, name in enumerate(parameters):
        (direction,) = field.law_directions(p, np.eye(len(p))[k])
        for s in POINTS:
            slope = complex(law.along(direction, s))
            with mpmath.workdps(40):
                exact = complex(
                    mpmath.diff(
                        lambda x, s=s, name=name: formula(mpmath.mpc(s), **parameters | {name: x}),
                        parameters[name],
                    )
                )
            assert slope == pytest.approx(exact, rel=1e-11, abs=1e-12 * abs(law(s)))


def test_directions_add_up(law_of):
    text = "(1 + (ts*s)**g)/(1 + (te*s)**a)"
    law, field, p = law_of(text, **LAWS[text][0])
    weights = np.array([0.3, -1.0, 0.7, 2.0])
    (whole,) = field.law_directions(p, weights)
    parts = [
        complex(law.along(field.law_directions(p, dp)[0], 3.0j)) for dp in np.eye(4)
    ]  # fmt: skip
    assert complex(law.along(whole, 3.0j)) == pytest.approx(np.dot(weights, parts), rel=1e-13)


def test_what_does_not_move_a_law_has_no_direction(system_of):
    system = system_of({"x": "k*w"}, elements=[("w", "x", "s**q")], parameters={"k": 1.0, "q": 0.5})
    assert system.field.law_directions(system.values, np.array([1.0, 0.0])) is None
    assert system.field.law_directions(system.values, np.array([0.0, 1.0])) is not None


@pytest.mark.parametrize(
    ("text", "parameters", "gain"),
    [
        ("(2 + s**g)/(5 + s**a)", {"a": 0.3, "g": 0.7}, 0.4),
        ("(k + s**g)/(1 + s**a)", {"a": 0.3, "g": 0.7, "k": -3.0}, -3.0),
        ("s**q", {"q": 0.5}, 0.0),
        ("1/(4 + s**q)", {"q": 0.5}, 0.25),
        ("s**(-q)", {"q": 0.5}, np.inf),
        ("k + 1/s**q", {"q": 0.5, "k": 2.0}, np.inf),
        ("s**a/(s**a + s**g)", {"a": 0.3, "g": 0.7}, 1.0),
    ],
)
def test_static_gain(law_of, text, parameters, gain):
    law = law_of(text, **parameters)[0]
    assert law.static_gain == pytest.approx(gain, rel=1e-15)
    assert law.integrates == np.isinf(gain)
    if not law.integrates:
        assert complex(law(0.0)) == pytest.approx(gain, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "parameters", "feedthrough"),
    [
        ("(1 + s**g)/(1 + s**a)", {"a": 0.3, "g": 0.7}, True),
        ("(1 + s**a)/(2 + s**a)", {"a": 0.3}, True),
        ("(1 + s**a)/(1 + s**g)", {"a": 0.3, "g": 0.7}, False),
        ("s**(-q)", {"q": 0.5}, False),
        ("1 + s**(-q)", {"q": 0.5}, True),
        ("k", {"k": 2.0}, True),
    ],
)
def test_feedthrough(law_of, text, parameters, feedthrough):
    assert law_of(text, **parameters)[0].feedthrough is feedthrough


def test_whole_orders_are_recognised(law_of):
    assert law_of("(1 + s**n)/(2 + s)", n=1.0)[0].integer
    assert not law_of("(1 + s**n)/(2 + s)", n=0.9)[0].integer


def test_growth_beyond_a_derivative_is_refused(law_of):
    law_of("s**q", q=1.0)
    with pytest.raises(ParameterError, match=r"law of 'Z' grows like s\*\*1.2.*lower its order"):
        law_of("s**q", q=1.2)
    with pytest.raises(ParameterError, match=r"law of 'Z' grows like s\*\*1.5"):
        law_of("(1 + s**q)/(1 + s**a)", q=1.8, a=0.3)


def test_a_law_that_stops_vanishing_is_refused(law_of):
    """Feedthrough belongs to the compiled model: an order may not take it away or bring it."""
    _, field, p = law_of("(1 + s**a)/(1 + s**g)", a=0.3, g=0.7)
    with pytest.raises(ParameterError, match="no longer vanishes at high frequency"):
        field.laws(np.array([0.8, 0.7]))
    assert len(field.laws(p)) == 1


def test_laws_that_are_not_finite_are_refused(law_of):
    _, field, _ = law_of("1/(1 + (t*s)**a)", t=1.0, a=0.3)
    for bad in ([-1.0, 0.3], [np.nan, 0.3], [1.0, np.inf]):
        with pytest.raises(ParameterError, match="law of 'Z' is not finite"):
            field.laws(np.array(bad))


def test_principal_branch(law_of):
    """The cut lies on the negative real axis; a real law is conjugate to itself."""
    law = law_of("s**q", q=0.5)[0]
    assert complex(law(-4.0 + 0.0j)) == pytest.approx(2.0j, abs=1e-15)
    assert complex(law(complex(-4.0, -0.0))) == pytest.approx(-2.0j, abs=1e-15)
    assert complex(law(-1.0 + 1e-9j)) == pytest.approx(cmath.sqrt(-1.0 + 1e-9j), rel=1e-15)
    for s in POINTS:
        assert complex(law(np.conj(s))) == np.conj(complex(law(s)))


def test_orders_beyond_two_are_refused(law_of):
    with pytest.raises(ParameterError, match=r"has the order 2\.5; fractional orders lie between"):
        law_of("(1 + s**q)/(1 + s**a)", q=2.5, a=2.0)
