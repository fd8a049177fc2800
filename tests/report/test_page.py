import json
import re
import sys
from dataclasses import replace

import numpy as np
import pytest

from racs_bif.errors import UsageError
from racs_bif.report.data import _begins, kept_orbits, page_data, quantities
from racs_bif.report.names import axis_label
from racs_bif.report.page import page
from racs_bif.report.vehicle import geometry, yaw_angle
from racs_bif.results.branch import Profile
from racs_bif.results.diagram import Diagram


def _data(text):
    found = re.search(r'<script id="data" type="application/json">(.*?)</script>', text, re.DOTALL)
    return json.loads(found[1])


def test_the_page_holds_the_numbers_of_the_branches(known):
    diagram = Diagram(known.equilibria(), known.orbits())
    data = _data(page(diagram))
    for branch, told in zip(diagram, data["branches"], strict=True):
        assert told["name"] == branch.name
        assert told["active"]["u"] == pytest.approx(branch.parameter, rel=1e-9)
        for row, roots in zip(branch.spectrum, told["spectrum"], strict=True):
            there = row[np.isfinite(row)]
            assert np.array(roots) == pytest.approx(np.c_[there.real, there.imag], rel=1e-7)
    orbits = data["branches"][1]
    assert orbits["curves"]["delta_c"][1] == pytest.approx(diagram["PO1"].column("min delta_c"))
    assert [(p["name"], p["index"]) for p in orbits["special"]] == [
        (p.name, p.index) for p in diagram["PO1"].special
    ]


def test_orbits_are_found_under_their_places(known):
    branch = known.orbits()
    sample = replace(branch.profiles["NS1"], times=2.0 * branch.profiles["NS1"].times)
    kept = kept_orbits(replace(branch, samples={3: sample}))
    assert list(kept) == [3, branch["NS1"].index]
    assert kept[3] is sample


def test_the_tables_tell_exact_shifts_and_the_command(known):
    text = page(Diagram(known.equilibria()), ["continue", "u", "5", "30", "--model", "a b.py"])
    assert "<td>10.001</td><td>-1.00e-04</td>" in text
    assert "racs-bif continue u 5 30 --model &#x27;a b.py&#x27;" in text
    assert "oustaloup, 1 states, 0.1 to 1000 rad/s, largest error there 1 %" in text
    assert "the sign in print is inconsistent" in text
    assert "no summary.json" in page(Diagram(known.equilibria()))


def test_names_that_are_html_do_not_become_html(known):
    system = replace(known.system_info(), title="</script><b>x", notes=("<img src=x>",))
    text = page(Diagram(replace(known.equilibria(), system=system)))
    assert "<b>x" not in text.replace("&lt;b&gt;x", "")
    assert "<img src=x>" not in text
    assert axis_label("a<b", "m^2") == "a&lt;b [m<sup>2</sup>]"


def test_nothing_on_the_page_is_loaded_from_elsewhere(known):
    text = page(Diagram(known.equilibria()))
    assert "default-src 'none'" in text
    markup = re.sub(r"<script.*?</script>", "", text, flags=re.DOTALL)
    assert not re.findall(r"(?:src|href)\s*=\s*[\"'](?!data:,)", markup)
    assert not re.findall(r"<script[^>]*\ssrc=", text)


def test_unknown_quantities_are_named(known):
    with pytest.raises(UsageError, match="nothing called 'delta_d' to show; did you mean"):
        page(Diagram(known.equilibria()), state="delta_d")


def test_without_plotly_the_message_is_the_mend(known, monkeypatch):
    monkeypatch.setitem(sys.modules, "plotly.offline", None)
    with pytest.raises(UsageError, match=r"pip install 'racs-bif\[report\]'"):
        page(Diagram(known.equilibria()))


def test_yaw_is_the_integral_of_the_yaw_rate_about_its_mean():
    times = np.linspace(0.0, 2.0, 2001)
    rate = 0.3 + 0.5 * np.cos(np.pi * times)
    profile = Profile(times=times, names=("v", "w"), states=np.c_[times, rate])
    assert yaw_angle(profile) == pytest.approx(0.5 * np.sin(np.pi * times) / np.pi, abs=1e-6)


def test_only_a_vehicle_with_a_steered_rear_axle_is_drawn(known):
    system = known.system_info()
    assert geometry(system) is None
    numbers = {"a": 1.4, "b": 1.5, "c": 0.3, "delta_f": 0.01}
    vehicle = replace(system, states=("v", "w", "delta_c"), parameters=numbers)
    assert geometry(vehicle) == numbers
    assert page_data(Diagram(known.equilibria()), "v")["vehicle"] is None


def test_an_ordinary_model_without_special_points(known):
    branch = known.equilibria()
    system = replace(branch.system, realisation=None, variant="")
    labels = ["" for _ in branch.labels]
    plain = replace(branch, special=(), labels=labels, system=system)
    text = page(Diagram(plain))
    assert "<p>There is no special point in this span.</p>" in text
    assert "none: the model has no fractional element" in text
    assert "<td>variant</td>" not in text
    assert "variant" in page(Diagram(branch))


def test_the_page_begins_at_the_first_thing_of_interest(known):
    branch = known.equilibria()
    ordinary = replace(branch, special=branch.special[1:])
    without = replace(known.orbits(), profiles={})
    assert _begins(Diagram(ordinary)) == [0, 0]
    assert _begins(Diagram(ordinary, replace(branch, name="EQ2"))) == [1, branch["H1"].index]
    place = without["NS1"].index
    assert _begins(Diagram(ordinary, without)) == [1, place]


def test_a_curve_shows_its_second_parameter(known):
    branch = known.equilibria()
    values = np.column_stack([branch.parameter, 2.0 * branch.parameter])
    curve = replace(branch, kind="curve", parameters=("u", "m"), values=values)
    found = quantities(curve)
    assert list(found) == ["m"]
    np.testing.assert_array_equal(found["m"][0], values[:, 1])


def test_an_orbit_that_takes_no_time_does_not_turn():
    profile = Profile(times=np.zeros(1), names=("v", "w"), states=np.ones((1, 2)))
    np.testing.assert_array_equal(yaw_angle(profile), [0.0])
