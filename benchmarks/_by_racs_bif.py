"""A problem of the textbooks by racs_bif, by collocation or by the default method."""

from __future__ import annotations

from typing import Any

from benchmarks._driven import drive


def run(problem: dict[str, Any]) -> dict[str, Any]:
    """Follow equilibria and orbits; a Lorenz system begins away from the rest at the origin."""
    import racs_bif as rb

    name, low = problem["parameter"], problem["span"][0]
    model: Any = rb.load_model(problem["model"], parameters={name: low})
    if problem["homoclinic"] is not None:
        from dataclasses import replace

        from racs_bif.shelf import find
        from racs_bif.shelf.modules import load_module

        model = load_module(find("models", problem["model"])).model()
        model = replace(model, guess=problem["guess"])
    rest = rb.continue_equilibria(model, name, tuple(problem["span"]))
    orbits = rb.continue_orbits(rest["H1"], tuple(problem["orbits"]), method=problem["method"])
    end = orbits.special[-1] if orbits.special else None
    return {
        "version": rb.__version__,
        "points": len(rest.arclength) + len(orbits.arclength),
        "special": [(p.label, p.parameters[name]) for b in (rest, orbits) for p in b.special],
        "end": (float(orbits.parameter[-1]), float(orbits.column("period")[-1])),
        "limit": None if end is None else end.data.get("limit"),
    }


if __name__ == "__main__":
    drive(run)
