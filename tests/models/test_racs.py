"""The vehicle against ../shared/model.md: matrices, exact equilibria and exact Hopf points.

Nothing of racs_bif evaluates anything here: the models' equations are differentiated and compiled
in this file, and the characteristic determinant is built from them with s^alpha on the principal
branch.
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
import sympy as sp
from scipy.optimize import brentq, root

from racs_bif.errors import UsageError
from racs_bif.symbolic.model import Calibration, Model

if TYPE_CHECKING:
    from types import ModuleType

C_S = 29661.065  # N/rad, model.md section 3
NAMES = ("paper", "printed", "printed12", "paper12", "restoring", "lagrange")
MECHANICAL = (0, 1, 3)  # rows of v, w, ddelta_c among the states


def _load() -> ModuleType:
    path = Path(__file__).parents[2] / "models" / "racs.py"
    spec = importlib.util.spec_from_file_location("racs_under_test", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


racs = _load()
MODELS: dict[str, Model] = {name: racs.model(variant=name) for name in NAMES}
symbols = {p.name: sp.Symbol(p.name) for p in MODELS["paper"].parameters}
u, m, I_z, b, c, d, e = (symbols[name] for name in ("u", "m", "I_z", "b", "c", "d", "e"))
a, m_c, I_cs = (symbols[name] for name in ("a", "m_c", "I_cs"))
v, w, delta_c, ddelta_c = sp.symbols("v w delta_c ddelta_c")


class Exact:
    """The exact fractional model in numbers: equilibria and det Delta(s) / det M."""

    def __init__(self, variant: str, **values: float) -> None:
        model = MODELS[variant]
        (element,) = model.elements
        self.values = {
            p.name: C_S / (0.8 * 0.5e5) if isinstance(p.default, Calibration) else p.default
            for p in model.parameters
        }
        if "C_s" in values:
            values["A_h"] = values.pop("C_s") / (0.8 * 0.5e5)
        self.values.update(values)
        x = sp.symbols(model.states)
        y, s = sp.Symbol(element.output), sp.Symbol("s")
        given = (x, y, sp.symbols(tuple(self.values)))
        f = sp.Matrix(list(model.equations.values()))
        self._f = sp.lambdify(given, f, cse=True)
        self._f_x = sp.lambdify(given, f.jacobian(x), cse=True)
        self._f_y = sp.lambdify(given, f.diff(y), cse=True)
        self._mass = sp.lambdify(given, model.mass)
        self.law = sp.lambdify((s, given[2]), element.law)
        self._row = np.array(sp.Matrix([element.input]).jacobian(x), dtype=float)

    def _at(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, list[float]]:
        return x, (self._row @ x)[0], list(self.values.values())

    def equilibrium(self) -> np.ndarray:
        x = np.zeros(4)
        for _ in range(50):
            place = self._at(x)
            step = np.linalg.solve(
                self._f_x(*place) + self._f_y(*place) @ self._row, self._f(*place)[:, 0]
            )
            x = x - step * min(1.0, 0.02 / max(abs(step[2]), 1e-300))
            if np.abs(step).max() < 1e-14:
                return x
        msg = "no equilibrium"
        raise ArithmeticError(msg)

    def det(self, s: complex | np.ndarray, x: np.ndarray) -> np.ndarray:
        place = self._at(x)
        s = np.atleast_1d(np.asarray(s, dtype=complex))[:, None, None]
        mass, f_x, f_y = self._mass(*place), self._f_x(*place), self._f_y(*place)
        delta = s * mass - f_x - self.law(s, place[2]) * (f_y @ self._row)
        return np.linalg.det(delta) / np.linalg.det(mass)

    def hopf(self, u: float, omega: float) -> tuple[float, float]:
        def conditions(z: np.ndarray) -> list[float]:
            self.values["u"] = z[0]
            value = self.det(1j * z[1], self.equilibrium())[0]
            return [value.real, value.imag]

        result = root(conditions, [u, omega], tol=1e-13)
        assert result.success, result.message
        return tuple(result.x)

    def unstable(self, x: np.ndarray) -> float:
        """Count the roots with Re s > 0 by the argument principle; det ~ s^4 far out."""
        omega = np.concatenate([[1e-300], np.logspace(-9, 7, 1000), np.logspace(-1, 2, 5000)])
        phase = np.unwrap(np.angle(self.det(1j * np.sort(omega), x)))
        assert np.abs(np.diff(phase)).max() < 0.5
        return 2.0 - (phase[-1] - phase[0]) / np.pi


# --- equations ------------------------------------------------------------------------------


def _matrices_of_model_md() -> tuple[sp.Matrix, sp.Matrix]:
    mass = sp.Matrix(
        [
            [m + m_c, -(b - e) * m_c, e * m_c],
            [(b - c) * m_c, -((b - e) * (b - c) * m_c + I_z), e * (b - c) * m_c],
            [(c - e) * m_c, -((c - e) * (b - e) * m_c + I_cs), e * (c - e) * m_c - I_cs],
        ]
    )
    return mass, sp.Matrix([[1, 1, 0], [-a, b - c, d - c], [0, c, -(d - c)]])


def _mechanical(model: Model) -> tuple[sp.Matrix, sp.Matrix]:
    right = sp.Matrix(list(model.equations.values()))
    return model.mass.extract(MECHANICAL, MECHANICAL), right.extract(MECHANICAL, [0])


def _zero(matrix: sp.Matrix) -> bool:
    return matrix.applyfunc(sp.simplify) == sp.zeros(*matrix.shape)


@pytest.mark.parametrize("variant", ["paper", "printed", "restoring"])
def test_equations_have_the_matrices_of_the_paper(variant: str) -> None:
    model = MODELS[variant]
    mass, right = _mechanical(model)
    expected_mass, force = _matrices_of_model_md()
    forces = sp.Matrix([model.outputs[name] for name in ("F_f", "F_r", "F_d")])
    assert _zero(mass - expected_mass)
    assert _zero(right - sp.Matrix([-m * u * w, 0, 0]) - force * forces)
    assert model.equations["delta_c"] == ddelta_c
    assert list(model.mass.row(2)) == [0, 0, 1, 0]
    assert list(model.mass.col(2)) == [0, 0, 1, 0]


@pytest.mark.parametrize(
    ("variant", "slip_sign", "unit_sign"),
    [
        ("paper", 1, -1),
        ("printed", -1, 1),
        ("printed12", -1, 1),
        ("paper12", 1, -1),
        ("restoring", -1, -1),
        ("lagrange", -1, -1),
    ],
)
def test_signs(variant: str, slip_sign: int, unit_sign: int) -> None:
    model = MODELS[variant]
    C_s = model.derived[0].expression
    assert sp.diff(model.outputs["alpha_r"], delta_c) == slip_sign
    assert sp.expand(model.outputs["F_d"] - unit_sign * C_s * sp.Symbol("delta_z")) == 0
    wheel = v - b * w - (c * ddelta_c if variant == "lagrange" else 0)
    assert sp.expand(model.outputs["alpha_r"] - wheel / u - slip_sign * delta_c) == 0
    assert sp.expand(model.outputs["alpha_f"] - (v + a * w) / u + symbols["delta_f"]) == 0


def test_paper_is_printed_with_the_axle_accelerating_the_other_way() -> None:
    """(5) and (7) verbatim with -delta_c'' in (9), seen in the opposite sense of delta_c."""
    turned = {delta_c: -delta_c, sp.Symbol("delta_z"): -sp.Symbol("delta_z"), ddelta_c: -ddelta_c}
    mass, right = _mechanical(MODELS["printed"])
    paper_mass, paper_right = _mechanical(MODELS["paper"])
    assert _zero(right.subs(turned, simultaneous=True) - paper_right)
    assert mass == paper_mass


def test_printed_state_space_has_another_a2_only() -> None:
    dv, dw, dd = sp.symbols("dv dw d2delta_c")
    forces = sp.Matrix(sp.symbols("F_f F_r F_d"))
    X = e * (c - e) * m_c - I_cs
    nine = sp.Matrix(racs.newton(slip_sign=-1).equations)
    twelve = sp.Matrix(racs.state_space(slip_sign=-1).equations)
    # eliminating delta_c'' from (9) gives (10)
    eliminated = [nine[2] / X - nine[0] / (e * m_c), nine[2] / X - nine[1] / (e * (b - c) * m_c)]
    assert _zero(sp.Matrix(eliminated) - sp.Matrix(twelve[:2]))
    # and so (11) should follow, but A_2 is another
    a_2 = -sp.Matrix([twelve[2]]).jacobian([dv, dw])
    derived = -sp.Matrix([nine[2] / X]).jacobian([dv, dw])
    assert _zero(derived - sp.Matrix([[-(c - e) * m_c, (c - e) * (b - e) * m_c + I_cs]]) / X)
    assert _zero(a_2 - sp.Matrix([[-e * m_c, e * (b - c + e) * m_c + I_cs]]) / X)
    assert _zero(sp.Matrix([twelve[2] - nine[2] / X]).jacobian(forces))
    assert sp.diff(twelve[2], dd) == 1


def test_lagrange_differs_from_nine_as_model_md_says() -> None:
    dd = sp.Symbol("d2delta_c")
    nine, bodies = racs.newton(slip_sign=-1), racs.multibody()
    extra = m_c * (u * w - c * dd) * sp.Matrix([1, b - c, c - e])
    assert _zero(sp.Matrix(bodies.equations) - sp.Matrix(nine.equations) - extra)
    assert sp.expand(bodies.alpha_r - nine.alpha_r + c * ddelta_c / u) == 0


def test_lagrange_follows_from_the_kinetic_energy() -> None:
    """Lagrange's equations in quasi-velocities, a second formalism, written out here."""
    eps, t = sp.symbols("eps t")
    F_f, F_r, F_d = sp.symbols("F_f F_r F_d")
    forward, v_t, w_t, delta = (sp.Function(name)(t) for name in ("forward", "v", "w", "delta"))
    spin = w_t + delta.diff(t)
    centre_x = forward + (c - e) * spin * sp.sin(delta)
    centre_y = v_t - (b - c) * w_t - (c - e) * spin * sp.cos(delta)
    energy = (m * (forward**2 + v_t**2) + I_z * w_t**2) / 2
    energy += (m_c * (centre_x**2 + centre_y**2) + I_cs * spin**2) / 2
    rate = delta.diff(t)
    lateral = energy.diff(v_t).diff(t) + w_t * energy.diff(forward) - (F_f + F_r)
    yaw = energy.diff(w_t).diff(t) + forward * energy.diff(v_t) - v_t * energy.diff(forward)
    yaw -= a * F_f - b * F_r
    steer = energy.diff(rate).diff(t) - energy.diff(delta) + c * F_r - (d - c) * F_d
    dv, dw, dd = sp.symbols("dv dw d2delta_c")
    rates = {rate.diff(t): eps * dd, v_t.diff(t): eps * dv, w_t.diff(t): eps * dw}
    small = {rate: eps * ddelta_c, forward.diff(t): 0}
    states = {v_t: eps * v, w_t: eps * w, delta: eps * delta_c, forward: u}

    def first_order(row: sp.Expr) -> sp.Expr:
        row = row.subs(rates).subs(small).subs(states)
        row = row.subs({F: eps * F for F in (F_f, F_r, F_d)})
        return sp.expand(row.diff(eps).subs(eps, 0))

    lateral, yaw, steer = (first_order(row) for row in (lateral, yaw, steer))
    expected = sp.Matrix([lateral, steer - yaw, -steer])
    assert _zero(sp.Matrix(racs.multibody().equations) - expected)


