"""FitzHugh and Nagumo's nerve: two states that fire like Hodgkin and Huxley's four.

A fast voltage v and a slow recovery w, driven by the current I::

    v' = v - v^3/3 - w + I
    w' = epsilon (v + a - b w)

Source
------
R. FitzHugh, Impulses and physiological states in theoretical models of nerve membrane, Biophysical
Journal 1 (1961) 445-466; J. Nagumo, S. Arimoto and S. Yoshizawa, Proceedings of the IRE 50 (1962)
2061-2070.

Known result
------------
With a = 0.7, b = 0.8, epsilon = 0.08 two Hopf points, at I = 0.331281337454746 and
1.41871866254525, both with omega = 0.275506805723561 and c1 = 0.267784648: subcritical, so that
firing begins and ends with a jump. In closed form v^2 = 1 - b epsilon and omega^2 = epsilon - (b
epsilon)^2 there. The equations are symmetric about I = a/b.

Try ``racs-bif continue I 0 2 --model fitzhugh_nagumo --orbits collocation``.
"""

from __future__ import annotations

import sympy as sp

from racs_bif import Model, Parameter


def model() -> Model:
    """Build the nerve."""
    v, w, current, a, b, epsilon = sp.symbols("v w I a b epsilon")
    return Model(
        name="fitzhugh_nagumo",
        equations={"v": v - v**3 / 3 - w + current, "w": epsilon * (v + a - b * w)},
        parameters=(
            Parameter("I", 0.0, description="current through the membrane"),
            Parameter("a", 0.7, description="where the recovery vanishes"),
            Parameter("b", 0.8, description="decay of the recovery"),
            Parameter("epsilon", 0.08, description="ratio of the two time scales"),
        ),
        guess={"v": -1.2, "w": -0.6},
        descriptions={"v": "voltage across the membrane", "w": "recovery"},
        time_unit="",
        title="FitzHugh-Nagumo nerve",
        source="R. FitzHugh, Biophys. J. 1 (1961) 445",
    )
