"""Rear-steer feedback: the shimmy speed with and without it."""

import numpy as np
import pytest

from racs_bif.shelf import find, load_module


@pytest.fixture(scope="module")
def analysis():
    return load_module(find("analyses", "rear_steer_feedback"))


@pytest.fixture(scope="module")
def study(analysis):
    return analysis.study(15.0, 200.0)


def test_the_shimmy_speed_without_and_with_feedback(analysis, study):
    without = analysis.shimmy(study.without)
    assert [p.exact.parameters["u"] for p in without] == [pytest.approx(10.2, rel=1e-9)]
    measured = analysis.shimmy(study.designs[analysis.LEFT_OUT].branch)
    speeds = [p.exact.parameters["u"] for p in measured]
    np.testing.assert_allclose(speeds, [19.2903, 38.0958], rtol=1e-5)
    assert not analysis.shimmy(study.designs[analysis.GIVEN].branch)


def test_the_curve_joins_the_exact_hopf_points(analysis, study):
    """From the vehicle's own Hopf point to those with the whole feedback, and back in between."""
    design = study.designs[analysis.LEFT_OUT]
    kappa, u = design.curve.parameter, design.curve.column("u")
    assert (kappa[0], u[0]) == (pytest.approx(0.0, abs=1e-12), pytest.approx(10.2, rel=1e-9))
    top = int(np.argmax(kappa))
    lower = np.interp(1.0, kappa[: top + 1], u[: top + 1])
    upper = np.interp(-1.0, -kappa[top:], u[top:])
    np.testing.assert_allclose([lower, upper], [19.2903, 38.0958], rtol=2e-3)
    assert kappa[top] == pytest.approx(1.175, abs=2e-3)


def test_growth_rates_change_sign_at_the_hopf_points(analysis, study):
    rate, u = analysis.growth(study.without), study.without.parameter
    assert np.all(rate[u < 10.19] < 0.0)
    assert np.all(rate[u > 10.21] > 0.0)
    assert analysis.growth(study.designs[analysis.GIVEN].branch).max() < -0.5


def test_it_writes_text_and_picture(analysis, study, tmp_path, monkeypatch):
    monkeypatch.setattr(analysis, "study", lambda *_: study)
    path = analysis.run(tmp_path)
    text = path.read_text(encoding="utf-8")
    assert "| none | H1 | 10.200000 | 9.520083 |" in text
    assert (tmp_path / "rear_steer_feedback.png").stat().st_size > 10_000