def test_magic_formula() -> None:
    x = sp.Symbol("x")
    tyre = sp.symbols("B C D E")
    force = racs.magic_formula(x, tyre)
    B, C, D, _ = tyre
    assert sp.simplify(force.diff(x).subs(x, 0) - B * C * D) == 0
    assert sp.simplify(force + force.subs(x, -x)) == 0
    front = force.subs(dict(zip(tyre, (6.64, 1.352, -5822, -1.999), strict=True)))
    values = sp.lambdify(x, front)(np.linspace(0.0, 1.0, 2001))
    assert values.min() == pytest.approx(-5822, rel=1e-6)  # D is the peak


# --- parameters and units -------------------------------------------------------------------


def test_every_parameter_is_documented_valid_and_used() -> None:
    model = MODELS["paper"]
    used = set().union(*(x.free_symbols for x in model.equations.values()))
    used |= model.mass.free_symbols | model.elements[0].law.free_symbols
    dimensionless = {"alpha", "gamma", "C_f", "E_f", "C_r", "E_r"}
    for parameter in model.parameters:
        assert parameter.description, parameter.name
        assert parameter.source, parameter.name
        assert bool(parameter.unit) != (parameter.name in dimensionless), parameter.name
        assert sp.Symbol(parameter.name) in used, parameter.name
        if not isinstance(parameter.default, Calibration):
            assert parameter.valid[0] < parameter.default < parameter.valid[1], parameter.name


