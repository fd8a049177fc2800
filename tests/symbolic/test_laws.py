"""Reading transfer laws: the sums of powers must be the law that was written."""

import numpy as np
import pytest
import sympy as sp

from racs_bif.errors import ModelError
from racs_bif.symbolic.laws import read_law
from racs_bif.symbolic.strings import parse

VALUES = {"a": 0.3, "g": 0.7, "te": 1.3, "ts": 0.6, "k": 2.5, "q": 0.45}
LAWS = {
    "(1 + (ts*s)**g)/(1 + (te*s)**a)": (2, 2),
    "s**a": (1, 1),
    "s**(-q)": (1, 1),
    "1/s**q": (1, 1),
    "1/(1 + s**q)": (1, 2),
    "k*s**q*(1 + s**a)/(2 + s**g)": (2, 2),
    "k + s**q": (2, 1),
    "k": (1, 1),
    "s**(a - g)": (1, 1),
    "(1 + ts*s)**2/(1 + te*s)**3": (3, 4),
    "k/(te*s)**a + 1/(1 + s)": None,
    "(ts*s)**g*(te*s)**(-a)": (1, 1),
    "((ts*s)**g)**a": (1, 1),
    "sqrt(s) + s": (2, 1),
    "s**a*s**g/(1 + s**(a + g))": (1, 2),
    "(s**a + k*s**a)/(1 + s)": (1, 2),
    "1/(1 + 1/(1 + s**a))": None,
}


def total(powers, numbers, s):
    c = [complex(e.subs(numbers)) for e in powers.coefficients]
    e = [complex(e.subs(numbers)) for e in powers.exponents]
    return sum(ck * s**ek for ck, ek in zip(c, e, strict=True))


@pytest.mark.parametrize("text", LAWS)
@pytest.mark.parametrize("s", [0.37, 1.9, 2.0j, 0.2 + 1.1j, -0.4 + 0.9j])
def test_the_quotient_is_the_law(text, s):
    law = parse(text)
    numerator, denominator = read_law("w", law)
    numbers = {sp.Symbol(k): v for k, v in VALUES.items()}
    exact = complex(eval(text, {"sqrt": np.sqrt, **VALUES, "s": s}))  # the texts are above
    value = total(numerator, numbers, s) / total(denominator, numbers, s)
    assert value == pytest.approx(exact, rel=1e-13)
    if LAWS[text]:
        assert (len(numerator.exponents), len(denominator.exponents)) == LAWS[text]


def test_symbols_come_back_without_assumptions():
    for part in read_law("w", parse("(1 + (ts*s)**g)/(1 + (te*s)**a)")):
        for expression in (*part.coefficients, *part.exponents):
            for symbol in expression.free_symbols:
                assert symbol == sp.Symbol(symbol.name)
                assert symbol.name != "s"


@pytest.mark.parametrize(
    "text",
    [
        "exp(s)",
        "log(s)",
        "(1 + s)**q",
        "1/(1 + s**a)**g",
        "s**s",
        "sin(s**q)",
        "sqrt(1 + s)",
        "abs(s)",
        "s*sign(s)",
        "1 if s > 1 else 2",
        "max(s, 1)",
        "k**s",
    ],
)
def test_no_quotient_of_powers(text):
    with pytest.raises(ModelError, match=r"law of 'w'.*quotient of sums of powers"):
        read_law("w", parse(text))
