"""A problem of the textbooks by xpplab, XPPAUT's engine with AUTO in it."""

from __future__ import annotations

from typing import Any, Final

from benchmarks._driven import drive, in_our_names

# with fewer Newton steps than 8 its steps are not lengthened at this tolerance: three times as many
# points of the Brusselator, and the same special points
SETTINGS: Final = {
    "ntst": 40,
    "ncol": 4,
    "iad": 3,
    "epsl": 1e-8,
    "epsu": 1e-8,
    "epss": 1e-7,
    "itmx": 20,
    "itnw": 8,
    "nwtn": 3,
    "npr": 10000,
    "dsmin": 1e-6,
    "normmin": 0.0,
    "normmax": 1e6,
}


def written(problem: dict[str, Any]) -> str:
    """Return a problem as an .ode file."""
    lines = [f"{name}'={text}" for name, text in problem["equations"].items()]
    lines += [f"{name}={text}" for name, text in problem["given"].items()]
    lines.append(f"par {problem['parameter']}={problem['span'][0]!r}")
    lines += [f"init {name}={value!r}" for name, value in problem["guess"].items()]
    return "\n".join([*lines, "done", ""]).replace("**", "^")


def run(problem: dict[str, Any]) -> dict[str, Any]:
    """Follow equilibria, and orbits from the first Hopf point."""
    import xpplab  # type: ignore[import-not-found] # it has an environment of its own

    steps, (low, high) = problem["steps"], problem["span"]
    with xpplab.Model.from_text(written(problem)) as model:
        auto, name = model.auto, problem["parameter"]
        bounds = SETTINGS | {"parmin": low, "parmax": high}
        rest = auto.equilibria(name, ds=steps["ds"], dsmax=steps["dsmax"], nmax=1000, **bounds)
        bounds["parmin"], bounds["parmax"] = problem["orbits"]
        orbits = auto.continue_from(
            rest.first("HB"),
            "periodic",
            ds=steps["orbit_ds"],
            dsmax=steps["orbit_dsmax"],
            nmax=int(steps["nmx"]),
            **bounds,
        )
        special = in_our_names([(p.type, p.value) for p in rest.special()], orbits=False)
        special += in_our_names([(p.type, p.value) for p in orbits.special()], orbits=True)
        last = orbits[-1]
        return {
            "version": xpplab.__version__,
            "points": len(rest) + len(orbits),
            "special": special,
            "end": (last.value, last.period),
        }


if __name__ == "__main__":
    drive(run)