def test_values_are_those_of_section_3_and_table_1() -> None:
    given = {p.name: p.default for p in MODELS["paper"].parameters}
    calibration = given.pop("A_h")
    assert given == {
        **{"u": 10.0, "delta_f": 0.01, "m": 1740.0, "I_z": 3048.0, "a": 1.46, "b": 1.54},
        **{"m_c": 100.0, "I_cs": 100.0, "e": 0.15, "d": 0.8, "c": 0.35},
        **{"tau_eps": 1.0, "tau_sig": 1.0, "alpha": 0.3, "gamma": 0.7, "E_0": 50000.0},
        **{"B_f": 6.64, "C_f": 1.352, "D_f": -5822.0, "E_f": -1.999},
        **{"B_r": 8.76, "C_r": 1.352, "D_r": -5920.0, "E_r": -1.7098},
    }
    assert isinstance(calibration, Calibration)
    assert (calibration.parameter, dict(calibration.hopf)) == ("C_s", {"u": 10.2})
    assert dict(calibration.options) == {"variant": "paper"}
    assert calibration.span[0] < C_S < calibration.span[1]


def test_stiffness_sets_the_shape_of_the_unit() -> None:
    (stiffness,) = MODELS["paper"].derived
    assert (stiffness.name, stiffness.sets) == ("C_s", "A_h")
    value = stiffness.expression.subs({"d": 0.8, "A_h": 0.741526625, "E_0": 0.5e5})
    assert float(value) == pytest.approx(C_S, rel=1e-9)


