"""Certificates of branches: the vehicle's hold, and whatever is tampered with is caught."""

from dataclasses import replace

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import ModelError, UsageError
from racs_bif.fractional.fitted import Fitted
from racs_bif.verbs.rebuild import rebuild

BRUSSELATOR = """
import sympy as sp

from racs_bif import Model, Parameter


def model():
    A, B, x, y = sp.symbols("A B x y")
    return Model(
        name="brusselator",
        equations={"x": A - (B + 1) * x + x**2 * y, "y": B * x - x**2 * y},
        parameters=(Parameter("A", 1.0), Parameter("B", 1.5)),
        guess={"x": 1.0, "y": 1.5},
    )
"""


@pytest.fixture(scope="module")
def branch():
    return rb.continue_equilibria(rb.load_model("racs"), "u", (9, 12))


@pytest.fixture(scope="module")
def spun_out():
    """The branch of spun-out equilibria with the fold near u = 20.888."""
    diagram = rb.all_equilibria(rb.load_model("racs"), "u", (5, 30))
    return next(b for b in diagram if any(_is_the_fold(p) for p in b.special))


def _is_the_fold(point):
    return point.label == "LP" and abs(point.parameters["u"] - 20.888) < 0.01


@pytest.fixture(scope="module")
def strings():
    equations = {"x": "A-(B+1)*x+x**2*y", "y": "B*x-x**2*y"}
    numbers = {"A": 1.0, "B": 1.5}
    guess = {"x": 1.0, "y": 1.5}
    return rb.model_from_strings("brusselator", equations, parameters=numbers, guess=guess)


def failure(certificate):
    assert not certificate.holds
    return " | ".join(f"{c.subject} {c.strength}: {c.finding}" for c in certificate.failures)


def test_the_vehicles_branch_is_proved(branch):
    found = rb.certify(branch, "proof")
    assert found.holds
    assert {(c.subject, c.strength) for c in found.checks} == {
        *(("H1", strength) for strength in ("newton", "complete", "proof")),
        ("EQ1", "complete"),
    }
    (newton,) = found.of("H1", "newton")
    assert newton.numbers["value"] == pytest.approx(10.2, abs=1e-9)
    assert newton.numbers["shift"] < 1e-3
    assert newton.numbers["correction"] < 1e-10
    (complete,) = found.of("H1", "complete")
    assert (complete.numbers["before"], complete.numbers["after"]) == (0, 2)
    (proof,) = found.of("H1", "proof")
    u = proof.box["u"]
    assert u.centre - u.radius < 10.2 < u.centre + u.radius
    assert u.radius > 5e-3
    assert u.upper - u.lower < 1e-13
    assert (u.lower, u.upper) == pytest.approx((10.2, 10.2), abs=1e-9)
    assert set(proof.box) == {*branch.system.states, "u", "omega", "delta_z"}
    table = found.to_dataframe()
    assert list(table["strength"]) == ["newton", "complete", "complete", "proof"]


def test_the_fold_of_the_spun_out_branch_is_proved(spun_out):
    found = rb.certify(spun_out, "proof")
    assert found.holds
    (fold,) = (p for p in spun_out.special if p.label == "LP")
    (proof,) = found.of(fold.name, "proof")
    assert proof.interval[0] < 20.88823168 < proof.interval[1]
    assert proof.box["u"].lower == pytest.approx(20.8882316795, abs=1e-9)
    assert "omega" not in proof.box


def test_a_wrong_stability_is_caught(branch):
    unstable = branch.unstable.copy()
    unstable[3:5] = 2
    text = failure(rb.certify(replace(branch, unstable=unstable)))
    low, high = sorted(branch.parameter[3:5])
    assert f"from u = {low:.7g} to {high:.7g}: reported" in text
    assert "with 2 unstable roots, the exact model has 0" in text
    stable = branch.stable.copy()
    stable[3] = False
    found = rb.certify(replace(branch, stable=stable))
    assert "reported unstable with 0 unstable roots" in failure(found)
    assert found.failures[0].interval == (branch.parameter[3], branch.parameter[3])
    unknown = branch.unstable.copy()
    unknown[3] = -1
    assert "no stability is reported" in failure(rb.certify(replace(branch, unstable=unknown)))


def test_a_wrong_stability_beside_a_special_point_is_told_there(branch):
    unstable = np.where(branch.unstable == 2, 1, branch.unstable)
    found = rb.certify(replace(branch, unstable=unstable))
    (sides,) = found.of("H1", "complete")
    assert not sides.holds
    assert "2 exact unstable roots after it, 1 reported" in sides.finding


def test_a_missing_special_point_is_caught(branch):
    found = rb.certify(replace(branch, special=(), labels=("",) * len(branch)))
    assert "goes from 0 to 2, where no special point is reported" in failure(found)
    missing = next(f for f in found.failures if "no special point is reported" in f.finding)
    assert missing.interval[0] < 10.2 <= missing.interval[1]


def test_a_special_point_of_the_wrong_kind_is_caught(branch):
    hopf = branch["H1"]
    fold = replace(hopf, label="LP", name="LP1", exact=None)
    text = failure(rb.certify(replace(branch, special=(fold,))))
    assert "LP1 newton" in text
    assert "goes from 0 to 2, as LP1 does not explain" in text


