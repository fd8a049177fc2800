import math

import mpmath
import numpy as np
import pytest
import sympy as sp

from racs_bif.errors import ModelError, ParameterError, UsageError
from racs_bif.fractional.compare import is_passive
from racs_bif.fractional.creep import creep, relaxation
from racs_bif.fractional.filter import Filter
from racs_bif.fractional.law_numbers import law_in_numbers
from racs_bif.fractional.laws import Law, PowerSum
from racs_bif.fractional.moduli import moduli
from racs_bif.fractional.passivity import _text, passivity
from racs_bif.fractional.real_powers import positive_zeros
from racs_bif.shelf.load import load_model
from racs_bif.symbolic import named_laws as named

PAPER = {"E_0": 1.0, "tau_sig": 1.0, "tau_eps": 1.0, "alpha": 0.3, "gamma": 0.7}
NAMED = {
    "springpot": named.springpot(2.0, 0.4),
    "kelvin_voigt": named.kelvin_voigt(2.0, 0.7, 0.6),
    "maxwell": named.maxwell(2.0, 0.7, 0.6),
    "zener": named.zener(2.0, 3.0, 0.5, 0.4),
    "1a": named.law_1a(2.0, 0.7, 0.3, 0.6),
    "1b": named.law_1b(2.0, 0.7, 0.3, 0.6),
    "2a": named.law_2a(2.0, 3.0, 0.5, 0.3, 0.6),
    "2b": named.law_2b(2.0, 3.0, 0.5, 0.3, 0.6),
}


def test_2a_is_not_passive_at_the_papers_values():
    law = law_in_numbers(named.law_2a(*PAPER), PAPER)
    found = passivity(law)
    ((low, edge),) = found.active
    assert low == 0.0
    assert edge == pytest.approx(0.0921, abs=5e-5)
    assert abs(law(1j * edge).imag) < 1e-14
    assert law(1j * edge * (1.0 - 1e-10)).imag < 0.0 < law(1j * edge * (1.0 + 1e-10)).imag
    assert not found.passive
    assert "< 0.09212 rad/s" in str(found)
    assert found.negative_stiffness == ()


def test_the_vehicle_carries_the_same_law():
    system = load_model("racs")
    (law,) = system.exact.laws(system.values)
    assert passivity(law).active[0][1] == pytest.approx(0.0921, abs=5e-5)


@pytest.mark.parametrize("name", ["springpot", "kelvin_voigt", "maxwell", "zener", "2b"])
def test_passive_laws(name):
    found = passivity(law_in_numbers(NAMED[name]))
    assert found.passive
    assert str(found) == "passive"


def test_zener_with_exchanged_times_is_active_everywhere():
    found = passivity(law_in_numbers(named.zener(1.0, 0.5, 3.0, 0.4)))
    assert found.active == ((0.0, math.inf),)
    assert "at all frequencies" in str(found)


def test_bands_agree_with_a_scan():
    rng = np.random.default_rng(2)
    omega = np.geomspace(1e-6, 1e6, 4001)
    edges = 0
    for _ in range(40):
        a, b, c = np.sort(rng.uniform(0.0, 1.0, 3))
        values = rng.normal(size=5)
        expression = (
            f"({values[0]} + {values[1]}*s**{c})/({values[2]} + s**{a} + {values[3]}*s**{b})"
        )
        law = law_in_numbers(sp.sympify(expression))
        found = passivity(law)
        for bands, part in (
            (found.active, law(1j * omega).imag),
            (found.negative_stiffness, law(1j * omega).real),
        ):
            inside = np.zeros(len(omega), dtype=bool)
            for low, high in bands:
                inside |= (low < omega) & (omega < high)
                edges += (low > 0.0) + (high < math.inf)
            assert np.array_equal(inside, part < 0.0)
    assert edges > 20


def test_every_zero_of_a_sum_of_powers_is_found():
    places = np.array([0.2, 0.21, 1.0, 7.0, 300.0])
    polynomial = np.poly(places)
    found = positive_zeros(polynomial[::-1], np.arange(6.0))
    assert np.exp(found) == pytest.approx(places, rel=1e-9)
    assert len(positive_zeros(np.array([1.0, -2.0, 1.0]), np.array([0.0, 1.0, 2.0]))) == 0
    assert positive_zeros(np.array([-3.0, 1.0]), np.array([0.0, 0.5])) == pytest.approx(
        [2.0 * math.log(3.0)]
    )


@pytest.mark.parametrize("name", NAMED)
def test_relaxation_and_creep_against_an_inverse_laplace_transform(name):
    law = law_in_numbers(NAMED[name])

    def transfer(s):
        above = zip(law.numerator.coefficients, law.numerator.exponents, strict=True)
        below = zip(law.denominator.coefficients, law.denominator.exponents, strict=True)
        return sum(c * s**e for c, e in above) / sum(c * s**e for c, e in below)

    times = np.array([0.05, 1.3, 40.0])
    stress = [
        float(mpmath.invertlaplace(lambda s: transfer(s) / s, t, method="talbot")) for t in times
    ]
    assert relaxation(law, times) == pytest.approx(stress, rel=1e-11)
    if name == "2b":
        with pytest.raises(UsageError, match="no closed form"):
            creep(law, times)
        return
    strain = [
        float(mpmath.invertlaplace(lambda s: 1 / (s * transfer(s)), t, method="talbot"))
        for t in times
    ]
    assert creep(law, times) == pytest.approx(strain, rel=1e-11)


