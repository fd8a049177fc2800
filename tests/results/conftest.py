"""A diagram that is known in closed form: the normal form of a supercritical Hopf point.

Equilibrium, amplitude sqrt((u - 10)/50), period and multipliers are written down as continuation
would return them; nothing is integrated.
"""

from dataclasses import replace

import numpy as np
import pytest

from racs_bif.results.branch import Branch, Profile
from racs_bif.results.diagram import Diagram
from racs_bif.results.provenance import RealisationInfo, SystemInfo
from racs_bif.results.special import ExactPoint, SpecialPoint

HOPF, OMEGA = 10.0, 9.5


def system_info():
    return SystemInfo(
        model="synthetic",
        title="Hopf's normal form, déplacé",
        variant="paper",
        states=("v", "delta_c"),
        parameters={"u": 5.0, "m": 1740.0, "C_s": 1 / 3},
        units={"u": "m/s", "v": "m/s", "delta_c": "rad", "m": "kg"},
        shown="delta_c",
        realisation=RealisationInfo(name="oustaloup", states=1, band=(0.1, 1e3), error=0.01),
        notes=("the sign in print is inconsistent",),
        version="1.2.3",
    )


def equilibria(low=5.0, high=30.0):
    u = np.unique([*np.linspace(low, high, 27), HOPF, 12.0])
    states = np.column_stack([0.1 * u, -0.001 * u, 0.3 * u])
    roots = np.column_stack([0.1 * (u - HOPF) + 1j * OMEGA, 0.1 * (u - HOPF) - 1j * OMEGA, -u + 0j])
    labels = ["H" if x == HOPF else "UZ" if x == 12 else "" for x in u]
    labels[0] = labels[-1] = "EP"
    at, user = int(np.flatnonzero(u == HOPF)[0]), int(np.flatnonzero(u == 12.0)[0])
    return Branch(
        name="EQ1",
        kind="equilibrium",
        parameters=("u",),
        values=u[:, None],
        arclength=(u - low) / (high - low),
        stable=u < HOPF,
        unstable=np.where(u > HOPF, 2, 0),
        spectrum=roots,
        labels=tuple(labels),
        state_names=("v", "delta_c", "memory_1"),
        states=states,
        special=(
            SpecialPoint(
                label="H",
                name="H1",
                branch="EQ1",
                index=at,
                parameters={"u": HOPF},
                state={"v": 1.0, "delta_c": -0.01},
                data={
                    "omega": np.float64(OMEGA),
                    "l1": -1.25,
                    "criticality": "supercritical",
                    "eigenvector": np.array([1.0, -1j, np.nan]),
                    "ratio": 0.1 + 0.2j,
                    "steps": 3,
                    "degenerate": np.False_,
                    "nothing": None,
                },
                exact=ExactPoint(
                    parameters={"u": 10.001}, omega=9.51, shift={"u": -1e-4, "omega": -1e-3}
                ),
                origin=object(),
            ),
            SpecialPoint(
                label="UZ",
                name="UZ1",
                branch="EQ1",
                index=user,
                parameters={"u": 12.0},
                state={"v": 1.2, "delta_c": -0.012},
            ),
        ),
        stopped="reached the end of the span",
        early=False,
        system=system_info(),
    )


def orbits(high=30.0, lost=21.0):
    u = np.unique([*np.linspace(HOPF, high, 40), 12.0, lost])
    amplitude = np.sqrt((u - HOPF) / 50)
    multipliers = np.column_stack(
        [np.ones_like(u), np.exp((u - lost) / 10), np.full_like(u, np.nan)]
    )
    labels = ["NS" if x == lost else "UZ" if x == 12 else "" for x in u]
    marked = {label: labels.index(label) for label in ("NS", "UZ")}
    times = np.linspace(0, 2 * np.pi / OMEGA, 7)
    return Branch(
        name="PO1",
        kind="orbit",
        parameters=("u",),
        values=u,
        arclength=np.arange(len(u)),
        stable=u < lost,
        unstable=np.where(u > lost, 1, 0),
        spectrum=multipliers,
        labels=labels,
        measures={
            "max delta_c": -0.001 * u + amplitude,
            "min delta_c": -0.001 * u - amplitude,
            "period": np.full_like(u, 2 * np.pi / OMEGA),
        },
        special=[
            SpecialPoint(
                label=label,
                name=f"{label}1",
                branch="PO1",
                index=k,
                parameters={"u": u[k]},
                data={"period": 2 * np.pi / OMEGA, "multipliers": multipliers[k].astype(complex)},
            )
            for label, k in sorted(marked.items(), key=lambda item: item[1])
        ],
        stopped="the period is too long for shooting; continue by collocation",
        early=True,
        system=system_info(),
        method="shooting",
        profiles={
            "NS1": Profile(
                times=times,
                names=("v", "delta_c"),
                states=np.column_stack([np.sin(times), np.cos(times)]),
            )
        },
    )


def many_points():
    """Return a diagram whose branch has special points close together."""
    branch = equilibria()
    places = (4, 5, 6, 7, 8)
    labels = ["LP" if k in places else "" for k in range(len(branch))]
    special = [
        SpecialPoint(
            label="LP", name=f"LP{k}", branch="EQ1", index=k, parameters={"u": branch.parameter[k]}
        )
        for k in places
    ]
    return Diagram(replace(branch, labels=labels, special=special))


def steep():
    """Return a diagram of the vehicle's kind: a cluster of special points and no free corner."""
    orbit = orbits()
    places = {20: "LPC", 21: "LPC", 22: "NS", 23: "PD", 24: "PD"}
    labels = [places.get(k, "") for k in range(len(orbit))]
    u = orbit.parameter.copy()
    u[20:25] = [21.25, 21.19, 21.3, 21.6, 21.9]
    u[25:] = np.linspace(22, 30, len(u) - 25)
    special = [
        SpecialPoint(label=kind, name=f"{kind}{k}", branch="PO1", index=k, parameters={"u": u[k]})
        for k, kind in places.items()
    ]
    low = orbit.measures["min delta_c"]
    ends = {"min delta_c": np.where(u < 21, low, -0.7 + 0.01 * u)}
    measures = {**orbit.measures, **ends}
    return Diagram(
        equilibria(), replace(orbit, labels=labels, special=special, values=u, measures=measures)
    )


@pytest.fixture
def branch():
    return equilibria()


@pytest.fixture
def orbit_branch():
    return orbits()


@pytest.fixture
def diagram():
    return Diagram(equilibria(), orbits())
