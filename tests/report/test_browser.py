"""The page in a real headless Chromium."""

import json
from dataclasses import replace

import numpy as np
import pytest
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

from racs_bif.report.page import page
from racs_bif.results.branch import Profile
from racs_bif.results.diagram import Diagram

STATES = ("v", "w", "delta_c", "ddelta_c")
PLACES = (0, 10, 25, 40)
PATIENCE = 60
PIXEL = """
const box = document.getElementById('diagram'), axes = box._fullLayout;
const [branch, index, curve] = arguments;
const b = report.branches[branch], here = box.getBoundingClientRect();
return [here.x + axes.xaxis._offset + axes.xaxis.l2p(b.active.u[index]),
        here.y + axes.yaxis._offset + axes.yaxis.l2p(b.curves.delta_c[curve][index])];
"""


def _orbit(u):
    times = np.linspace(0.0, 1.0, 41)
    size = np.sqrt(max(u - 10.0, 0.0) / 50.0)
    angle = 2.0 * np.pi * times
    states = [0.3 * np.sin(angle), size * np.cos(angle), -size * np.sin(angle), np.cos(angle)]
    return Profile(times=times, names=STATES, states=np.array(states).T)


@pytest.fixture
def vehicle(known):
    """Return a diagram with the vehicle's states and orbits along its branch."""
    numbers = {"u": 5.0, "a": 1.46, "b": 1.54, "c": 0.35, "delta_f": 0.02}
    system = replace(known.system_info(), states=STATES, parameters=numbers)
    orbits = known.orbits()
    samples = {k: _orbit(orbits.parameter[k]) for k in PLACES}
    return Diagram(
        replace(known.equilibria(), system=system),
        replace(orbits, system=system, profiles={}, samples=samples),
    )


@pytest.fixture
def shown(browser, tmp_path):
    """Open a page; fail at the end if it complained or asked a network for anything."""
    paths = []

    def show(diagram):
        path = tmp_path / "report.html"
        path.write_text(page(diagram, ["continue", "u", "5", "30"]), encoding="utf-8")
        browser.get_log("browser")
        browser.get_log("performance")
        browser.execute_cdp_cmd(
            "Emulation.setDeviceMetricsOverride",
            {"width": 1280, "height": 800, "deviceScaleFactor": 1, "mobile": False},
        )
        browser.get(path.as_uri())
        paths.append(path.as_uri())
        WebDriverWait(browser, PATIENCE).until(
            lambda b: b.execute_script("return document.body.dataset.ready")
        )
        return browser

    yield show
    assert browser.get_log("browser") == []
    sent = [json.loads(entry["message"])["message"] for entry in browser.get_log("performance")]
    asked = {
        event["params"]["request"]["url"]
        for event in sent
        if event["method"] == "Network.requestWillBeSent"
        and event["params"]["documentURL"] in paths  # not the browser's own first page
    }
    assert {url for url in asked if not url.startswith("data:")} == set(paths)


def _wait_for(browser, branch, index):
    WebDriverWait(browser, PATIENCE).until(
        lambda b: b.execute_script("return document.body.dataset.shown") == f"{branch} {index}"
    )


def _points(browser, panel, trace):
    return browser.execute_script(
        "const t = document.getElementById(arguments[0]).data[arguments[1]];"
        "return [Array.from(t.x), Array.from(t.y)];",
        panel,
        trace,
    )


def _click(browser, branch, index, curve=0):
    x, y = browser.execute_script(PIXEL, branch, index, curve)
    corner = browser.find_element(By.TAG_NAME, "html")
    size = browser.execute_script("return [innerWidth, innerHeight]")
    assert 0 < x < size[0]
    assert 0 < y < size[1]
    mouse = ActionChains(browser)
    mouse.w3c_actions.pointer_action.move_to_location(round(x) - 3, round(y))
    mouse.w3c_actions.pointer_action.move_to_location(round(x), round(y))
    mouse.pause(0.3).click().perform()
    assert corner.is_displayed()


def _turned(browser, part):
    return browser.execute_script(
        "return document.querySelector(arguments[0]).transform.baseVal.consolidate().matrix.b",
        f"#top {part}",
    )