def _scale(unit: str) -> float:
    """Return the size of a unit in a system with other units of length, mass and time."""
    length, mass, time = 1.7, 0.6, 2.3
    base = {"m": length, "kg": mass, "s": time, "rad": 1.0, "1": 1.0, "": 1.0}
    base["N"] = mass * length / time**2
    base["Pa"] = base["N"] / length**2
    numerator, _, denominator = unit.partition("/")

    def product(text: str) -> float:
        factors = (factor.partition("^") for factor in text.split())
        return float(np.prod([base[name] ** int(power or 1) for name, _, power in factors]))

    return product(numerator) / product(denominator)


@pytest.mark.parametrize("variant", NAMES)
def test_units_balance(variant: str) -> None:
    """In other units of length, mass and time the same motion comes out, in those units."""
    model = MODELS[variant]
    values = Exact(variant).values | {"A_h": 0.7}
    state = {"v": 0.3, "w": -0.2, "delta_c": 0.02, "ddelta_c": 0.4, "delta_z": 0.03}
    units = {p.name: p.unit for p in model.parameters} | dict(model.units)
    order = (*values, *state)
    mass, right = model.mass, sp.Matrix(list(model.equations.values()))
    rates = sp.lambdify(sp.symbols(order), mass.LUsolve(right), cse=True)
    outputs = sp.lambdify(sp.symbols(order), list(model.outputs.values()), cse=True)
    law = sp.lambdify(sp.symbols((*values, "s")), model.elements[0].law)

    here = values | state
    there = {name: value * _scale(units[name]) for name, value in here.items()}
    rate_units = [_scale(units[name]) / _scale("s") for name in model.states]
    np.testing.assert_allclose(
        rates(*there.values())[:, 0], rates(*here.values())[:, 0] * rate_units, rtol=1e-12
    )
    np.testing.assert_allclose(
        outputs(*there.values()),
        np.multiply(outputs(*here.values()), [_scale(units[name]) for name in model.outputs]),
        rtol=1e-12,
    )
    parameters = [there[name] for name in values]
    assert law(*parameters, 2j / _scale("s")) == pytest.approx(law(*values.values(), 2j))
    stiffness = model.derived[0]
    product = np.prod([_scale(units[str(x)]) for x in stiffness.expression.free_symbols])
    assert product == pytest.approx(_scale(stiffness.unit))
    # outputs that are accelerations: a_y = v' + u w
    a_y = outputs(*here.values())[list(model.outputs).index("a_y")]
    assert a_y == pytest.approx(rates(*here.values())[0, 0] + values["u"] * state["w"])


def test_unknown_variant_names_the_nearest() -> None:
    with pytest.raises(UsageError, match=r"unknown variant 'restorng'.*'restoring'"):
        racs.model(variant="restorng")


