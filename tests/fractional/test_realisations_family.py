"""Every realisation on laws of every kind: static gain, poles, error, derivative, refusals."""

import numpy as np
import pytest

from racs_bif.errors import ParameterError, UsageError
from racs_bif.fractional.aaa import Aaa
from racs_bif.fractional.charef import Charef
from racs_bif.fractional.continued_fraction import ContinuedFraction
from racs_bif.fractional.diffusive import Diffusive
from racs_bif.fractional.fitted import Fitted
from racs_bif.fractional.laws import Law, PowerSum
from racs_bif.fractional.matsuda import Matsuda
from racs_bif.fractional.modified_oustaloup import ModifiedOustaloup
from racs_bif.fractional.nonnegative import NonNegative
from racs_bif.fractional.realisations import REALISATIONS, choose_realisation
from racs_bif.fractional.vector_fitting import VectorFitting, _made_real, _relocate


def law(numerator, denominator, name, *, feedthrough=True):
    """Return the law of two lists of (coefficient, exponent)."""
    n, d = np.array(numerator, dtype=float).T, np.array(denominator, dtype=float).T
    return Law(PowerSum(*n), PowerSum(*d), name, feedthrough)


LAWS = {
    "vehicle": law([(1.0, 0.0), (1.0, 0.7)], [(1.0, 0.0), (1.0, 0.3)], "vehicle"),
    "springpot": law([(2.0, 0.5)], [(1.0, 0.0)], "springpot"),
    "zener": law([(1.0, 0.0), (5.0, 0.5)], [(1.0, 0.0), (1.0, 0.5)], "zener"),
    "integrating": law([(1.0, 0.0), (2.0, 0.6)], [(1.0, 0.6)], "integrating"),
    "proper": law([(1.0, 0.0)], [(1.0, 0.0), (1.0, 0.6)], "proper", feedthrough=False),
    "integral": law([(1.0, 0.0)], [(1.0, 0.6)], "integral", feedthrough=False),
}
NARROW = (1.0, 60.0)
WIDE = (1e-3, 1e4)
# worst error between 3 and 30 rad/s over the laws that it takes
ALL = {
    "fitted": (Fitted(band=NARROW, omega=9.0), 8e-3),
    "nonnegative": (NonNegative(band=NARROW), 2e-3),
    "vector-fitting": (VectorFitting(band=NARROW, order=8), 1e-4),
    "aaa": (Aaa(band=NARROW, order=8), 8e-3),
    "matsuda": (Matsuda(band=NARROW, sections=7), 1e-3),
    "continued-fraction": (ContinuedFraction(band=NARROW, sections=8), 1e-3),
    "charef": (Charef(band=WIDE, sections=14), 2.5e-2),
    "modified-oustaloup": (ModifiedOustaloup(band=WIDE, sections=14), 2.5e-2),
}
POWERS = ("matsuda", "continued-fraction", "charef", "modified-oustaloup")
JUMPING = ("nonnegative", "vector-fitting", "aaa")
REFUSED = {(name, kind) for name in POWERS for kind in ("proper", "integral")}
REFUSED |= {("nonnegative", "vehicle")}
TAKEN = [(name, kind) for name in ALL for kind in LAWS if (name, kind) not in REFUSED]


def poles(realised, one):
    """Return the poles but for the one at 0 of a law that integrates."""
    found = np.linalg.eigvals(realised.A)
    if one.integrates:
        k = np.argmin(np.abs(found))
        assert abs(found[k]) < 1e-9
        found = np.delete(found, k)
    return found


@pytest.mark.parametrize(("name", "kind"), TAKEN)
def test_static_gain_is_exact(name, kind):
    realised, one = ALL[name][0].realise(LAWS[kind]), LAWS[kind]
    if one.integrates:
        below = np.abs(realised(1j * np.array([1e-7, 1e-8])))
        assert below[1] / below[0] == pytest.approx(10.0, rel=1e-3)  # an integrator
    else:
        scale = np.abs(realised(1j * np.array([60.0])))[0]
        assert realised(0.0)[0] == pytest.approx(one.static_gain, rel=1e-11, abs=1e-12 * scale)


@pytest.mark.parametrize(("name", "kind"), TAKEN)
def test_poles_are_real_and_negative(name, kind):
    found = poles(ALL[name][0].realise(LAWS[kind]), LAWS[kind])
    assert np.all(found.real < 0.0)
    assert np.all(np.abs(found.imag) < 1e-9 * np.abs(found))


