import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest

from racs_bif.errors import UsageError
from racs_bif.results.branch import Branch
from racs_bif.results.special import SpecialPoint


def test_special_points_are_found_by_name(branch):
    hopf = branch["H1"]
    assert hopf.omega == 9.5
    assert hopf.l1 == -1.25
    assert hopf.criticality == "supercritical"
    assert hopf.exact.parameters == {"u": 10.001}
    assert hopf.steps == 3


def test_a_wrong_name_is_answered_with_the_nearest(branch):
    with pytest.raises(UsageError, match="did you mean 'H1'"):
        branch["H11"]


def test_a_special_point_says_what_it_does_not_know(branch):
    with pytest.raises(AttributeError, match="no 'period'; it has: omega, l1"):
        _ = branch["H1"].period
    assert not hasattr(branch["UZ1"], "omega")


def test_none_is_left_out_and_numpy_scalars_become_plain(branch):
    data = branch["H1"].data
    assert "nothing" not in data
    assert type(data["omega"]) is float
    assert data["degenerate"] is False


def test_special_points_refuse_what_a_file_could_not_hold():
    with pytest.raises(TypeError, match="not dict"):
        SpecialPoint(label="H", name="H1", data={"inner": {"a": 1}})


def test_a_special_point_survives_pickling_and_copying(branch):
    hopf = replace(branch["H1"], origin=None)
    assert pickle.loads(pickle.dumps(hopf)) == hopf
    assert copy.deepcopy(hopf) == hopf


def test_origin_is_not_compared(branch):
    assert replace(branch["H1"], origin=None) == branch["H1"]


def test_comparison_sees_the_last_bit_and_takes_nan_for_equal(branch):
    assert branch == copy.deepcopy(branch)
    other = copy.deepcopy(branch)
    other.states[3, 1] = np.nextafter(other.states[3, 1], 1.0)
    assert other != branch


def test_at_returns_the_point_that_was_asked_for(branch):
    assert branch.at(u=12).name == "UZ1"
    assert branch.at(u=10.0).name == "H1"


@pytest.mark.parametrize(
    ("where", "message"),
    [
        ({"u": 13.0}, r"ask for it with at=\(13,\)"),
        ({"uu": 13.0}, "did you mean 'u'"),
    ],
)
def test_at_says_how_to_get_a_point_that_is_not_there(branch, where, message):
    with pytest.raises(UsageError, match=message):
        branch.at(**where)


def test_at_does_not_choose_between_two_points(branch):
    twin = replace(branch["UZ1"], name="UZ2")
    twice = replace(branch, special=(*branch.special, twin))
    with pytest.raises(UsageError, match="more than once: take one of UZ1, UZ2"):
        twice.at(u=12)


def test_columns_by_name(branch, orbit_branch):
    np.testing.assert_array_equal(branch.column("delta_c"), branch.states[:, 1])
    np.testing.assert_array_equal(branch.column("u"), branch.parameter)
    assert np.ptp(orbit_branch.column("period")) == 0
    with pytest.raises(UsageError, match="did you mean 'delta_c'"):
        branch.column("delta_d")


def test_dataframe_has_a_row_for_each_point(orbit_branch):
    table = orbit_branch.to_dataframe()
    assert len(table) == len(orbit_branch)
    assert {"u", "max delta_c", "period", "stable", "unstable", "label"} <= set(table.columns)
    assert list(table.loc[table.label == "UZ", "u"]) == [12.0]


def test_special_table_has_the_exact_point_beside(branch):
    table = branch.special_table().set_index("name")
    assert table.loc["H1", "u"] == 10.0
    assert table.loc["H1", "u exact"] == 10.001
    assert table.loc["H1", "criticality"] == "supercritical"


def test_columns_of_different_lengths_are_refused(branch):
    with pytest.raises(ValueError, match="columns are not all"):
        replace(branch, stable=branch.stable[:-1])
    with pytest.raises(ValueError, match="lack names"):
        replace(branch, state_names=("v",))


def test_results_cannot_be_changed_by_assignment(branch):
    with pytest.raises(AttributeError):
        branch.name = "EQ2"
    assert isinstance(branch, Branch)
    assert "EQ1: 29 points, u 5 to 30, special points: H1, UZ1" in repr(branch)


def test_rows_are_not_special_points(branch):
    with pytest.raises(UsageError, match=r"by its name, not by 3; take \.values\[3\] or \.column"):
        branch[3]


def test_results_of_different_kinds_are_not_the_same(branch, orbit_branch):
    profile = orbit_branch.profiles["NS1"]
    assert profile == replace(profile, times=profile.times.copy())
    assert profile != replace(profile, times=2.0 * profile.times)
    assert profile != "NS1"
    assert branch != orbit_branch["NS1"]
    exact = replace(branch["H1"], exact=None)
    assert exact != branch["H1"]


def test_a_list_in_the_data_of_a_special_point_is_an_array(branch):
    point = replace(branch["H1"], data={"residues": [1.0, 2.0], "omegas": (1, 2, 3)})
    assert isinstance(point.data["residues"], np.ndarray)
    np.testing.assert_array_equal(point.data["omegas"], [1, 2, 3])