@pytest.mark.parametrize(("u", "omega"), [(11.5, 9.52), (10.4, 9.3), (10.2, 5.0)])
def test_a_wrong_hopf_point_is_refused(branch, u, omega):
    hopf = branch["H1"]
    wrong = replace(hopf, parameters={"u": u}, data=dict(hopf.data) | {"omega": omega}, exact=None)
    found = rb.certify(replace(branch, special=(wrong,)), "proof")
    (newton,) = found.of("H1", "newton")
    assert not newton.holds
    assert "no exact Hopf point" in newton.finding or "is elsewhere" in newton.finding
    assert not found.of("H1", "proof")


def test_a_wrong_exact_point_is_refused(branch):
    hopf = branch["H1"]
    exact = replace(hopf.exact, parameters={"u": 10.201})
    found = rb.certify(replace(branch, special=(replace(hopf, exact=exact),)), "newton")
    assert "reported exact u = 10.201" in failure(found)


def test_a_hopf_point_without_frequency_or_place_is_refused(branch):
    hopf = branch["H1"]
    for wrong, words in (
        (replace(hopf, data={}), "without a frequency"),
        (replace(hopf, index=-1), "is not reported"),
    ):
        assert words in failure(rb.certify(replace(branch, special=(wrong,)), "newton"))


def test_a_coarse_realisation_is_told_so():
    system = rb.load_model("racs", realisation="oustaloup", band=(0.1, 100.0), order=2)
    branch = rb.continue_equilibria(system, "u", (5, 15))
    found = rb.certify(branch, "newton", tolerance=1e-6)
    assert "use a finer realisation" in failure(found)


def test_a_realisation_that_is_off_is_not_blamed_between_its_point_and_the_exact_one():
    system = rb.load_model("racs", realisation="diffusive", band=(3.0, 30.0), order=5)
    hopf = rb.continue_equilibria(system, "u", (9, 12))["H1"]
    assert abs(hopf.exact.shift["u"]) > 1e-5
    between = 0.5 * (hopf.parameters["u"] + hopf.exact.parameters["u"])
    branch = rb.continue_equilibria(system, "u", (9, 12), at=(between,))
    assert rb.certify(branch, tolerance=0.1).holds
    assert "where no special point" in failure(rb.certify(replace(branch, special=())))


def test_files_are_certified_bit_for_bit(branch, tmp_path):
    path = rb.save(branch, tmp_path / "eq.nc")
    loaded = rb.load(path)
    assert loaded["H1"].origin is None
    again = rebuild(loaded)
    assert again.settings == rebuild(branch).settings
    assert np.array_equal(again.values, rebuild(branch).values)
    assert rb.certify(path, "proof") == rb.certify(branch, "proof")


def test_every_setting_of_a_realisation_comes_back(tmp_path):
    settings = Fitted(band=(1.0, 60.0), order=9, omega=9.5, spread=5.0)
    branch = rb.continue_equilibria(rb.load_model("racs", realisation=settings), "u", (9, 12))
    assert rebuild(rb.load(rb.save(branch, tmp_path / "eq.nc"))).settings == settings


def test_other_parameters_and_variants_come_back(tmp_path):
    system = rb.load_model("racs", variant="restoring", parameters={"c": 0.3, "alpha": 0.35})
    branch = rb.continue_equilibria(system, "u", (5, 8))
    again = rebuild(rb.load(rb.save(branch, tmp_path / "eq.nc")))
    assert again.variant == "restoring"
    assert again.parameters == system.parameters
    assert rb.certify(tmp_path / "eq.nc").holds


def test_an_integer_order_model_of_a_file_is_certified(tmp_path):
    file = tmp_path / "mine.py"
    file.write_text(BRUSSELATOR)
    branch = rb.continue_equilibria(rb.load_model(str(file)), "B", (1.5, 3))
    path = rb.save(branch, tmp_path / "eq.nc")
    found = rb.certify(path, "proof")
    assert found.holds
    (proof,) = found.of("H1", "proof")
    assert proof.box["B"].lower <= 2.0 <= proof.box["B"].upper
    assert proof.box["omega"].lower <= 1.0 <= proof.box["omega"].upper
    file.write_text(BRUSSELATOR.replace("(B + 1)", "(B + 2)"))
    with pytest.raises(ModelError, match="equations of model 'brusselator' are not those"):
        rb.certify(path)
    file.unlink()
    with pytest.raises(UsageError, match="no file"):
        rb.certify(path)


def test_a_model_made_in_python_has_to_be_given(strings, tmp_path):
    branch = rb.continue_equilibria(strings, "B", (1.5, 3))
    assert rb.certify(branch).holds
    path = rb.save(branch, tmp_path / "eq.nc")
    with pytest.raises(UsageError, match=r"was made in Python.*give the model"):
        rb.certify(path)
    assert rb.certify(path, model=strings).holds


def test_diagrams_are_certified_and_what_is_not_is_told(branch, spun_out):
    curve = replace(branch, kind="orbit", name="PO1", special=(), labels=("",) * len(branch))
    found = rb.certify(rb.Diagram(branch, spun_out, curve), "newton")
    assert {c.branch for c in found.checks} == {"EQ1", "EQ2"}
    assert found.notes == ("not certified, being no branches of equilibria: PO1",)
    with pytest.raises(UsageError, match="no branch of equilibria to certify"):
        rb.certify(curve)


def test_what_cannot_be_asked_for(branch):
    with pytest.raises(UsageError, match="did you mean 'proof'"):
        rb.certify(branch, "prof")
    with pytest.raises(UsageError, match="tolerance"):
        rb.certify(branch, tolerance=0.0)