@pytest.mark.parametrize(("name", "kind"), TAKEN)
def test_inner_band_error(name, kind):
    settings, bound = ALL[name]
    s = 1j * np.geomspace(3.0, 30.0, 60)
    error = np.abs(settings.realise(LAWS[kind])(s) / LAWS[kind](s) - 1.0).max()
    assert error < bound


@pytest.mark.parametrize(("name", "kind"), [pair for pair in TAKEN if "pro" in pair[1]])
def test_strictly_proper_laws_have_no_feedthrough(name, kind):
    assert ALL[name][0].realise(LAWS[kind]).D == 0.0


def moved(one, direction, h):
    """Return a law moved along a direction."""

    def side(a, b):
        return PowerSum(a.coefficients + h * b.coefficients, a.exponents + h * b.exponents)

    return Law(
        side(one.numerator, direction.numerator),
        side(one.denominator, direction.denominator),
        one.name,
        one.feedthrough,
    )


def some_direction(one):
    """Return a direction in which every coefficient and every order but 0 moves."""

    def side(powers, c, e):
        return PowerSum(c * powers.coefficients, np.where(powers.exponents > 0.0, e, 0.0))

    return Law(side(one.numerator, 0.3, 0.5), side(one.denominator, 0.2, -0.4), one.name)


@pytest.mark.parametrize(("name", "kind"), [pair for pair in TAKEN if pair[0] not in JUMPING])
def test_derivative_against_differences(name, kind):
    settings, one = ALL[name][0], LAWS[kind]
    if name == "matsuda":
        settings = Matsuda(band=NARROW, sections=4)  # poles of many sections carry few digits
    direction, h = some_direction(one), 1e-5
    exact = settings.derivative(one, direction)
    ahead, behind = (settings.realise(moved(one, direction, k)) for k in (h, -h))
    for part in "ABCD":
        difference = (getattr(ahead, part) - getattr(behind, part)) / (2.0 * h)
        scale = np.abs(difference).max() if np.any(difference) else 1.0
        np.testing.assert_allclose(getattr(exact, part), difference, rtol=0, atol=1e-5 * scale)


@pytest.mark.parametrize("name", JUMPING)
def test_derivative_refused_where_it_jumps(name):
    one = LAWS["zener"]
    with pytest.raises(UsageError, match="use --realisation fitted, diffusive, matsuda"):
        ALL[name][0].derivative(one, some_direction(one))


@pytest.mark.parametrize(("name", "kind"), sorted(REFUSED))
def test_refusals_say_what_to_use(name, kind):
    with pytest.raises(ParameterError, match="use --realisation fitted or diffusive") as caught:
        ALL[name][0].realise(LAWS[kind])
    assert kind in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("order", [1.0, 1.4])
@pytest.mark.parametrize("name", POWERS)
def test_orders_beyond_one_refused(name, order):
    one = law([(1.0, order)], [(1.0, 0.0), (1.0, 0.9)], "steep")
    with pytest.raises(ParameterError, match=f"'steep' has {order:g};"):
        ALL[name][0].realise(one)


def test_nonnegative_gains():
    relaxing = NonNegative(band=NARROW).realise(LAWS["zener"])
    assert np.all(relaxing.C <= 0.0)
    creeping = NonNegative(band=NARROW).realise(LAWS["proper"])
    assert np.all(creeping.C >= 0.0)
    assert pytest.approx(1.0 - relaxing.C.sum()) == relaxing.D


def test_nonnegative_keeps_its_number_of_states():
    settings = NonNegative(band=NARROW, order=12)
    for order in (0.1, 0.5, 0.9):
        one = law([(1.0, 0.0), (0.2, order)], [(1.0, 0.0), (1.0, order)], "creep")
        assert len(settings.realise(one).B) == 12


def test_nonnegative_names_the_wrong_rates():
    with pytest.raises(ParameterError, match="wrong sign") as caught:
        NonNegative(band=NARROW).realise(LAWS["vehicle"])
    assert "rad/s" in str(caught.value)
    negative = law([(1.0, 0.0), (-0.1, 0.4)], [(1.0, 0.0), (1.0, 0.5)], "negative")
    with pytest.raises(ParameterError, match="negative coefficient"):
        NonNegative(band=NARROW).realise(negative)