def test_a_click_on_a_point_shows_what_belongs_to_it(shown, vehicle):
    browser = shown(vehicle)
    orbits = vehicle["PO1"]
    _click(browser, 1, 25, 1)
    _wait_for(browser, 1, 25)
    roots = orbits.spectrum[25]
    assert _points(browser, "spectrum", 0)[0] == pytest.approx(roots[np.isfinite(roots)].real)
    profile = orbits.samples[25]
    times, column = _points(browser, "history", 0)
    assert times == pytest.approx(profile.times)
    assert column == pytest.approx(profile.states[:, 2], abs=1e-6)
    assert _points(browser, "portrait", 0)[1] == pytest.approx(profile.states[:, 3], abs=1e-5)
    ring = browser.execute_script("return document.getElementById('diagram').data.length - 1")
    assert _points(browser, "diagram", ring)[0] == pytest.approx([orbits.parameter[25]] * 2)

    _click(browser, 0, 3)
    _wait_for(browser, 0, 3)
    assert _points(browser, "spectrum", 0)[1] == pytest.approx([9.5, -9.5, 0.0])
    assert not browser.find_element(By.ID, "history").is_displayed()
    assert not browser.find_element(By.ID, "portrait").is_displayed()
    assert "An equilibrium" in browser.find_element(By.ID, "rest").text


def test_the_slider_moves_the_ring_and_the_vehicle(shown, vehicle):
    browser = shown(vehicle)
    orbits = vehicle["PO1"]
    place = browser.find_element(By.ID, "place")
    start = int(place.get_attribute("value"))
    assert start == PLACES[2]
    before = _turned(browser, ".rear")
    place.send_keys(*[Keys.ARROW_RIGHT] * 15)
    _wait_for(browser, 1, start + 15)
    ring = browser.execute_script("return document.getElementById('diagram').data.length - 1")
    assert _points(browser, "diagram", ring)[0][0] == pytest.approx(orbits.parameter[start + 15])
    assert f"point {start + 16} of {len(orbits)}" in browser.find_element(By.ID, "told").text

    browser.execute_script(
        "const s = document.getElementById('phase'); s.value = 0.25;"
        "s.dispatchEvent(new Event('input'));"
    )
    now = orbits.samples[start + 15].states[10, 2]
    assert _turned(browser, ".rear") == pytest.approx(-np.sin(3 * now), abs=1e-3)
    assert _turned(browser, ".rear") != pytest.approx(before, abs=1e-2)
    assert _turned(browser, ".front") == pytest.approx(-np.sin(3 * 0.02), abs=1e-3)


def test_playing_swings_the_vehicle(shown, vehicle):
    browser = shown(vehicle)
    before = _turned(browser, ".car"), _turned(browser, ".rear")
    browser.find_element(By.ID, "play").click()
    WebDriverWait(browser, PATIENCE).until(
        lambda b: (
            abs(_turned(b, ".car") - before[0]) > 1e-3
            and abs(_turned(b, ".rear") - before[1]) > 1e-3
        )
    )
    browser.find_element(By.ID, "play").click()
    assert browser.find_element(By.ID, "play").text.endswith("play")


def test_a_row_of_the_table_shows_its_point(shown, vehicle):
    browser = shown(vehicle)
    row = browser.find_element(By.CSS_SELECTOR, "#special tbody tr")
    browser.execute_script("arguments[0].click()", row)
    _wait_for(browser, 0, vehicle["H1"].index)
    assert "chosen" in row.get_attribute("class")
    assert "(H1)" in browser.find_element(By.ID, "told").text


def test_the_labels_stand_clear_of_each_other(shown, vehicle):
    browser = shown(vehicle)
    boxes = browser.execute_script(
        "return [...document.querySelectorAll('#diagram .annotation-text-g')]"
        ".map((g) => g.getBoundingClientRect()).map((r) => [r.x, r.y, r.right, r.bottom])"
    )
    assert len(boxes) == 2
    (a, b) = boxes
    assert a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]


def test_a_large_multiplier_does_not_hide_the_unit_circle(shown, vehicle):
    spectrum = vehicle["PO1"].spectrum.copy()
    spectrum[:, 1] = -3146.25
    browser = shown(Diagram(vehicle["EQ1"], replace(vehicle["PO1"], spectrum=spectrum)))
    low, high = browser.execute_script(
        "return document.getElementById('spectrum')._fullLayout.yaxis.range"
    )
    assert -4 < low < -1.2
    assert 1.2 < high < 4
    assert "beyond: -3146" in browser.find_element(By.ID, "spectrum").text


def test_another_model_has_no_vehicle(shown, known):
    browser = shown(Diagram(known.equilibria(), known.orbits()))
    assert not browser.find_element(By.ID, "vehicle").is_displayed()
    assert browser.find_element(By.ID, "portrait").is_displayed()
