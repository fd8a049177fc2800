"""Branches along which the mass matrix becomes singular."""

import sympy as sp

import racs_bif as rb


def test_a_branch_says_where_the_mass_matrix_is_singular():
    x, y, a = sp.symbols("x y a")
    model = rb.Model(
        "inertia",
        {"x": y, "y": -x - y},
        (rb.Parameter("a", 0.5),),
        mass=sp.diag(1, 1 - a),
    )
    branch = rb.continue_equilibria(model, "a", (0.0, 2.0))
    said = branch.stopped.partition("The mass matrix is singular between a = ")[2]
    low, high = map(float, said.partition(":")[0].split(" and "))
    assert low < 1.0 < high < low + 0.2
    assert not branch.special
    assert set(branch.unstable[branch.column("a") < 0.9]) == {0}
    assert set(branch.unstable[branch.column("a") > 1.1]) == {1}
    assert "singular" not in rb.continue_equilibria(model, "a", (0.0, 0.9)).stopped
