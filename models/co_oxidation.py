"""Oxidation of carbon monoxide on platinum: the smallest scheme that oscillates.

Shares of the surface x (oxygen), y (carbon monoxide) and s (blocked), and z what is free::

    z  = 1 - x - y - s
    x' = 2 q_1 z^2 - 2 q_5 x^2 - q_3 x y
    y' = q_2 z - q_6 y - q_3 x y
    s' = q_4 (z - k s)

Source
------
V. I. Bykov, G. S. Yablonskii and V. F. Kim, On the simple model of kinetic self-oscillations in
catalytic reaction of CO oxidation, Doklady AN SSSR 242 (1978) 637-639; the MatCont manual.

Known result
------------
In q_2 Hopf points at 1.05155746245773 (omega 0.0507403448967863, c1 10.7010196344545) and
1.04099156953262 (0.0591061479357754, 4.33137897821287), folds at 1.04204850537853 and
1.05220028786995. In (q_2, k) a cusp at (1.00640832967832, 0.355991273208677), Bogdanov-Takens
points at (1.41762763760065, 0.971397573485313) and (1.16119870882174, 0.722339072522229), and
generalised Hopf points at (0.891318980774319, 0.232487354203037) and (0.924255015218579,
0.305879267477929).

Try ``racs-bif continue q_2 0.8 1.3 --model co_oxidation``.
"""

from __future__ import annotations

import sympy as sp

from racs_bif import Model, Parameter


def model() -> Model:
    """Build the reaction."""
    x, y, s, k = sp.symbols("x y s k")
    q_1, q_2, q_3, q_4, q_5, q_6 = sp.symbols("q_1:7")
    free = 1 - x - y - s
    return Model(
        name="co_oxidation",
        equations={
            "x": 2 * q_1 * free**2 - 2 * q_5 * x**2 - q_3 * x * y,
            "y": q_2 * free - q_6 * y - q_3 * x * y,
            "s": q_4 * (free - k * s),
        },
        parameters=(
            Parameter("q_1", 2.5, description="adsorption of oxygen"),
            Parameter("q_2", 1.0, description="adsorption of carbon monoxide"),
            Parameter("q_3", 10.0, description="reaction of the two"),
            Parameter("q_4", 0.0675, description="blocking of free surface"),
            Parameter("q_5", 1.0, description="desorption of oxygen"),
            Parameter("q_6", 0.1, description="desorption of carbon monoxide"),
            Parameter("k", 0.4, description="unblocking over blocking"),
        ),
        guess={"x": 0.001, "y": 0.3, "s": 0.4},
        outputs={"z": free},
        descriptions={
            "x": "surface covered by oxygen",
            "y": "surface covered by carbon monoxide",
            "s": "surface blocked",
            "z": "free surface",
        },
        time_unit="",
        title="CO oxidation on platinum",
        source="Bykov, Yablonskii and Kim, Dokl. AN SSSR 242 (1978) 637",
    )
