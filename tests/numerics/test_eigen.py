"""Matching of eigenvalues."""

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from racs_bif.numerics.eigen import match


def test_a_shuffle_is_undone():
    random = np.random.default_rng(3)
    before = random.standard_normal(20) + 1j * random.standard_normal(20)
    order = random.permutation(20)
    assert np.array_equal(before[match(before, before[order] + 1e-6)], before[np.argsort(order)])


def test_two_that_want_the_same_share():
    before, after = np.array([0.0, 1.0, 5.0]), np.array([0.9, 2.0, 5.0])
    assert match(before + 0j, after + 0j).tolist() == [0, 1, 2]


def test_few_and_many_are_matched_alike():
    random = np.random.default_rng(3)
    for size in (2, 3, 4, 5, 6):
        for _ in range(20):
            before, after = random.standard_normal(size) + 0j, 0.1 * random.standard_normal(size)
            distance = np.abs(before[:, None] - after[None, :])
            places = match(before, after + 0j)
            assert sorted(places) == list(range(size))
            least = distance[linear_sum_assignment(distance)].sum()
            assert distance[np.arange(size), places].sum() == pytest.approx(least, rel=1e-12)
