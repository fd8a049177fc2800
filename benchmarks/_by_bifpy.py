"""A problem of the textbooks by bifpy, AUTO-07p called from Python.

Its native path is taken (``transpile=True``: the equations become Fortran, compiled in every run),
the faster of its two: 0.3 s against 1.3 on the Brusselator, 0.9 against 6.9 on the axon. Jacobians
of its own making (``AUTO_JACOBIAN``) find the same points in as much time.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from benchmarks._driven import drive, in_our_names

if TYPE_CHECKING:
    from collections.abc import Callable


def right_hand_side(problem: dict[str, Any]) -> Callable[[Any, Any], list[Any]]:
    """Return the equations as a function as bifpy wants it."""
    lines = [f"def func(state, parameters):\n    {problem['parameter']} = parameters[0]"]
    lines += [f"    {name} = state[{k}]" for k, name in enumerate(problem["equations"])]
    lines += [f"    {name} = {text}" for name, text in problem["given"].items()]
    lines.append(f"    return [{', '.join(problem['equations'].values())}]")
    space: dict[str, Any] = {"exp": lambda v: math.exp(v)}  # noqa: PLW0108 - bifpy patches math
    exec("\n".join(lines), space)  # our own texts
    made: Callable[[Any, Any], list[Any]] = space["func"]
    return made


def run(problem: dict[str, Any]) -> dict[str, Any]:
    """Follow equilibria, and orbits from the first Hopf point."""
    from importlib.metadata import version

    from bifpy import auto  # type: ignore[import-not-found] # in an environment of its own

    func, steps = right_hand_side(problem), problem["steps"]
    guess = [problem["guess"][name] for name in problem["equations"]]

    def start(state: Any, parameters: Any, _: Any) -> None:  # noqa: ANN401 - its arrays
        for k, value in enumerate(guess):
            state[k] = value
        parameters[0] = problem["span"][0]

    common: dict[str, Any] = {
        "ndim": len(guess),
        "ntst": 40,
        "ncol": 4,
        "iad": 3,
        "isp": 2,
        "ilp": 1,
        "npr": 0,
    }
    common |= {"epsl": 1e-8, "epsu": 1e-8, "epss": 1e-7, "itmx": 20, "itnw": 8, "nwtn": 3}
    common |= {"dsmin": 1e-6, "mxbf": 0, "jac": 0, "iid": 0}
    low, high = problem["span"]
    settings = common | {"ips": auto.IPS_EQUILIBRIUM, "rl0": low, "rl1": high, "nmx": 1000}
    settings |= {"ds": steps["ds"], "dsmax": steps["dsmax"]}
    rest = auto.run(func, start, settings, icu=[1], transpile=True).branches[0].points
    hopf = next(p for p in rest if p.point_type is auto.PointType.HOPF_BIFURCATION)
    low, high = problem["orbits"]
    settings = common | {"ips": auto.IPS_PERIODIC_ORBIT, "rl0": low, "rl1": high}
    settings |= {"ds": steps["orbit_ds"], "dsmax": steps["orbit_dsmax"], "nmx": int(steps["nmx"])}
    orbits = (
        auto.restart(
            func,
            settings,
            hopf,
            icu=[1, auto.PERIOD_INDEX],
            isw=auto.ISW_HOPF_TO_PERIODIC_ORBIT,
            stpnt=start,
            source_ips=auto.IPS_EQUILIBRIUM,
            transpile=True,
        )
        .branches[0]
        .points
    )
    labels = {1: "BP", 2: "LP", 3: "HB", 5: "LP", 6: "BP", 7: "PD", 8: "TR"}
    special: list[tuple[str, float]] = []
    for points, periodic in ((rest, False), (orbits, True)):
        named = [(labels.get(p.point_type_code, ""), p.parameters[0]) for p in points]
        special += in_our_names(named, orbits=periodic)
    last = orbits[-1]
    return {
        "version": version("bifpy"),
        "points": len(rest) + len(orbits),
        "special": special,
        "end": (last.parameters[0], last.parameters[1]),
    }


if __name__ == "__main__":
    drive(run)
