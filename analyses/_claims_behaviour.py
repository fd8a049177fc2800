"""The paper's claims of sections 2 and 3, and how each is checked."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:  # the folder is no package; the shelf finds its files in every installation
    from analyses._checks_motion import Alike, Criticality, Cycle, Focus, Settling, Widths
    from analyses._checks_stability import Needs, Passive, PrintedMatrices, Says, shimmy, stable
    from analyses._ledger import Claim
else:
    from racs_bif.shelf.analyses._checks_motion import (
        Alike,
        Criticality,
        Cycle,
        Focus,
        Settling,
        Widths,
    )
    from racs_bif.shelf.analyses._checks_stability import (
        Needs,
        Passive,
        PrintedMatrices,
        Says,
        shimmy,
        stable,
    )
    from racs_bif.shelf.analyses._ledger import Claim

_SPAN: Final = (5.0, 20.002)
_SPEEDS: Final = (11.0, 12.0, 15.0, 18.0, 20.0)

CLAIMS: Final[tuple[Claim, ...]] = (
    Claim(
        key="law",
        place="section 2.1",
        says="Equation (2a) is adopted to describe the constitutive relation of the viscoelastic "
        "material (which, having no source of energy, is passive).",
        stated="alpha = 0.3, gamma = 0.7, tau_eps = tau_sig = 1",
        check=Passive(),
    ),
    Claim(
        key="matrices",
        place="section 2.2",
        says="Equation (9) can be transformed into state space form, as given in equations (10) "
        "and (11), with the matrices (12).",
        stated="",
        check=PrintedMatrices(),
    ),
    Claim(
        key="fig03",
        place="section 3, Fig. 3",
        says="A bifurcation occurs when the velocity u exceeds the critical velocity 10.2 m/s.",
        stated="u = 10.2 m/s",
        check=Says("fig03"),
        figure="fig03",
    ),
    Claim(
        key="fig03-super",
        place="section 3",
        says="Hopf bifurcation is supercritical at the critical velocity 10.2 m/s.",
        stated="u = 10.2 m/s",
        check=Criticality(),
        figure="fig03",
    ),
    Claim(
        key="fig03-below",
        place="section 3",
        says="When the velocity is smaller than 10.2 m/s, shimmy does not occur.",
        stated="u < 10.2 m/s",
        check=Needs(tuple(stable(u=u) for u in (1.0, 2.0, 4.0, 6.0, 8.0, 10.0, 10.15))),
        figure="fig03",
    ),
    Claim(
        key="fig03-above",
        place="section 3",
        says="When the velocity is larger than 10.2 m/s, shimmy occurs.",
        stated="u > 10.2 m/s",
        check=Needs(tuple(shimmy(u=u) for u in (10.25, 12.0, 15.0, 20.0, 25.0, 30.0))),
        figure="fig03",
    ),
    Claim(
        key="fig03-self",
        place="section 3",
        says="The compliance steering wheel shimmy is a typical self-excited vibration (it needs "
        "no steering input).",
        stated="checked at u = 20 m/s, delta_f = 0",
        check=Needs((shimmy(u=20.0, delta_f=0.0),)),
        figure="fig03",
    ),
    Claim(
        key="fig03-grows",
        place="section 3",
        says="With the velocity increasing, the self-excited oscillation amplitude increases.",
        stated="checked to u = 20 m/s",
        check=Widths("u", _SPAN, _SPEEDS, {}),
        figure="fig03",
    ),
    Claim(
        key="fig04",
        place="section 3, Fig. 4",
        says="Compliance steering angle and yaw rate are both able to reach the stable state after "
        "a period of attenuation oscillation.",
        stated="u = 10 m/s",
        check=Says("fig04"),
        figure="fig04",
    ),
    Claim(
        key="fig04-seven",
        place="section 3, Fig. 4(a)",
        says="It takes about seven seconds to reach its steady-state value.",
        stated="u = 10 m/s",
        check=Settling(10.0, 7.0),
        figure="fig04",
    ),
    Claim(
        key="fig04-yaw",
        place="section 3, Fig. 4(b)",
        says="The yaw rate behaves with similar performance as the compliance steering angle.",
        stated="u = 10 m/s",
        check=Alike(10.0),
        figure="fig04",
    ),
    Claim(
        key="fig05",
        place="section 3, Fig. 5",
        says="The curves present obvious fluctuation: the vehicle experiences shimmy.",
        stated="u = 20 m/s",
        check=Says("fig05"),
        figure="fig05",
    ),
    Claim(
        key="fig06a",
        place="section 3, Fig. 6(a)",
        says="The vehicle is stable and the equilibrium point is a stable focus.",
        stated="u = 10 m/s",
        check=Focus(10.0, unstable=False),
        figure="fig06",
    ),
    Claim(
        key="fig06b",
        place="section 3, Fig. 6(b)",
        says="The equilibrium point is an unstable focus.",
        stated="u = 20 m/s",
        check=Focus(20.0, unstable=True),
        figure="fig06",
    ),
    Claim(
        key="fig06b-cycle",
        place="section 3, Fig. 6(b)",
        says="There appear limit cycles in the phase diagram.",
        stated="u = 20 m/s",
        check=Cycle(_SPAN, _SPEEDS),
        figure="fig06",
    ),
)
