"""The standard problems of equilibria, to the digits known of them (MatCont, AUTO, BifurcationKit).

The numbers come from 80-digit Newton iterations on defining systems, checked against what those
programs publish. c1 is MatCont's normalisation of the first Lyapunov coefficient, l1 = c1 / omega.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import UsageError
from racs_bif.shelf.load import system_of
from racs_bif.verbs.curves import continue_curve

RTOL = 1e-8
COEFFICIENT = 1e-7
Z = "(1-x-y-s)"


def build(name, equations, parameters, guess):
    return rb.model_from_strings(name, equations, parameters=parameters, guess=guess)


def only(branch, label):
    return [point for point in branch.special if point.label == label]


def places(branch, label, *names):
    """Return the parameters of all points of a kind, in their order along the branch."""
    return np.array([[point.parameters[name] for name in names] for point in only(branch, label)])


def assert_same_points(found, expected, rtol=RTOL, atol=0.0):
    """Compare sets of points, in whatever order."""
    found, expected = np.atleast_2d(found), np.atleast_2d(expected)
    assert found.shape == expected.shape
    order = np.argsort
    np.testing.assert_allclose(
        found[order(found[:, 0] + 1e-3 * found[:, -1])],
        expected[order(expected[:, 0] + 1e-3 * expected[:, -1])],
        rtol=rtol,
        atol=atol,
    )


def near(points, name, value):
    """Return the point whose parameter is nearest to a value."""
    return min(points, key=lambda point: abs(point.parameters[name] - value))


@pytest.fixture(scope="module")
def adaptive():
    return build(
        "adaptive",
        {"x": "y", "y": "z", "z": "-al*z-be*y-x+x**2"},
        {"al": 1.5, "be": 1.0},
        {"x": 0.1, "y": 0.0, "z": 0.0},
    )


@pytest.fixture(scope="module")
def oxidation():
    model = build(
        "CO oxidation",
        {
            "x": f"2*q1*{Z}**2-2*q5*x**2-q3*x*y",
            "y": f"q2*{Z}-q6*y-q3*x*y",
            "s": f"q4*({Z}-k*s)",
        },
        {"q1": 2.5, "q2": 1.0, "q3": 10.0, "q4": 0.0675, "q5": 1.0, "q6": 0.1, "k": 0.4},
        {"x": 0.001, "y": 0.3, "s": 0.4},
    )
    return rb.continue_equilibria(model, "q2", (0.5, 2.0))


@pytest.fixture(scope="module")
def lorenz84():
    model = build(
        "Lorenz-84",
        {
            "X": "-Y**2-Z**2-al*X+al*F-ga*U**2",
            "Y": "X*Y-be*X*Z-Y+G",
            "Z": "be*X*Y+X*Z-Z",
            "U": "-de*U+ga*U*X+T",
        },
        {"al": 0.25, "be": 1.0, "G": 0.25, "de": 1.04, "ga": 0.987, "T": 0.04, "F": 2.0},
        {"X": 1.1, "Y": 0.0, "Z": 0.2, "U": -0.4},
    )
    return rb.continue_equilibria(model, "F", (1.0, 3.5))


@pytest.fixture(scope="module")
def cstr():
    model = build(
        "CSTR",
        {"x": "-.9+.4*be-(1+la)*x+la*(10-9*be+ga)/(1+la*(10-9*be)*exp(-3*x/(1+x)))"},
        {"la": 1.0, "be": 0.0, "ga": 0.0},
        {"x": -0.9},
    )
    return rb.continue_equilibria(model, "la", (0.1, 3.0))


@pytest.fixture(scope="module")
def vehicle():
    return rb.load_model("racs")


@pytest.fixture(scope="module")
def shimmy(vehicle):
    return rb.continue_equilibria(vehicle, "u", (5.0, 30.0))["H1"]


def test_adaptive_control(adaptive):
    hopf = rb.continue_equilibria(adaptive, "al", (0.2, 2.0))["H1"]
    assert hopf.parameters["al"] == pytest.approx(1.0, rel=1e-11)
    assert hopf.omega == pytest.approx(1.0, rel=1e-11)
    assert hopf.c1 == pytest.approx(-0.3, rel=1e-10)
    assert hopf.criticality == "supercritical"


def test_oxidation_points(oxidation):
    hopf, folds = only(oxidation, "H"), only(oxidation, "LP")
    first, second = near(hopf, "q2", 1.0516), near(hopf, "q2", 1.0410)
    assert len(hopf) == len(folds) == 2
    assert first.parameters["q2"] == pytest.approx(1.05155746245773, rel=RTOL)
    assert second.parameters["q2"] == pytest.approx(1.04099156953262, rel=RTOL)
    assert first.omega == pytest.approx(0.0507403448967863, rel=RTOL)
    assert second.omega == pytest.approx(0.0591061479357754, rel=RTOL)
    assert first.c1 == pytest.approx(10.7010196344545, rel=COEFFICIENT)
    assert second.c1 == pytest.approx(4.33137897821287, rel=COEFFICIENT)
    low, high = near(folds, "q2", 1.042), near(folds, "q2", 1.0522)
    assert low.parameters["q2"] == pytest.approx(1.04204850537853, rel=RTOL)
    assert high.parameters["q2"] == pytest.approx(1.05220028786995, rel=RTOL)
    assert abs(low.a) == pytest.approx(0.116659346880737, rel=COEFFICIENT)
    assert abs(high.a) == pytest.approx(0.134650516123924, rel=COEFFICIENT)


TAKENS = {
    1.41762763760065: (0.971397573485313, 0.0837844414228633, 2.13627992511679),
    1.16119870882174: (0.722339072522229, 0.0482256452439326, 1.93763256962812),
}


def assert_takens(branch):
    found = only(branch, "BT")
    assert len(found) == len(TAKENS)
    for q2, (k, a, b) in TAKENS.items():
        point = near(found, "q2", q2)
        assert point.parameters["q2"] == pytest.approx(q2, rel=RTOL)
        assert point.parameters["k"] == pytest.approx(k, rel=RTOL)
        assert abs(point.a) == pytest.approx(a, rel=COEFFICIENT)
        assert abs(point.b) == pytest.approx(b, rel=COEFFICIENT)
    # The relative sign of a and b does not depend on that of the eigenvector.
    assert all(point.a * point.b > 0.0 for point in found)


def test_oxidation_folds(oxidation):
    curve = continue_curve(oxidation["LP1"], ("q2", "k"), ((0.5, 2.0), (0.1, 1.5)))
    assert_same_points(places(curve, "CP", "q2", "k"), [1.00640832967832, 0.355991273208677])
    assert abs(curve["CP1"].c) == pytest.approx(0.362788656889451, rel=COEFFICIENT)
    assert_takens(curve)
    assert not curve.early


@pytest.mark.parametrize("start", ["H1", "H2"])
def test_oxidation_hopf(oxidation, start):
    curve = continue_curve(oxidation[start], ("q2", "k"), ((0.5, 2.0), (0.1, 1.5)))
    assert_takens(curve)
    expected = [[0.891318980774319, 0.232487354203037], [0.924255015218579, 0.305879267477929]]
    assert_same_points(places(curve, "GH", "q2", "k"), expected)
    found = only(curve, "GH")
    assert near(found, "q2", 0.8913).l2 == pytest.approx(-776.900344, rel=1e-6)
    assert near(found, "q2", 0.9243).l2 == pytest.approx(-240.123388, rel=1e-6)
    # Between the two Bogdanov-Takens points the curve is one of neutral saddles, beyond not.
    q2 = curve.column("q2")
    takens = [point.index for point in only(curve, "BT")]
    neutral = curve.column("neutral").astype(bool)
    inside = np.zeros(len(curve), dtype=bool)
    inside[min(takens) + 1 : max(takens)] = True
    outside = ~inside
    outside[takens] = False
    assert neutral[outside].all() or neutral[inside].all()
    assert not (neutral[outside].all() and neutral[inside].all())
    assert np.isnan(curve.column("omega")[neutral]).all()
    assert np.isfinite(q2).all()


def test_lorenz84_points(lorenz84):
    hopf = only(lorenz84, "H")
    expected = {
        2.85987541274829: (1.1715226466894, 0.303845582),
        2.46722212311275: (0.723205920022479, -0.134874605),
        1.61965782094258: (0.295286816712987, 0.864734632),
    }
    assert len(hopf) == len(expected)
    for F, (omega, c1) in expected.items():
        point = near(hopf, "F", F)
        assert point.parameters["F"] == pytest.approx(F, rel=RTOL)
        assert point.omega == pytest.approx(omega, rel=RTOL)
        assert point.c1 == pytest.approx(c1, rel=1e-7)
    assert_same_points(places(lorenz84, "LP", "F"), [[1.54664837259813]])


def test_lorenz84_curves(lorenz84):
    spans = ((0.5, 4.0), (-0.1, 0.1))
    folds = continue_curve(lorenz84["LP1"], ("F", "T"), spans)
    takens = [[1.44671670111536, 0.0209401696833226], [1.44671670111536, -0.0209401696833226]]
    zero_hopf = [
        [1.28341929613827, 0.000126540834120498],
        [1.28341929613827, -0.000126540834120498],
    ]
    assert_same_points(places(folds, "BT", "F", "T"), takens)
    assert_same_points(places(folds, "ZH", "F", "T"), zero_hopf, atol=1e-12)
    for point in only(folds, "BT"):
        assert abs(point.a) == pytest.approx(0.214423350927347, rel=COEFFICIENT)
        assert abs(point.b) == pytest.approx(0.606514551828087, rel=COEFFICIENT)


def test_lorenz84_hopf_curve_finds_what_the_fold_curve_finds(lorenz84):
    spans = ((0.5, 4.0), (-0.1, 0.1))
    point = near(only(lorenz84, "H"), "F", 1.6197)
    curve = continue_curve(point, ("F", "T"), spans)
    folds = continue_curve(lorenz84["LP1"], ("F", "T"), spans)
    assert_same_points(places(curve, "BT", "F", "T"), places(folds, "BT", "F", "T"))
    at_hopf = continue_curve(only(folds, "ZH")[0], ("F", "T"), spans)
    assert_same_points(places(at_hopf, "ZH", "F", "T"), places(folds, "ZH", "F", "T"), atol=1e-12)


def test_neural_mass():
    model = build(
        "neural mass",
        {
            "E": "(-E+a*log(1+exp((J*u*x*E+E0)/a)))/tE",
            "x": "(1-x)/tD-u*x*E",
            "u": "(U0-u)/tF+U0*(1-u)*E",
        },
        {"tE": 0.013, "J": 3.07, "tD": 0.2, "U0": 0.3, "tF": 1.5, "a": 1.5, "E0": -2.0},
        {"E": 0.24, "x": 0.98, "u": 0.37},
    )
    branch = rb.continue_equilibria(model, "E0", (-3.0, 0.0))
    assert_same_points(places(branch, "LP", "E0"), [[-1.46302732554269], [-1.86522391033905]])
    assert_same_points(places(branch, "H", "E0"), [[-1.85012459476756], [-1.15105939691867]])
    hopf = only(branch, "H")
    assert near(hopf, "E0", -1.85).omega == pytest.approx(1.99984792947854, rel=RTOL)
    assert near(hopf, "E0", -1.15).omega == pytest.approx(19.3650354034982, rel=RTOL)
    assert near(hopf, "E0", -1.15).c1 == pytest.approx(0.02605640481, rel=1e-6)


@pytest.mark.parametrize(("start", "label"), [("H1", "Hopf curve"), ("LP1", "fold curve")])
def test_bazykin(start, label):
    model = build(
        "Bazykin",
        {"x": "x-x*y/(1+al*x)-ep*x**2", "y": "-ga*y+x*y/(1+al*x)-de*y**2"},
        {"al": 0.3, "ga": 1.0, "ep": 0.01, "de": 0.2},
        {"x": 3.0, "y": 2.0},
    )
    branch = rb.continue_equilibria(model, "al", (0.1, 0.6))
    curve = continue_curve(branch[start], ("al", "de"), ((0.1, 0.8), (0.05, 0.5)))
    assert curve.method == label
    assert_same_points(places(curve, "BT", "al", "de"), [0.453624327778129, 0.175127592950217])
    assert abs(curve["BT1"].a) == pytest.approx(0.0394530911236764, rel=COEFFICIENT)
    assert abs(curve["BT1"].b) == pytest.approx(0.0525387764928562, rel=COEFFICIENT)


@pytest.mark.parametrize("start", ["LP1", "LP2"])
def test_cstr(cstr, start):
    assert_same_points(places(cstr, "LP", "la"), [[1.25066935532444], [0.377651257908807]])
    curve = continue_curve(cstr[start], ("la", "be"), ((0.05, 4.0), (-1.0, 1.0)))
    cusps = [[1.96896591817757, -0.0906549454141988], [0.405523952498799, 0.608092579156656]]
    assert_same_points(places(curve, "CP", "la", "be"), cusps)


def test_two_box_bratu():
    model = build(
        "Bratu, two boxes",
        {"x": "-2*x+y+a*exp(x)", "y": "x-2*y+a*exp(y)"},
        {"a": 0.01},
        {"x": 0.0, "y": 0.0},
    )
    branch = rb.continue_equilibria(model, "a", (0.01, 0.5))
    assert_same_points(places(branch, "LP", "a"), [[1.0 / math.e]])
    assert_same_points(places(branch, "BP", "a"), [[3.0 * math.exp(-3.0)]])
    # At 2 exp(-2) two real eigenvalues have zero sum: a neutral saddle, not a Hopf point.
    assert not only(branch, "H")
    assert branch["BP1"].kind == "pitchfork"


def test_one_dimensional_bratu():
    # Chebyshev collocation converges faster than any power: 14 points leave 1e-10.
    count = 14
    x = np.cos(np.pi * np.arange(count + 1) / count)
    weights = np.where((np.arange(count + 1) % count) == 0, 2.0, 1.0) * (-1.0) ** np.arange(
        count + 1
    )
    first = np.outer(weights, 1.0 / weights) / (x[:, None] - x[None, :] + np.eye(count + 1))
    first -= np.diag(first.sum(axis=1))
    second = (4.0 * first @ first)[1:-1, 1:-1]
    names = [f"u{k}" for k in range(count - 1)]
    equations = {
        name: "+".join(f"({float(c)!r})*{other}" for c, other in zip(row, names, strict=True))
        + f"+la*exp({name})"
        for name, row in zip(names, second, strict=True)
    }
    model = build("Bratu", equations, {"la": 1.0}, dict.fromkeys(names, 0.0))
    branch = rb.continue_equilibria(model, "la", (0.5, 4.0))
    assert_same_points(places(branch, "LP", "la"), [[3.513830719125161]])


def test_fitzhugh_nagumo():
    model = build(
        "FitzHugh-Nagumo",
        {"v": "v-v**3/3-w+I", "w": ".08*(v+.7-.8*w)"},
        {"I": 0.0},
        {"v": -1.0, "w": -0.5},
    )
    branch = rb.continue_equilibria(model, "I", (0.0, 2.0))
    assert_same_points(places(branch, "H", "I"), [[0.331281337454746], [1.41871866254525]])
    for point in only(branch, "H"):
        assert point.omega == pytest.approx(0.275506805723561, rel=RTOL)
        assert point.c1 == pytest.approx(0.267784648, rel=1e-7)


def test_lorenz():
    equations = {"x": "s*(y-x)", "y": "r*x-y-x*z", "z": "x*y-b*z"}
    parameters = {"s": 10.0, "r": 0.5, "b": 8.0 / 3.0}
    trivial = build("Lorenz", equations, parameters, {"x": 0.0, "y": 0.0, "z": 0.0})
    branch = rb.continue_equilibria(trivial, "r", (0.5, 30.0))
    assert_same_points(places(branch, "BP", "r"), [[1.0]])
    outer = build("Lorenz", equations, parameters | {"r": 20.0}, {"x": 7.0, "y": 7.0, "z": 18.0})
    hopf = only(rb.continue_equilibria(outer, "r", (5.0, 30.0)), "H")
    assert len(hopf) == 1
    assert hopf[0].parameters["r"] == pytest.approx(470.0 / 19.0, rel=1e-10)
    assert hopf[0].criticality == "subcritical"


def test_brusselator():
    model = build(
        "Brusselator",
        {"x": "A-(B+1)*x+x**2*y", "y": "B*x-x**2*y"},
        {"A": 1.0, "B": 1.5},
        {"x": 1.0, "y": 1.0},
    )
    hopf = rb.continue_equilibria(model, "B", (0.5, 4.0))["H1"]
    assert hopf.parameters["B"] == pytest.approx(2.0, rel=1e-10)
    assert hopf.omega == pytest.approx(1.0, rel=1e-10)
    assert hopf.c1 == pytest.approx(-0.5, rel=1e-10)
    # The curve is known: B = 1 + A^2, omega = A.
    curve = continue_curve(hopf, ("A", "B"), ((0.2, 2.0), (0.5, 6.0)))
    A, B = curve.values.T
    np.testing.assert_allclose(B, 1.0 + A**2, rtol=1e-10)
    np.testing.assert_allclose(curve.column("omega"), A, rtol=1e-9)
    np.testing.assert_allclose(A[[0, -1]], [0.2, 2.0], rtol=0, atol=0)
    assert not curve.special


PLANES = {
    "C_s": ((3.0, 100.0), (1e4, 8e4)),
    "c": ((3.0, 100.0), (0.1, 0.6)),
    "delta_f": ((3.0, 100.0), (-0.3, 0.3)),
}


def vertex(x, y, k):
    """Return the extremum of the parabola through three points of a curve."""
    place = np.polynomial.Polynomial.fit(x[k - 2 : k + 3], y[k - 2 : k + 3], 4)
    roots = place.deriv().roots()
    root = roots[np.argmin(np.abs(roots - x[k]))].real
    return root, place(root)


@pytest.fixture(scope="module")
def planes(shimmy):
    """Hopf curves of the vehicle by the second parameter and the operator."""
    return {
        (name, operator): continue_curve(shimmy, ("u", name), spans, operator=operator)
        for name, spans in PLANES.items()
        for operator in ("exact", "realised")
    }


def test_vehicle_exact_curve_passes_the_known_points(shimmy):
    known = {
        20000.0: (4.5672697, 10.414023),
        35000.0: (15.81316, 8.3598728),
        40000.0: (22.318792, 7.4845221),
    }
    for C_s, (u, omega) in known.items():
        # A span that ends at the wanted stiffness ends the curve exactly there.
        spans = ((3.0, 60.0), (min(C_s, 29000.0), max(C_s, 30000.0)))
        curve = continue_curve(shimmy, ("u", "C_s"), spans, operator="exact")
        k = int(np.argmin(np.abs(curve.values[:, 1] - C_s)))
        assert curve.values[k, 1] == C_s
        assert curve.values[k, 0] == pytest.approx(u, rel=1e-7)
        assert curve.column("omega")[k] == pytest.approx(omega, rel=1e-7)


@pytest.mark.parametrize(
    ("name", "value", "u", "omega"),
    [
        ("c", 0.30, 18.934671, 7.693726),
        ("c", 0.40, 5.831142, 11.027693),
        ("delta_f", 0.08, 10.308432, 9.4531972),
        ("m_c", 30.0, 9.3015361, 10.198924),
        ("m_c", 200.0, 11.576326, 8.6582576),
        ("alpha", 0.2, 14.23821, 7.7314068),
        ("alpha", 0.4, 4.7922914, 12.550348),
        ("gamma", 0.6, 3.9916341, 12.99678),
        ("gamma", 0.8, 15.266725, 7.2073304),
    ],
)
def test_vehicle_exact_curves_in_other_parameters(vehicle, shimmy, name, value, u, omega):
    own = vehicle.parameters[name]
    span = (min(value, 0.99 * own), max(value, 1.01 * own))
    curve = continue_curve(shimmy, ("u", name), ((3.0, 60.0), span), operator="exact")
    k = int(np.argmin(np.abs(curve.values[:, 1] - value)))
    assert curve.values[k, 1] == value
    assert curve.values[k, 0] == pytest.approx(u, rel=1e-7)
    assert curve.column("omega")[k] == pytest.approx(omega, rel=1e-7)


def test_vehicle_turning_points(planes):
    curve = planes["C_s", "exact"]
    u, C_s = curve.values.T
    at, top = vertex(u, C_s, int(np.argmax(C_s)))
    assert top == pytest.approx(5.16612e4, rel=2e-6)
    assert at == pytest.approx(61.0, abs=0.5)
    u, c = planes["c", "exact"].values.T
    at, bottom = vertex(u, c, int(np.argmin(c)))
    assert bottom == pytest.approx(0.2297, abs=5e-5)
    assert at == pytest.approx(68.0, abs=0.5)
    u, delta_f = planes["delta_f", "exact"].values.T
    for k in (int(np.argmax(delta_f)), int(np.argmin(delta_f))):
        assert abs(vertex(u, delta_f, k)[1]) == pytest.approx(0.182, abs=5e-4)


def test_vehicle_curves_are_smooth_shimmy_throughout(planes):
    for curve in planes.values():
        assert not curve.early
        assert not curve.special
        assert (curve.column("l1") < 0.0).all()
        assert (curve.column("omega") > 0.0).all()
        assert curve.kind == "curve"


def test_vehicle_realised_curve_is_near_the_exact_one(planes):
    exact, realised = planes["C_s", "exact"], planes["C_s", "realised"]
    lower = slice(0, int(np.argmax(exact.values[:, 1])))
    u, C_s = exact.values[lower].T
    rising = slice(0, int(np.argmax(realised.values[:, 1])))
    between = np.interp(u[5:-5], *realised.values[rising].T)
    np.testing.assert_allclose(between, C_s[5:-5], rtol=2e-3)


@pytest.mark.parametrize("operator", ["exact", "realised"])
def test_vehicle_arm_and_mass(vehicle, operator):
    fast = vehicle.with_parameters({"u": 20.0})
    hopf = rb.continue_equilibria(fast, "c", (0.2, 0.4))["H1"]
    assert hopf.exact.parameters["c"] == pytest.approx(0.29558, abs=1e-5)
    curve = continue_curve(hopf, ("c", "m_c"), ((0.05, 0.6), (5.0, 400.0)), operator=operator)
    c, m_c = curve.values.T
    assert np.interp(100.0, m_c, c) == pytest.approx(0.29558, abs=1e-4)
    assert m_c[[0, -1]].tolist() == [5.0, 400.0]
    assert not curve.special
    assert (curve.column("l1") < 0.0).all()


def test_a_curve_that_a_point_cannot_give_is_refused(oxidation, shimmy):
    with pytest.raises(UsageError, match=r"LP, CP, BT, ZH"):
        continue_curve(shimmy, ("u", "C_s"), kind="fold")
    with pytest.raises(UsageError, match=r"H, GH, BT, ZH, HH"):
        continue_curve(oxidation["LP1"], ("q2", "k"), kind="hopf")
    with pytest.raises(UsageError, match="these can: HH"):
        continue_curve(shimmy, ("u", "C_s"), kind="hopf2")
    with pytest.raises(UsageError, match="unknown kind of curve"):
        continue_curve(shimmy, ("u", "C_s"), kind="lcp")
    with pytest.raises(UsageError, match="a lpc curve cannot start at H1"):
        continue_curve(shimmy, ("u", "C_s"), kind="lpc")
    with pytest.raises(UsageError, match="two different parameters"):
        continue_curve(shimmy, ("u", "u"))


def test_guesses_need_not_be_equilibria(adaptive):
    system = system_of(adaptive)
    x = system.equilibrium()
    assert np.abs(system.field.f(x, system.values)).max() < 1e-12
