"""The two realisations of this issue: static gain, poles, derivatives, convergence."""

import math
from itertools import pairwise

import numpy as np
import pytest

from racs_bif.errors import ParameterError, RacsBifError, UsageError
from racs_bif.fractional.diffusive import Diffusive
from racs_bif.fractional.laws import Law, PowerSum
from racs_bif.fractional.oustaloup import Oustaloup
from racs_bif.fractional.residues import checked_rates

VISCOELASTIC = "(1 + (ts*s)**g)/(1 + (te*s)**a)"
REALISATIONS = {
    "diffusive": Diffusive(band=(1.0, 60.0)),
    "diffusive, wide": Diffusive(band=(1e-2, 1e3), order=14),
    "oustaloup": Oustaloup(band=(1e-3, 1e3)),
    "oustaloup, many": Oustaloup(band=(1e-4, 1e4), sections=24),
}
# strictly proper, integrating, both, vanishing at rest
OTHERS = {
    "s**(-q)": {"q": 0.9},
    "1/(1 + s**q)": {"q": 0.5},
    "k + 1/s**q": {"q": 0.4, "k": 2.0},
    "k*s**q": {"q": 0.6, "k": 3.0},
    "(1 + s**g)/(s**a + s**g*2)": {"a": 0.3, "g": 0.7},
}


def random_laws(law_of, count):
    """Yield the viscoelastic law at random parameters of one compiled model."""
    _, field, _ = law_of(VISCOELASTIC, ts=1.0, te=1.0, a=0.3, g=0.7)
    rng = np.random.default_rng(1)
    for _ in range(count):
        orders, times = rng.uniform(0.05, 0.95, 2), 10.0 ** rng.uniform(-2.0, 2.0, 2)
        yield field.laws(np.array([*times, *orders]))[0]


@pytest.mark.parametrize("name", REALISATIONS)
def test_static_gain_is_exact_and_poles_are_real_and_stable(law_of, name):
    for law in random_laws(law_of, 40):
        f = REALISATIONS[name].realise(law)
        allowed = 1e-12
        if "oustaloup" in name:
            # Feedthrough and memory of a power cancel at rest: rounding is that of c * HIGH**order.
            high = REALISATIONS[name].band[1]
            sides = (law.numerator, law.denominator)
            allowed += max(1e-14 * (n.coefficients * high**n.exponents).max() for n in sides)
        assert complex(f(0.0)[0]) == pytest.approx(1.0, abs=allowed)
        poles = np.linalg.eigvals(f.A)
        assert (poles.real < 0.0).all()
        np.testing.assert_allclose(poles.imag, 0.0, atol=1e-9 * np.abs(poles).max())


@pytest.mark.parametrize("text", OTHERS)
def test_diffusive_carries_any_law(law_of, text):
    """The error over the middle of the band is small, statics and high frequencies are right."""
    law = law_of(text, **OTHERS[text])[0]
    f = Diffusive(band=(0.1, 100.0), order=16).realise(law)
    s = 1j * np.geomspace(1.0, 10.0, 50)
    assert np.abs(f(s) / law(s) - 1.0).max() < 2e-4
    if law.integrates:
        assert np.isclose(f.A, 0.0).all(axis=1).sum() == 1  # one integrator
        assert abs(f(1e-9j)[0]) > 1e6
    else:
        assert complex(f(0.0)[0]) == pytest.approx(law.static_gain, abs=1e-12)
    if not law.feedthrough:
        assert f.D == 0.0
        assert abs(f(1e9j)[0]) < 1e-6
    poles = np.linalg.eigvals(f.A)
    assert (poles.real <= 0.0).all()
    np.testing.assert_array_equal(poles.imag, 0.0)


def test_a_plain_integrator_is_exact(law_of):
    law = law_of("1/s**q", q=1.0)[0]
    f = Diffusive(band=(0.1, 100.0)).realise(law)
    s = 1j * np.geomspace(1e-3, 1e5, 20)
    np.testing.assert_allclose(f(s), 1.0 / s, rtol=1e-10)


def test_a_plain_gain_is_exact(law_of):
    law = law_of("k", k=-2.5)[0]
    for realisation in REALISATIONS.values():
        f = realisation.realise(law)
        np.testing.assert_allclose(f(1j * np.geomspace(1e-3, 1e3, 9)), -2.5, rtol=1e-12)


