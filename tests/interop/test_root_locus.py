"""Eigenvalues along a branch as continuous loci."""

from dataclasses import replace

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import UsageError


def test_loci_that_cross_go_straight_on():
    model = rb.model_from_strings(
        "crossing", {"x": "(p - 1)*x", "y": "(-p - 1)*y", "z": "-3*z"}, parameters={"p": -0.95}
    )
    branch = rb.continue_equilibria(model, "p", (-0.95, 0.9))
    locus = rb.root_locus(branch)
    loci = {round(float(column[0].real), 2): column for column in locus.eigenvalues.T}
    np.testing.assert_allclose(loci[-1.95], locus.values - 1.0, atol=1e-9)
    np.testing.assert_allclose(loci[-0.05], -locus.values - 1.0, atol=1e-9)
    assert locus.parameter == "p"


def test_loci_are_the_spectrum_in_another_order(equilibria):
    locus = rb.root_locus(equilibria)
    for row, spectrum in zip(locus.eigenvalues, equilibria.spectrum, strict=True):
        np.testing.assert_array_equal(np.sort_complex(row), np.sort_complex(spectrum))
    moved = np.abs(np.diff(locus.eigenvalues, axis=0)).sum()
    assert moved < np.abs(np.diff(equilibria.spectrum, axis=0)).sum()
    assert (locus.unit, locus.model) == ("m/s", "racs")


def test_the_critical_locus_crosses_the_axis_at_the_hopf_point(equilibria):
    locus, hopf = rb.root_locus(equilibria), equilibria["H1"]
    row = locus.eigenvalues[hopf.index]
    k = int(np.argmin(np.abs(row - 1j * hopf.omega)))
    assert row[k] == pytest.approx(1j * hopf.omega, abs=1e-6)
    assert locus.eigenvalues[0, k].real < 0.0 < locus.eigenvalues[-1, k].real


def test_rows_with_fewer_eigenvalues_leave_loci_open(equilibria):
    spectrum = equilibria.spectrum.copy()
    spectrum[5:, -1] = np.nan
    locus = rb.root_locus(replace(equilibria, spectrum=spectrum))
    assert np.count_nonzero(np.isnan(locus.eigenvalues)) == len(spectrum) - 5
    assert np.count_nonzero(np.isnan(locus.eigenvalues).any(axis=0)) == 1


def test_multipliers_of_orbits_have_loci_too(equilibria):
    orbits = rb.continue_orbits(equilibria["H1"], span=(10, 11))
    locus = rb.root_locus(orbits)
    assert locus.kind == "orbit"
    known = ~np.isnan(locus.eigenvalues).all(axis=1)
    assert np.count_nonzero(known) > 5
    assert np.nanmin(np.abs(locus.eigenvalues[known] - 1.0), axis=1).max() < 1e-6


def test_a_branch_without_eigenvalues(equilibria):
    bare = replace(equilibria, spectrum=np.full((len(equilibria), 2), np.nan))
    with pytest.raises(UsageError, match="carries no eigenvalues"):
        rb.root_locus(bare)