@pytest.mark.parametrize("variant", NAMES)
def test_model_says_what_it_is(variant: str) -> None:
    model = MODELS[variant]
    assert model.variant == variant
    assert tuple(model.variants) == NAMES
    assert all(model.units[name] for name in (*model.states, *model.outputs))
    assert all(model.descriptions[name] for name in (*model.states, *model.outputs))
    told = " ".join(model.notes)
    assert "calibrated" in told
    assert "not passive" in told
    assert "'printed'" in told


def test_default_is_paper() -> None:
    assert racs.model() == MODELS["paper"]


# --- the exact model in numbers -------------------------------------------------------------


@pytest.mark.parametrize(("speed", "angle"), [(5.0, -0.0015083144), (30.0, -0.0072687)])
def test_equilibrium(speed: float, angle: float) -> None:
    assert Exact("paper", u=speed).equilibrium()[2] == pytest.approx(angle, rel=1e-6)


@pytest.mark.parametrize(
    ("changed", "speed", "omega"),
    [
        ({}, 10.2, 9.5200832),
        ({"C_s": 20000.0}, 4.5672697, 10.414023),
        ({"C_s": 40000.0}, 22.318792, 7.4845221),
        ({"alpha": 0.2}, 14.23821, 7.7314068),
        ({"alpha": 0.4}, 4.7922914, 12.550348),
        ({"gamma": 0.6}, 3.9916341, 12.99678),
        ({"m_c": 200.0}, 11.576326, 8.6582576),
        ({"c": 0.3}, 18.934671, 7.693726),
        ({"c": 0.4}, 5.831142, 11.027693),
        ({"delta_f": 0.08}, 10.308432, 9.4531972),
    ],
)
def test_exact_hopf_point(changed: dict[str, float], speed: float, omega: float) -> None:
    found = Exact("paper", **changed).hopf(speed * 1.02, omega * 0.98)
    assert found == pytest.approx((speed, omega), rel=2e-7)


def test_stability_changes_at_the_hopf_point() -> None:
    for speed, unstable in ((9.7, 0), (10.7, 2)):
        exact = Exact("paper", u=speed)
        assert exact.unstable(exact.equilibrium()) == pytest.approx(unstable, abs=1e-3)


@pytest.mark.parametrize("speed", [5.0, 10.2, 20.0, 30.0])
@pytest.mark.parametrize("stiffness", [5e2, 5e3, C_S, 1e5, 1e7])
def test_printed_has_one_real_unstable_root(speed: float, stiffness: float) -> None:
    exact = Exact("printed", u=speed, C_s=stiffness)
    x = exact.equilibrium()

    def real(log_s: float) -> float:
        return float(exact.det(np.exp(log_s), x)[0].real)

    unstable = np.exp(brentq(real, np.log(1e-9), np.log(1e9)))
    assert unstable > 0
    assert exact.unstable(x) == pytest.approx(1, abs=1e-3)


def test_printed_stays_unstable_where_a_pair_crosses() -> None:
    """Beyond the paper's range a pair joins the real root; the Hopf point is no onset."""
    exact = Exact("printed")
    speed, _ = exact.hopf(41.0, 7.7)
    assert speed > 30
    for exact.values["u"], unstable in ((speed - 4, 1), (speed + 4, 3)):
        assert exact.unstable(exact.equilibrium()) == pytest.approx(unstable, abs=1e-3)


@pytest.mark.parametrize("variant", ["restoring", "lagrange"])
def test_consistent_variants_diverge_and_do_not_shimmy(variant: str) -> None:
    """At the calibrated C_s: stable when slow, one real unstable root (no pair) when fast."""
    for speed, unstable in ((2.0, 0), (5.0, 0), (10.0, 0), (20.0, 1), (30.0, 1)):
        exact = Exact(variant, u=speed)
        x = exact.equilibrium()
        assert exact.unstable(x) == pytest.approx(unstable, abs=1e-3)
        assert np.sign(exact.det(1e-300, x)[0].real) == (-1) ** unstable


def test_law_is_not_passive_at_low_frequency_and_has_unit_static_gain() -> None:
    exact = Exact("paper")
    p = list(exact.values.values())
    assert exact.law(0.0, p) == 1.0
    bound = brentq(lambda omega: exact.law(1j * omega, p).imag, 0.05, 0.2)
    assert bound == pytest.approx(0.0921, abs=5e-5)
    assert f"{bound:.4f} rad/s" in " ".join(MODELS["paper"].notes)
