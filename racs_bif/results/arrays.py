"""Results as xarray's data sets, with units as attributes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.units import rate_unit

if TYPE_CHECKING:
    import xarray as xr

    from racs_bif.results.branch import Branch
    from racs_bif.results.chart import Chart
    from racs_bif.results.history import TimeHistory
    from racs_bif.results.provenance import SystemInfo


def branch_dataset(branch: Branch) -> xr.Dataset:
    """Return a branch over the dimension ``point``; its spectrum over ``point`` and ``mode``.

    Parameters, arclength and labels are coordinates.
    """
    import xarray as xr

    names = (*branch.state_names, *branch.measures)
    data: dict[str, Any] = {name: _column(branch, name) for name in names}
    data |= {"stable": ("point", branch.stable), "unstable": ("point", branch.unstable)}
    if branch.spectrum.shape[1]:
        data["spectrum"] = (("point", "mode"), branch.spectrum)
    coordinates: dict[str, Any] = {name: _column(branch, name) for name in branch.parameters}
    coordinates["arclength"] = ("point", branch.arclength)
    coordinates["label"] = ("point", np.array(branch.labels, dtype=str))
    attributes = _attributes(branch.system) | {
        "name": branch.name,
        "kind": branch.kind,
        "stopped": branch.stopped,
    }
    return xr.Dataset(data, coordinates, attributes)


def history_dataset(history: TimeHistory) -> xr.Dataset:
    """Return a time history over the dimension ``time``."""
    import xarray as xr

    data = {
        name: ("time", history.column(name), {"units": unit})
        for name, unit in history.units.items()
    }
    times = {"time": ("time", history.times, {"units": history.system.time_unit})}
    attributes = _attributes(history.system) | {
        "operator": history.operator,
        "method": history.method,
        "stopped": history.stopped,
    }
    return xr.Dataset(data, times, attributes)


def chart_dataset(chart: Chart, shape: tuple[int, int]) -> xr.Dataset:
    """Return the numbers of unstable roots of a chart, and its map, over its two parameters.

    Cells are those of the map where there is one; of `shape` otherwise, and then counted from the
    chart's regions. Values of the parameters are those of the cells' middles.
    """
    import xarray as xr

    found = chart.map
    shape = shape if found is None else (found.unstable.shape[0], found.unstable.shape[1])
    axes = [
        low + (high - low) * (np.arange(count) + 0.5) / count
        for (low, high), count in zip(chart.spans, shape, strict=True)
    ]
    names = chart.parameters
    coordinates: dict[str, Any] = {
        name: (name, values, {"units": chart.system.unit(name)})
        for name, values in zip(names, axes, strict=True)
    }
    if found is None:
        places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
        return xr.Dataset(
            {"unstable": (names, chart.unstable_on(places).reshape(shape))},
            coordinates,
            _attributes(chart.system),
        )
    data: dict[str, Any] = {"unstable": (names, found.unstable)}
    if found.quantity == "damping":
        data["sigma"] = (names, found.sigma, {"units": rate_unit(chart.system.time_unit)})
        data["omega"] = (names, found.omega, {"units": chart.system.frequency_unit})
    if found.sweep is not None:
        unit = found.unit(chart.system)
        data[found.quantity] = (names, found.sweep.value, {"units": unit})
        data["error"] = (names, found.sweep.error, {"units": unit})
        data["status"] = (names, found.sweep.status)
    return xr.Dataset(data, coordinates, _attributes(chart.system))


def _column(branch: Branch, name: str) -> tuple[str, np.ndarray, dict[str, str]]:
    return "point", branch.column(name), {"units": branch.system.unit(name)}


def _attributes(system: SystemInfo) -> dict[str, str]:
    words = {"model": system.model, "variant": system.variant, "version": system.version}
    return {name: word for name, word in words.items() if word}