def test_moduli_of_a_springpot():
    found = moduli(law_in_numbers(named.springpot(2.0, 0.4)), [0.5, 3.0])
    size = 2.0 * np.array([0.5, 3.0]) ** 0.4
    assert found.storage == pytest.approx(size * math.cos(0.2 * math.pi))
    assert found.loss == pytest.approx(size * math.sin(0.2 * math.pi))
    assert found.loss_factor == pytest.approx(math.tan(0.2 * math.pi))


def test_names_that_sympy_knows_are_parameters_here():
    law = law_in_numbers(named.maxwell("E", "I", "gamma"), {"E": 3.0, "I": 2.0, "gamma": 0.5})
    assert law(2.0).real == pytest.approx(3.0 * 2.0 / 3.0)


def test_limits_of_named_laws():
    s = np.array([1e-12, 1e12])
    a = law_in_numbers(named.law_2a(*PAPER), PAPER)
    assert a.static_gain == 1.0
    assert law_in_numbers(NAMED["zener"])(s).real == pytest.approx([2.0, 2.0 * 6.0**0.4], rel=1e-3)
    assert law_in_numbers(NAMED["maxwell"])(s).real == pytest.approx([0.0, 2.0], abs=1e-5)
    one = law_in_numbers(named.law_1b(2.0, 0.7, 0.3, 0.6))(s)
    assert one == pytest.approx(
        law_in_numbers(named.law_1a(2.0, 0.7, 0.3, 0.6))(s)
        + law_in_numbers(named.maxwell(2.0, 0.7, 0.3))(s)
    )


def test_what_is_refused():
    law = law_in_numbers(NAMED["zener"])
    with pytest.raises(UsageError, match="times above zero"):
        creep(law, [0.0, 1.0])
    with pytest.raises(UsageError, match="above zero"):
        moduli(law, [-1.0])
    with pytest.raises(ParameterError, match="needs a value of 'alpha'"):
        law_in_numbers(named.springpot(1.0, "alpha"))
    with pytest.raises(ParameterError, match="did you mean 'alpha'"):
        law_in_numbers(named.springpot(1.0, "alpha"), {"alpha": 0.5, "alhpa": 0.5})

    with pytest.raises(ModelError):
        law_in_numbers(sp.exp(sp.Symbol("s")))


def test_times_of_laws_are_positive():
    tau, alpha, s = sp.symbols("tau alpha s")
    law = 1 + tau**alpha * s**alpha
    assert law_in_numbers(law, {"tau": 4.0, "alpha": 0.5})(np.array([4.0])) == pytest.approx(5.0)
    with pytest.raises(ParameterError, match="is not real at these parameters; keep its times"):
        law_in_numbers(law, {"tau": -4.0, "alpha": 0.5})


def test_bands_in_words():
    s = sp.Symbol("s")
    # At i w its real part is (2 - w**2)/(1 + w**2).
    (band,) = passivity(law_in_numbers((s**2 + 2) / (s + 1))).negative_stiffness
    assert _text(band) == "> 1.414 rad/s"
    assert _text((0.0, 2.0)) == "< 2 rad/s"
    assert _text((1.0, 2.0)) == "in 1 .. 2 rad/s"
    assert _text((0.0, np.inf)) == "at all frequencies"


def test_bands_between_many_edges():
    """Im Z / omega = (1 - w)(100 - w)(w - 900) with w = omega**2, by odd powers of s."""
    numbers = -np.poly([1.0, 100.0, 900.0])[::-1] * np.array([1.0, -1.0, 1.0, -1.0])
    law = Law(PowerSum(numbers, np.array([1.0, 3.0, 5.0, 7.0])), PowerSum(np.ones(1), np.zeros(1)))
    omega = np.array([0.5, 5.0, 20.0, 50.0])
    assert (law(1j * omega).imag > 0.0).tolist() == [True, False, True, False]
    (first, second) = passivity(law).active
    assert first == pytest.approx((1.0, 10.0), rel=1e-9)
    assert second[0] == pytest.approx(30.0, rel=1e-9)
    assert second[1] == math.inf


def test_a_constant_in_disguise_is_passive():
    """3 (1 + s**q)/(1 + s**q): what cancels in Im Z is zero, not negative."""
    side = np.array([0.0, 0.4])
    law = Law(PowerSum(np.array([3.0, 3.0]), side), PowerSum(np.ones(2), side))
    assert passivity(law).active == passivity(law).negative_stiffness == ()


def test_relaxation_of_orders_up_to_two():
    s, t = sp.Symbol("s"), np.array([0.3, 1.0, 4.0])
    assert relaxation(law_in_numbers(1 / (1 + s**2)), t) == pytest.approx(1.0 - np.cos(t))
    with pytest.raises(UsageError, match="the order 3 is over 2"):
        relaxation(law_in_numbers(1 / (1 + s**3)), t)


@pytest.mark.parametrize(
    ("gains", "passive"),
    [
        ([1.0, -7.0], False),  # Im Z < 0 below 0.66 rad/s, less than the slowest rate
        ([-1.8, 0.9, -1.4], False),  # about 10 rad/s only
        ([-0.5, 0.3, -2.8], True),
    ],
)
def test_filters_are_passive_by_their_response_at_all_frequencies(gains, passive):
    rates = np.array([1.0, 10.0, 100.0])[: len(gains)]
    omega = np.geomspace(1e-4, 1e6, 500)[:, None]
    loss = (-np.array(gains) * rates / (omega**2 + rates**2)).sum(axis=1)  # Im Z / omega
    assert np.all(loss > 0.0) == passive
    assert is_passive(Filter(np.diag(-rates), rates, np.array(gains), 0.0)) == passive
