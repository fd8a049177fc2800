from dataclasses import replace

import numpy as np
import pytest
import xarray

from racs_bif import TimeHistory, load, save
from racs_bif.errors import UsageError
from racs_bif.results.history_summary import summarise_history
from racs_bif.results.provenance import SystemInfo


@pytest.fixture
def history():
    t = np.linspace(0.0, 16.0, 1601)
    outputs = {"force": np.sin(3.0 * t), "time": t**2}
    outputs["force"][0] = np.nan
    return TimeHistory(
        times=t,
        state_names=("x", "v"),
        states=np.column_stack([np.cos(2.0 * t) + 1.0, -2.0 * np.sin(2.0 * t)]),
        outputs=outputs,
        inputs={"f": np.where(t > 1.0, 2.0, 0.0)},
        system=SystemInfo(
            model="m", states=("x", "v"), units={"x": "m", "f": "N"}, shown="v", version="1"
        ),
        operator="exact",
        method="bdf2",
        history="rest",
        step=0.01,
        order=2.0,
        errors={"x": 1e-5, "v": 2e-5, "force": np.nan, "time": 0.0},
        stopped="The duration is over.",
    )


def test_it_is_saved_bit_by_bit_and_opens_in_xarray(history, tmp_path):
    path = save(history, tmp_path / "h.nc")
    assert load(path) == history
    with xarray.open_dataset(path, group="history", engine="h5netcdf") as data:
        assert data["x"].dims == ("time",)
        assert data["x"].attrs["units"] == "m"
        assert data["x"].sel(time=1.0) == history.column("x")[100]
        assert data["time_"].attrs["long_name"] == "time"
    bare = replace(
        history, state_names=(), states=np.empty((1601, 0)), inputs={}, errors={}, step=np.nan
    )
    assert load(save(bare, tmp_path / "bare.nc")) == bare


def test_columns_have_names_units_and_a_table(history):
    assert history.names == ("x", "v", "force", "time", "f")
    assert history.units["f"] == "N"
    assert history.units["force"] == ""
    assert history.column("v")[0] == 0.0
    with pytest.raises(UsageError, match="no 'forse'; did you mean 'force'"):
        history.column("forse")
    table = history.to_dataframe()
    assert table.index.name == "time"
    assert list(table.columns) == list(history.names)
    assert "1601 samples to 16 s, exact operator by bdf2" in repr(history)


def test_extremes_and_period(history):
    assert history.extremes("x", after=0.5) == pytest.approx((0.0, 2.0), abs=1e-7)
    assert history.period("force") == pytest.approx(2.0 * np.pi / 3.0, rel=1e-6)


def test_columns_of_another_length_are_refused(history):
    with pytest.raises(ValueError, match="another length"):
        replace(history, inputs={"f": np.zeros(3)})


def test_the_summary(history):
    told = summarise_history(history, ["simulate"], "1")
    assert told["simulation"]["operator"] == "exact"
    assert told["simulation"]["step"] == 0.01
    assert told["columns"]["x"] == {
        "unit": "m",
        "last": pytest.approx(np.cos(32.0) + 1.0),
        "error": 1e-5,
        "min": pytest.approx(0.0, abs=1e-7),
        "max": pytest.approx(2.0),
        "period": pytest.approx(np.pi, rel=1e-6),
    }
    assert told["columns"]["force"]["error"] is None
    short = replace(
        history,
        times=history.times[:4],
        states=history.states[:4],
        outputs={},
        inputs={},
    )
    assert summarise_history(short, [], "1")["columns"]["x"]["max"] == history.states[2:4, 0].max()
