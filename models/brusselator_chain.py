"""A chain of Brusselators coupled by diffusion: many states, every special point in closed form.

N cells, closed at both ends (x_0 = x_1, x_{N+1} = x_N, and so for y)::

    x_j' = A - (B + 1) x_j + x_j^2 y_j + D_x (x_{j-1} - 2 x_j + x_{j+1})
    y_j' =         B x_j - x_j^2 y_j   + D_y (y_{j-1} - 2 y_j + y_{j+1})

The number of cells is the variant: ``--variant 15``.

Source
------
M. Kubicek and M. Marek, Computational Methods in Bifurcation Theory and Dissipative Structures,
Springer 1983.

Known result
------------
The uniform state x_j = A, y_j = B/A has a mode cos(pi k (j - 1/2)/N) for each k = 0 .. N - 1, with
r_k = 4 sin^2(pi k/(2 N)). Mode k has a Hopf point at B = 1 + A^2 + (D_x + D_y) r_k with
omega^2 = A^2 (1 + (D_x - D_y) r_k) - D_y^2 r_k^2 where that is positive, and for k > 0 a branch
point at B = 1 + A^2 D_x/D_y + A^2/(D_y r_k) + D_x r_k (exact). The first cycle, k = 0, is that of
one Brusselator in every cell: at B = 2.5 its period is 6.577284341906.

Try ``racs-bif continue B 1.5 2.8 --model brusselator_chain``.
"""

from __future__ import annotations

import sympy as sp

from racs_bif import Model, Parameter
from racs_bif.errors import UsageError

VARIANTS = {"15": "15 cells, 30 states (the default); any whole number from 2 on will do"}


def model(*, variant: str = "15") -> Model:
    """Build a chain of `variant` cells."""
    if not variant.isdecimal() or int(variant) < 2:
        msg = f"unknown variant '{variant}' of model 'brusselator_chain'"
        raise UsageError(f"{msg}; give a number of cells from 2 on")
    cells = int(variant)
    A, B, D_x, D_y = sp.symbols("A B D_x D_y")
    x, y = sp.symbols(f"x_1:{cells + 1}"), sp.symbols(f"y_1:{cells + 1}")
    equations: dict[str, sp.Expr] = {}
    guess: dict[str, float] = {}
    for j in range(cells):
        left, right = max(j - 1, 0), min(j + 1, cells - 1)
        spread_x, spread_y = x[left] - 2 * x[j] + x[right], y[left] - 2 * y[j] + y[right]
        equations[f"x_{j + 1}"] = A - (B + 1) * x[j] + x[j] ** 2 * y[j] + D_x * spread_x
        equations[f"y_{j + 1}"] = B * x[j] - x[j] ** 2 * y[j] + D_y * spread_y
        guess |= {f"x_{j + 1}": 1.0, f"y_{j + 1}": 1.5}
    return Model(
        name="brusselator_chain",
        equations=equations,
        parameters=(
            Parameter("A", 1.0, description="concentration of A"),
            Parameter("B", 1.5, description="concentration of B"),
            Parameter("D_x", 5.0, description="exchange of X between neighbours"),
            Parameter("D_y", 5.0, description="exchange of Y between neighbours"),
        ),
        guess=guess,
        descriptions={f"x_{j + 1}": f"concentration of X in cell {j + 1}" for j in range(cells)}
        | {f"y_{j + 1}": f"concentration of Y in cell {j + 1}" for j in range(cells)},
        time_unit="",
        title="chain of Brusselators",
        source="M. Kubicek and M. Marek, Computational Methods in Bifurcation Theory (1983)",
        variant=variant,
        variants=VARIANTS,
    )
