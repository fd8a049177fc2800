"""Unstable roots of the points of a branch, counted together."""

import numpy as np

import racs_bif as rb
from racs_bif.charts.along import count_along
from racs_bif.charts.counting import UNKNOWN
from racs_bif.fractional.argument import count_unstable


def test_counts_together_are_those_one_by_one():
    system = rb.load_model("racs")
    speeds = np.linspace(6.0, 28.0, 12)
    path = system.path("u")
    P = np.array([path.vector(u) for u in speeds]).T
    X = np.array([system.exact_point(system.equilibrium(p), p) for p in P.T]).T
    counts = count_along(system, X + 1e-4, P)
    assert counts.tolist() == [
        count_unstable(system.exact, x, p).unstable for x, p in zip(X.T, P.T, strict=True)
    ]
    assert set(counts) == {0, 2}
    # from far away Newton's method does not contract at once
    counts = count_along(system, X + np.where(speeds > 20.0, 50.0, 0.0), P)
    assert (counts[speeds > 20.0] == UNKNOWN).all()
    assert (counts[speeds <= 20.0] != UNKNOWN).all()