def test_continued_fraction_is_a_pade_approximant():
    # s times the [n-1/n] approximant of s**(a-1): 2n derivatives right at the centre
    settings = ContinuedFraction(band=(0.1, 10.0), sections=3)
    power = settings.power(0.4)
    x = 1.0 + 0.2 * np.exp(2j * np.pi * np.arange(32) / 32.0)
    values = power.constant + (power.gains * power.rates / (x[:, None] + power.rates)).sum(axis=1)
    taylor = np.fft.fft(values / x**0.4 - 1.0) / 32.0 / 0.2 ** np.arange(32)
    assert np.abs(taylor[:6]).max() < 1e-12
    assert np.abs(taylor[6]) > 1e-6


def test_matsuda_meets_its_points():
    settings = Matsuda(band=(0.1, 10.0), sections=3)
    power = settings.power(0.4)
    x = np.append(np.geomspace(0.1, 10.0, 6), 0.0)
    values = power.constant + (power.gains * power.rates / (x[:, None] + power.rates)).sum(axis=1)
    np.testing.assert_allclose(values, x**0.4, atol=1e-12)


def test_matsuda_refuses_more_points_than_digits():
    with pytest.raises(ParameterError, match="lower its order"):
        Matsuda(band=(1.0, 10.0), sections=20).power(0.5)


def test_charef_stays_within_its_decibels():
    # the places follow the straight line of the fractional pole within y decibels, as Charef has it
    settings, order = Charef(band=(1e-3, 1e3), sections=12), 0.5
    y = 10.0 * 0.25 * 6.0 / 12.0
    power = settings.power(order)
    s = 1j * np.geomspace(0.1, 10.0, 200)
    values = power.constant + (power.gains * power.rates / (s[:, None] + power.rates)).sum(axis=1)
    assert np.abs(20.0 * np.log10(np.abs(values / s**order))).max() < y


def test_modified_oustaloup_gain_against_common_code():
    """The common code misses (d/b)**a in the middle of the band."""
    low, high, a, n = 1e-3, 1e3, 0.7, 13
    k = np.arange(n)
    ratio = np.log(high / low) / n
    zeros = low * np.exp(ratio * (k + 0.5 * (1.0 - a)))
    poles_ = low * np.exp(ratio * (k + 0.5 * (1.0 + a)))
    s = np.array([1j])
    gain = (0.9 * low) ** a * np.prod(poles_ / zeros)
    ends = (9.0 * s**2 + 10.0 * high * s) / (9.0 * (1.0 - a) * s**2 + 10.0 * high * s + 9.0 * a)
    common = gain * ends[0] * np.prod((s[0] + zeros) / (s[0] + poles_))
    assert abs(common / s[0] ** a) == pytest.approx(0.9**a, rel=3e-3)
    power = ModifiedOustaloup(band=(low, high), sections=n).power(a)
    mended = power.constant + (power.gains * power.rates / (s[0] + power.rates)).sum()
    assert mended / s[0] ** a == pytest.approx(1.0, rel=3e-3)


def test_vector_fitting_recovers_a_rational_law():
    # (1 + 2 s) / (1 + s): one pole at -1, whatever the start
    one = law([(1.0, 0.0), (2.0, 1.0)], [(1.0, 0.0), (1.0, 1.0)], "rational")
    realised = VectorFitting(band=(0.1, 10.0), order=1).realise(one)
    assert realised.A[0, 0] == pytest.approx(-1.0, rel=1e-8)
    assert pytest.approx(2.0, rel=1e-8) == realised.D


@pytest.mark.parametrize("name", REALISATIONS)
def test_table_builds_every_realisation(name):
    made = choose_realisation(name, (1.0, 60.0))
    assert made.name == name
    assert isinstance(made, REALISATIONS[name])
    assert len(choose_realisation(name, (1.0, 60.0), order=9).realise(LAWS["zener"]).B) >= 9


def test_table_refuses():
    with pytest.raises(UsageError, match="did you mean 'matsuda'"):
        choose_realisation("matsud", (1.0, 60.0))
    settings = Charef(band=WIDE)
    assert choose_realisation(settings, (1.0, 2.0)) is settings
    assert choose_realisation(None, (1.0, 60.0)).name == "diffusive"


@pytest.mark.parametrize("name", ALL)
def test_settings_are_checked(name):
    with pytest.raises(UsageError, match="band"):
        choose_realisation(name, (60.0, 1.0))
    with pytest.raises(UsageError, match=r"too small|too few"):
        choose_realisation(name, (1.0, 60.0), order=-1)


