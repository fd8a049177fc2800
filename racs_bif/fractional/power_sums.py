"""Tidying sums of real powers."""

from __future__ import annotations

import numpy as np

from racs_bif.fractional.laws import PowerSum


def merged(row: PowerSum) -> PowerSum:
    """Return a sum with ascending exponents, each once, and no term that is zero.

    Terms that cancel but for rounding are zero.

    Examples
    --------
    >>> row = merged(PowerSum(np.array([2.0, 1.0, 3.0]), np.array([0.5, 0.0, 0.5])))
    >>> print(row.coefficients, row.exponents)
    [1. 5.] [0.  0.5]
    """
    exponents, places = np.unique(row.exponents, return_inverse=True)
    coefficients, sizes = np.zeros(len(exponents)), np.zeros(len(exponents))
    np.add.at(coefficients, places.ravel(), row.coefficients)
    np.add.at(sizes, places.ravel(), np.abs(row.coefficients))
    keep = np.abs(coefficients) > 8.0 * np.finfo(float).eps * sizes
    return PowerSum(coefficients[keep], exponents[keep])
