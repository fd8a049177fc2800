"""A population of neurons whose synapses tire and recover.

Its activity E, the share x of transmitter that is left and the share u that is released::

    tau_E E' = -E + a log(1 + exp((J u x E + E_0)/a))
    x' = (1 - x)/tau_D - u x E
    u' = (U_0 - u)/tau_F + U_0 (1 - u) E

Source
------
J. M. Cortes, M. Desroches, S. Rodrigues, R. Veltz, M. A. Munoz and T. J. Sejnowski, Short-term
synaptic plasticity in the deterministic Tsodyks-Markram model leads to unpredictable network
dynamics, PNAS 110 (2013) 16610-16615; the tutorial of BifurcationKit.jl.

Known result
------------
In E_0 folds at -1.46302732554269 and -1.86522391033905 and Hopf points at -1.85012459476756 (omega
1.99984792947854) and -1.15105939691867 (19.3650354034982, c1 0.02605640481). The cycles of the last
fold at -1.14585313623 (T = 0.332533059919) and -1.7690340404 (0.8053578).

Try ``racs-bif continue E_0 -2.2 -0.9 --model neural_mass --orbits collocation``.
"""

from __future__ import annotations

import sympy as sp

from racs_bif import Model, Parameter


def model() -> Model:
    """Build the population."""
    E, x, u = sp.symbols("E x u")
    E_0, a, J, U_0, tau_E, tau_D, tau_F = sp.symbols("E_0 a J U_0 tau_E tau_D tau_F")
    drive = (J * u * x * E + E_0) / a
    return Model(
        name="neural_mass",
        equations={
            "E": (-E + a * sp.log(1 + sp.exp(drive))) / tau_E,
            "x": (1 - x) / tau_D - u * x * E,
            "u": (U_0 - u) / tau_F + U_0 * (1 - u) * E,
        },
        parameters=(
            Parameter("E_0", -2.0, description="input from outside"),
            Parameter("a", 1.5, description="softness of the threshold"),
            Parameter("J", 3.07, description="strength of the synapses"),
            Parameter("U_0", 0.3, description="release at rest"),
            Parameter("tau_E", 0.013, "s", "time of the population"),
            Parameter("tau_D", 0.2, "s", "time in which transmitter recovers"),
            Parameter("tau_F", 1.5, "s", "time in which facilitation fades"),
        ),
        guess={"E": 0.24, "x": 0.98, "u": 0.37},
        units={"E": "1/s"},
        descriptions={"E": "activity", "x": "transmitter left", "u": "transmitter released"},
        title="neural mass with short-term plasticity",
        source="J. M. Cortes et al., PNAS 110 (2013) 16610",
    )
