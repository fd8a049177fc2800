"""Hodgkin and Huxley's squid axon: how a current makes a nerve fire.

The voltage V across the membrane above its rest [mV] and three gates, time in ms::

    C V' = I - g_Na m^3 h (V - V_Na) - g_K n^4 (V - V_K) - g_L (V - V_L)
    m' = alpha_m (1 - m) - beta_m m,  and so for h and n

    alpha_m = 0.1 (25 - V) / (exp((25 - V)/10) - 1)      beta_m = 4 exp(-V/18)
    alpha_h = 0.07 exp(-V/20)                            beta_h = 1 / (exp((30 - V)/10) + 1)
    alpha_n = 0.01 (10 - V) / (exp((10 - V)/10) - 1)     beta_n = 0.125 exp(-V/80)

The modern sign: V is the inside minus the outside, depolarisation is positive; the paper has -V.
alpha_m and alpha_n are 0/0 at 25 and 10 mV, where every spike passes: they are written with a
function that is smooth there.

Source
------
A. L. Hodgkin and A. F. Huxley, A quantitative description of membrane current and its application
to conduction and excitation in nerve, Journal of Physiology 117 (1952) 500-544, at 6.3 degrees
Celsius. V_L = 10.599 mV is the paper's 10.6 before rounding: it puts the rest at V = 2e-5 mV.

Known result
------------
The axon fires between a subcritical Hopf point at I = 9.779637995393 (omega 0.5862338131) and a
supercritical one at I = 154.526633665808 (omega 1.0629218068). The cycles of the first fold at
I = 7.84654712003 (T = 16.7137967202), 7.9219854929 (20.7072946) and 6.26452127451 (19.8952407126):
from there to the Hopf point rest and firing are both stable (J. Rinzel and R. N. Miller,
Mathematical Biosciences 49 (1980) 27-59).

Try ``racs-bif continue I 0 200 --model hodgkin_huxley``.
"""

from __future__ import annotations

from math import inf

import sympy as sp

from racs_bif import Model, Parameter
from racs_bif.symbolic.removable import over_expm1


def model() -> Model:
    """Build the axon."""
    V, m, h, n, current = sp.symbols("V m h n I")
    C, g_Na, g_K, g_L, V_Na, V_K, V_L = sp.symbols("C g_Na g_K g_L V_Na V_K V_L")
    sodium = g_Na * m**3 * h * (V - V_Na)
    potassium = g_K * n**4 * (V - V_K)
    alpha_m, beta_m = over_expm1((25 - V) / 10), 4 * sp.exp(-V / 18)
    alpha_h, beta_h = sp.Rational(7, 100) * sp.exp(-V / 20), 1 / (sp.exp((30 - V) / 10) + 1)
    alpha_n, beta_n = over_expm1((10 - V) / 10) / 10, sp.exp(-V / 80) / 8
    return Model(
        name="hodgkin_huxley",
        equations={
            "V": (current - sodium - potassium - g_L * (V - V_L)) / C,
            "m": alpha_m * (1 - m) - beta_m * m,
            "h": alpha_h * (1 - h) - beta_h * h,
            "n": alpha_n * (1 - n) - beta_n * n,
        },
        parameters=(
            Parameter("I", 0.0, "uA/cm^2", "current through the membrane"),
            Parameter("C", 1.0, "uF/cm^2", "capacity", valid=(0.0, inf)),
            Parameter("g_Na", 120.0, "mS/cm^2", "conductance of sodium"),
            Parameter("g_K", 36.0, "mS/cm^2", "conductance of potassium"),
            Parameter("g_L", 0.3, "mS/cm^2", "conductance of the leak"),
            Parameter("V_Na", 115.0, "mV", "equilibrium voltage of sodium"),
            Parameter("V_K", -12.0, "mV", "equilibrium voltage of potassium"),
            Parameter("V_L", 10.599, "mV", "equilibrium voltage of the leak"),
        ),
        guess={"m": 0.053, "h": 0.6, "n": 0.32},
        units={"V": "mV"},
        descriptions={
            "V": "voltage across the membrane, above rest",
            "m": "activation of sodium",
            "h": "inactivation of sodium",
            "n": "activation of potassium",
        },
        time_unit="ms",
        title="Hodgkin-Huxley squid axon",
        source="A. L. Hodgkin and A. F. Huxley, J. Physiol. 117 (1952) 500",
        notes=("Time is in ms: periods are in ms and frequencies in rad/ms.",),
    )