def test_modified_oustaloup_is_the_formula_of_xue():
    """(d H/b)**a (d s**2 + b H s)/(d (1-a) s**2 + b H s + d a L) times Oustaloup's filter."""
    low, high, b, d, n = 0.1, 100.0, 10.0, 9.0, 6
    realised = ModifiedOustaloup(band=(low, high), sections=n).realise(LAWS["springpot"])
    s = 1j * np.geomspace(1e-3, 1e4, 29)
    corner, first = b * high / d, d * low / b
    bend = (s**2 + corner * s) / (0.5 * s**2 + corner * s + 0.5 * low * high)
    u = corner / first
    zeros, poles = (first * u ** ((np.arange(n) + 0.5 + side) / n) for side in (-0.25, 0.25))
    inner = np.prod((s[:, None] + zeros) / (s[:, None] + poles), axis=1)
    np.testing.assert_allclose(realised(s), 2.0 * corner**0.5 * bend * inner, rtol=1e-9)


def test_four_and_a_half_rates_a_decade_unless_told():
    for kind in (NonNegative, VectorFitting):
        assert kind(band=(0.2, 60.0)).order == 11
        assert kind(band=(1.0, 2.0)).order == 4
    assert Fitted(band=(0.1, 60.0)).order == 13
    assert Fitted(band=(0.1, 60.0)).omega == pytest.approx(6.0**0.5)
    assert Fitted(band=(1.0, 2.0)).order == 8
    assert Aaa(band=(1.0, 2.0), order=1).order == 1
    with pytest.raises(UsageError, match="spread inf"):
        Fitted(band=(1.0, 2.0), spread=np.inf)
    assert Aaa(band=(0.1, 1e4)).order == 15


def test_two_sections_a_decade_unless_told():
    assert ModifiedOustaloup(band=(1.0, 1e4)).sections == 8


def test_matsuda_goes_through_its_points_to_rounding():
    """Poles as eigenvalues are not sharp enough: they are polished."""
    settings = Matsuda(band=(1e-2, 1e3), sections=9)
    power, points = settings.power(0.5), np.geomspace(1e-2, 1e3, 18)
    values = power.constant + (power.gains * power.rates / (points[:, None] + power.rates)).sum(1)
    np.testing.assert_allclose(values, points**0.5, rtol=5e-12)


def test_aaa_has_samples_enough_in_a_narrow_band():
    one = law([(1.0, 0.0), (2.0, 1.0)], [(1.0, 0.0), (1.0, 1.0)], "rational")
    realised = Aaa(band=(1.0, 1.05), order=1).realise(one)
    assert realised.A[0, 0] == pytest.approx(-1.0, rel=1e-8)


def test_modified_oustaloup_in_a_very_wide_band():
    """The poles of the correction: their sum is H'/(1 - a), their product L H a/(1 - a)."""
    low, high, a = 1e-6, 1e6, 0.3
    slow, fast = np.sort(ModifiedOustaloup(band=(low, high), sections=9).power(a).rates[:2])
    assert slow + fast == pytest.approx(high / 0.9 / (1.0 - a), rel=1e-14)
    assert slow * fast == pytest.approx(a / (1.0 - a), rel=1e-14)


@pytest.mark.parametrize("unit", [1e-9, 1.0, 1e9])
def test_the_unit_of_a_law_does_not_matter(unit):
    rational = law([(unit, 0.0), (2.0 * unit, 1.0)], [(1.0, 0.0), (1.0, 1.0)], "rational")
    s = 1j * np.geomspace(1.0, 60.0, 30)
    realised = NonNegative(band=NARROW).realise(rational)
    np.testing.assert_allclose(realised(s), rational(s), rtol=0.05)
    vehicle = law([(unit, 0.0), (unit, 0.7)], [(1.0, 0.0), (1.0, 0.3)], "vehicle")
    with pytest.raises(ParameterError, match="wrong sign"):
        NonNegative(band=NARROW).realise(vehicle)


@pytest.mark.parametrize("unit", [1e-12, 1e-3, 1e3, 1e12])
def test_fitted_poles_do_not_depend_on_the_unit_of_the_law(unit):
    scaled = law([(unit, 0.0), (unit, 0.7)], [(1.0, 0.0), (1.0, 0.3)], "vehicle")
    settings = VectorFitting(band=NARROW, order=6)
    found, wanted = settings.realise(scaled), settings.realise(LAWS["vehicle"])
    np.testing.assert_allclose(found.A, wanted.A, rtol=1e-6)