@pytest.mark.parametrize(
    ("text", "parameters"),
    [
        (VISCOELASTIC, {"ts": 0.8, "te": 1.3, "a": 0.3, "g": 0.7}),
        ("(n + s**q)/(d + s**q)", {"n": 2.0, "d": 5.0, "q": 0.6}),
    ],
    ids=["viscoelastic", "moving gain"],
)
@pytest.mark.parametrize("name", REALISATIONS)
def test_derivatives(law_of, differences, name, text, parameters):
    """Every matrix of the filter, by every parameter of the law, against differences."""
    realisation = REALISATIONS[name]
    law, field, p = law_of(text, **parameters)
    for k in range(len(p)):
        unit = np.eye(len(p))[k]
        (direction,) = field.law_directions(p, unit)
        slope = realisation.derivative(law, direction)
        for part in ("A", "B", "C", "D"):
            exact = getattr(slope, part)

            def moved(x, part=part, unit=unit):
                return getattr(realisation.realise(field.laws(p + x * unit)[0]), part)

            difference = differences(moved, 0.0, 1e-3)
            scale = max(np.abs(difference).max(), np.abs(moved(0.0)).max(), 1e-3)
            np.testing.assert_allclose(exact, difference, rtol=0.0, atol=2e-8 * scale)


@pytest.mark.parametrize("text", OTHERS)
def test_derivatives_of_other_laws(law_of, differences, text):
    realisation = Diffusive(band=(0.1, 100.0))
    law, field, p = law_of(text, **OTHERS[text])
    for unit in np.eye(len(p)):
        (direction,) = field.law_directions(p, unit)
        slope = realisation.derivative(law, direction)

        def moved(x, unit=unit):
            f = realisation.realise(field.laws(p + x * unit)[0])
            return np.append(f.C, f.D)

        difference = differences(moved, 0.0, 1e-3)
        scale = max(np.abs(difference).max(), np.abs(moved(0.0)).max())
        np.testing.assert_allclose(
            np.append(slope.C, slope.D), difference, rtol=0.0, atol=2e-8 * scale
        )
        assert not slope.A.any()
        assert not slope.B.any()


def middle_error(realisation, law):
    s = 1j * np.geomspace(5.0, 60.0, 200)
    return np.abs(realisation.realise(law)(s) / law(s) - 1.0).max()


def test_diffusive_converges_with_its_order(law_of):
    law = law_of(VISCOELASTIC, ts=1.0, te=1.0, a=0.3, g=0.7)[0]
    errors = [middle_error(Diffusive(band=(1.0, 100.0), order=n), law) for n in (4, 6, 8, 10, 12)]
    ratios = np.array(errors[:-1]) / errors[1:]
    assert (ratios > 2.0).all()  # geometrically
    assert errors[2] < 1e-3  # what its documentation says of order 8
    assert errors[-1] < 1e-4


def test_oustaloup_converges_with_its_band_not_with_its_sections(law_of):
    law = law_of(VISCOELASTIC, ts=1.0, te=1.0, a=0.3, g=0.7)[0]
    fixed = [
        middle_error(Oustaloup(band=(1e-2, 1e3), sections=n), law) for n in (12, 24, 48)
    ]  # fmt: skip
    assert fixed[2] > 0.5 * fixed[1] > 0.2 * fixed[0]
    wide = [
        middle_error(Oustaloup(band=(10.0**-k, 10.0 ** (k + 1)), sections=5 * k), law)
        for k in (2, 3, 4, 5)
    ]
    assert all(a > 2.0 * b for a, b in pairwise(wide))
    assert wide[-1] < 2e-3


def test_error_is_the_largest_over_the_band(law_of):
    law = law_of(VISCOELASTIC, ts=1.0, te=1.0, a=0.3, g=0.7)[0]
    realisation = Diffusive(band=(1.0, 60.0))
    s = 1j * np.geomspace(1.0, 60.0, 3000)
    largest = np.abs(realisation.realise(law)(s) / law(s) - 1.0).max()
    assert realisation.error(law) == pytest.approx(largest, rel=1e-3)


