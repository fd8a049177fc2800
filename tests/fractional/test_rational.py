"""Laws of realisations as quotients of polynomials."""

import numpy as np
import pytest

from racs_bif.fractional.diffusive import Diffusive
from racs_bif.fractional.rational import RationalSystem, rational


@pytest.mark.parametrize(
    ("text", "parameters"),
    [("k + 1/s**q", {"q": 0.4, "k": 2.0}), ("1/(1 + s**q)", {"q": 0.5}), ("2/s", {})],
)
def test_a_filter_of_any_kind_as_a_quotient(law_of, text, parameters):
    law = law_of(text, **parameters)[0]
    done = Diffusive(band=(0.1, 10.0), order=5).realise(law)
    made = rational(law, done)
    s = 1j * np.geomspace(1e-3, 1e3, 30)
    np.testing.assert_allclose(made(s), done(s), rtol=1e-8)
    assert made.integer
    assert made.integrates == law.integrates
    assert made.name == law.name


def test_derivatives_of_the_quotient(system_of, differences):
    realisation = Diffusive(band=(0.1, 10.0), order=5)
    elements, parameters = [("Z", "0", "k + 1/s**q")], {"q": 0.4, "k": 2.0}
    system = system_of({}, elements=elements, parameters=parameters, realisation=realisation)
    field, p = RationalSystem.of(system).exact.field, system.values
    s = np.array([0.4 + 1.3j, 3.0j])
    for dp in np.eye(2):
        moved = field.law_directions(p, dp)[0]
        slope = field.laws(p)[0].along(moved, s)
        expected = differences(lambda h, dp=dp: field.laws(p + h * dp)[0](s), 0.0, 1e-4)
        np.testing.assert_allclose(slope, expected, rtol=1e-7)