def test_poles_are_moved_until_they_stay():
    one, settings = LAWS["vehicle"], VectorFitting(band=NARROW, order=5)
    rates = np.sort(-np.diag(settings.realise(one).A))
    s = 1j * np.geomspace(1.0, 60.0, 200)
    np.testing.assert_allclose(_relocate(one, rates, s), rates, rtol=1e-7)


def test_zeros_anywhere_become_rates_that_are_apart():
    assert _made_real(np.array([-3.0, -1.0, -1.0])) == pytest.approx([1.0, 1.05, 3.0])
    assert _made_real(np.array([2.0, -1.0])) == pytest.approx([1.0, 2.0])
    angle = 0.1
    pair = -2.0 * np.exp(1j * angle * np.array([1.0, -1.0]))
    assert _made_real(pair) == pytest.approx(2.0 * np.exp([-angle, angle]))
    assert _made_real(-pair) == pytest.approx([2.0, 2.1])


def test_twelve_poles_are_fitted_to_a_few_parts_in_a_million():
    for kind in ("vehicle", "springpot", "zener", "proper"):
        assert VectorFitting(band=NARROW, order=12).error(LAWS[kind]) < 5e-6


def test_nonnegative_names_where_the_spectrum_is_wrong():
    """Im Z(-x) has the sign of x**0.4 sin 0.7 pi + x**0.7 sin 0.4 pi - sin 0.3 pi."""
    with pytest.raises(ParameterError, match=r"at 1e-06 \.\. ") as caught:
        NonNegative(band=NARROW).realise(LAWS["vehicle"])
    x = float(str(caught.value).split(" .. ")[1].split()[0])
    assert x**0.4 + np.sin(0.4 * np.pi) / np.sin(0.7 * np.pi) * x**0.7 == pytest.approx(1, rel=0.03)


@pytest.mark.parametrize("kind", [Matsuda, ContinuedFraction])
def test_three_sections_a_decade_unless_told(kind):
    assert kind(band=(1.0, 100.0)).sections == 6
    assert kind(band=(1.0, 2.0)).sections == 3


@pytest.mark.parametrize("kind", [Diffusive, Fitted])
def test_rates_reach_six_times_beyond_the_band_unless_told(kind):
    assert kind(band=NARROW).rates[[0, -1]] == pytest.approx([1.0 / 6.0, 360.0])
    assert kind(band=NARROW, spread=0.5).rates[[0, -1]] == pytest.approx([2.0, 30.0])


def test_derivative_of_a_law_with_a_whole_power():
    one = law([(1.0, 0.0), (0.5, 1.0)], [(1.0, 0.0), (1.0, 0.5), (0.1, 1.0)], "whole")
    settings, direction, h = Fitted(band=NARROW, omega=9.0), some_direction(one), 1e-5
    exact = settings.derivative(one, direction)
    ahead, behind = (settings.realise(moved(one, direction, k)) for k in (h, -h))
    difference = (ahead.C - behind.C) / (2.0 * h)
    np.testing.assert_allclose(exact.C, difference, rtol=0, atol=1e-5 * np.abs(difference).max())


def test_unstable_zeros_are_mirrored_whatever_their_size():
    assert _made_real(np.array([0.5, -0.1])) == pytest.approx([0.1, 0.5])
    pair = np.array([0.5 + 0.3j, 0.5 - 0.3j])
    assert _made_real(pair) == pytest.approx(0.34**0.5 * np.array([1.0, 1.05]))


def test_two_rates_are_the_fewest():
    assert NonNegative(band=NARROW, order=2).rates == pytest.approx([1.0 / 6.0, 360.0])
    with pytest.raises(UsageError, match="order 1 is too small; use at least 2"):
        NonNegative(band=NARROW, order=1)


def test_nonnegative_looks_at_the_spectrum_beyond_the_band():
    """The vehicle's law of 1/s: its spectrum is wrong at high rates."""
    turned = law([(1.0, 0.0), (1.0, 0.7)], [(1.0, 0.4), (1.0, 0.7)], "turned")
    with pytest.raises(ParameterError, match=r"\.\. 6e\+07 rad/s"):
        NonNegative(band=NARROW).realise(turned)