@pytest.mark.parametrize("kind", [Diffusive, Oustaloup])
@pytest.mark.parametrize(
    "band", [(0.0, 1.0), (-1.0, 1.0), (1.0, 1.0), (2.0, 1.0), (1.0, math.inf), (math.nan, 1.0)]
)
def test_bands_are_checked(kind, band):
    with pytest.raises(UsageError, match=r"band .* rad/s is not usable; give 0 < LOW < HIGH"):
        kind(band=band)


def test_settings_are_checked():
    with pytest.raises(UsageError, match="order 1 is too small"):
        Diffusive(band=(1.0, 10.0), order=1)
    with pytest.raises(UsageError, match="order -3 is too small"):
        Diffusive(band=(1.0, 10.0), order=-3)
    for spread in (0.0, -1.0, math.inf, math.nan):
        with pytest.raises(UsageError, match="spread"):
            Diffusive(band=(1.0, 10.0), spread=spread)
    with pytest.raises(UsageError, match="-1 sections are too few"):
        Oustaloup(band=(1.0, 10.0), sections=-1)
    with pytest.raises(TypeError):
        Diffusive((1.0, 10.0))
    with pytest.raises(AttributeError):
        Diffusive(band=(1.0, 10.0)).order = 3


def test_default_orders_follow_the_band():
    assert Diffusive(band=(1.0, 1e4)).order == 20
    assert Diffusive(band=(1.0, 2.0)).order == 4
    assert Oustaloup(band=(1.0, 1e4)).sections == 8
    assert Oustaloup(band=(1.0, 2.0)).sections == 3
    assert Oustaloup(band=(1.0, 2.0), sections=1).sections == 1


def test_oustaloup_refuses_what_it_cannot_realise(law_of):
    realisation = Oustaloup(band=(1e-3, 1e3))
    with pytest.raises(RacsBifError, match=r"'Z'.*use --realisation fitted or diffusive"):
        realisation.realise(law_of("1/(1 + s**q)", q=0.5)[0])
    with pytest.raises(ParameterError, match=r"orders between 0 and 1, 'Z' has 1\.5"):
        realisation.realise(law_of("(1 + s**q)/(1 + s**a)", q=1.5, a=0.6)[0])
    sides = (PowerSum(np.ones(1), np.array([order])) for order in (-0.5, 0.0))
    with pytest.raises(ParameterError, match=r"orders between 0 and 1, 'Z' has -0\.5"):
        realisation.realise(Law(*sides))


@pytest.mark.parametrize("name", REALISATIONS)
def test_filters_are_smooth_in_the_orders(law_of, name):
    """No order jumps, also where both orders meet."""
    _, field, p = law_of(VISCOELASTIC, ts=1.0, te=1.0, a=0.5, g=0.6)
    responses = []
    for g in 0.5 + 1e-6 * np.arange(-3, 4):
        law = field.laws(np.array([*p[:3], g]))[0]
        responses.append(REALISATIONS[name].realise(law)(np.array([3.0j]))[0])
    steps = np.abs(np.diff(responses))
    assert steps.max() < 1e-5
    assert steps.max() < 1.001 * steps.min()


def test_five_rates_a_decade_unless_told():
    assert Diffusive(band=(0.1, 60.0)).order == 14
    assert Diffusive(band=(1.0, 2.0), order=2).order == 2
    assert Diffusive(band=(1.0, 2.0)).order == 4


def test_poles_that_coincide_are_refused():
    np.testing.assert_array_equal(checked_rates(np.array([-1.5, -1.0]), "m", "Z"), [1.0, 1.5])
    for poles in (
        [-1.0, 0.0],
        [-1.0, -2.0, -2.0],
        [-1.0, 2.0],
        [-1.0, -2.0 + 1j, -2.0 - 1j],
        [-1.0, np.nan],
    ):
        with pytest.raises(ParameterError, match="m finds a pole of 'Z'"):
            checked_rates(np.array(poles), "m", "Z")
    with pytest.raises(ParameterError, match=r"a pole of 'Z' at -2 rad/s"):
        checked_rates(np.array([-1.0, -2.0, -3.0, -2.0]), "m", "Z")


def test_a_narrow_band_has_samples_enough(law_of):
    law = law_of(VISCOELASTIC, ts=1.0, te=1.0, a=0.3, g=0.7)[0]
    assert Diffusive(band=(1.0, 1.1), order=3).error(law) < 5e-3
    assert Diffusive(band=(1.0, 1.1), order=8).error(law) < 1e-6
