"""The paper's claims of sections 4 and 5, and how each is checked."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:  # the folder is no package; the shelf finds its files in every installation
    from analyses._checks_motion import Chaos, Widths
    from analyses._checks_stability import Says, Threshold, Together
    from analyses._ledger import Claim
else:
    from racs_bif.shelf.analyses._checks_motion import Chaos, Widths
    from racs_bif.shelf.analyses._checks_stability import Says, Threshold, Together
    from racs_bif.shelf.analyses._ledger import Claim

_ORDERS: Final = (0.2, 0.3, 0.4, 0.5)
_MASSES: Final = (30.0, 100.0, 160.0, 200.0)
_MASS_SPAN: Final = (29.9, 200.0)
_MASSES_DOWN: Final = (155.0, 130.0, 100.0, 60.0, 30.0)
_ARMS: Final = (0.1, 0.15, 0.2, 0.3, 0.35)
_ANGLES: Final = (0.01, 0.04, 0.08, 0.12)
_AT_20: Final = ({"u": 20.0},)
_MASS_AT: Final = tuple({"u": 20.0, "c": c} for c in (0.15, 0.2, 0.3, 0.35))

CLAIMS: Final[tuple[Claim, ...]] = (
    Claim(
        key="fig07",
        place="section 4.1, Fig. 7",
        says="Fluctuation at alpha = 0.5 and 0.4; it disappears and the vehicle becomes stable at "
        "alpha = 0.3.",
        stated="u = 20 m/s, E_0 = 0.5e5 MPa, alpha = 0.3, 0.4, 0.5",
        check=Says("fig07"),
        figure="fig07",
    ),
    Claim(
        key="fig07-smaller",
        place="section 4.1, Fig. 7",
        says="The smaller the order alpha is, the closer to zero the amplitude of fluctuation is.",
        stated="u = 20 m/s, alpha = 0.4, 0.5",
        check=Widths("alpha", (0.25, 0.5002), (0.38, 0.4, 0.45, 0.5), {"u": 20.0}, key="fig07"),
        figure="fig07",
    ),
    Claim(
        key="fig07-control",
        place="section 4.1",
        says="Changing the fractional order alpha can control shimmy.",
        stated="u = 20 m/s",
        check=Threshold("alpha", _ORDERS, stabilises=False),
        figure="fig07",
    ),
    Claim(
        key="fig08",
        place="section 4.1, Fig. 8",
        says="With increasing E_0 the stability is obviously improved, even at alpha = 0.5.",
        stated="u = 20 m/s, E_0 = 0.5e5 and 0.8e5 MPa, alpha = 0.3, 0.4, 0.5",
        check=Threshold(
            "E_0",
            (0.5e5, 0.8e5),
            stabilises=True,
            others=tuple({"u": 20.0, "alpha": alpha} for alpha in (0.3, 0.4, 0.5)),
        ),
        figure="fig08",
    ),
    Claim(
        key="fig09",
        place="section 4.2, Fig. 9",
        says="When c is small, delta_c is stable; when c increases to 0.15 m, Hopf bifurcation "
        "occurs.",
        stated="u = 20 m/s, m_c = 100 kg, c = 0.15 m",
        check=Says("fig09"),
        figure="fig09",
    ),
    Claim(
        key="fig09-chaos",
        place="section 4.2, Figs 9, 11(b)",
        says="With the further increase of c, the vehicle runs into a serious unstable state, "
        "which is a chaos state (c = 0.3).",
        stated="u = 20 m/s, m_c = 100 kg, c = 0.3 m",
        check=Chaos({"u": 20.0, "c": 0.3}, ("fig09",)),
        figure="fig09",
    ),
    Claim(
        key="fig10-c",
        place="section 4.2, Fig. 10",
        says="The larger the value of c is, the greater the oscillation degree is.",
        stated="c = 0.15, 0.2, 0.3 m; checked to 0.2 m",
        check=Widths("c", (0.1, 0.20002), (0.155, 0.16, 0.18, 0.2), {"u": 20.0}, key="fig09"),
        figure="fig10",
    ),
    Claim(
        key="fig10",
        place="section 4.2, Fig. 10(a)",
        says="When m_c is less than 160 kg, the vehicle is in an unstable oscillating state; when "
        "it is larger, it enters a relatively steady state.",
        stated="m_c = 160 kg; c = 0.15 m by the caption, 0.2 and 0.3 m looked at too",
        check=Says("fig10"),
        figure="fig10",
    ),
    Claim(
        key="fig10-smaller",
        place="section 4.2, Fig. 10(a)",
        says="The smaller the mass is, the greater the oscillation degree is.",
        stated="m_c < 160 kg; checked with c = 0.3 m",
        check=Widths(
            "m_c",
            _MASS_SPAN,
            _MASSES_DOWN,
            {"u": 20.0, "c": 0.3},
            key="fig10",
            reading=2,
        ),
        figure="fig10",
    ),
    Claim(
        key="fig10-asymmetric",
        place="section 4.2, Fig. 10(a)",
        says="The compliance steering angle changes asymmetrically.",
        stated="m_c < 160 kg; checked with c = 0.3 m",
        check=Widths(
            "m_c",
            _MASS_SPAN,
            _MASSES_DOWN,
            {"u": 20.0, "c": 0.3},
            key="fig10",
            reading=2,
            asymmetric=True,
        ),
        figure="fig10",
    ),
    Claim(
        key="fig11a",
        place="section 4.2, Fig. 11(a)",
        says="Periodic motion of the rear wheel at c = 0.2 m.",
        stated="c = 0.2 m, m_c = 100 kg",
        check=Says("fig11a"),
        figure="fig11",
    ),
    Claim(
        key="fig11b",
        place="section 4.2, Fig. 11(b)",
        says="No steady state at c = 0.3 m (called chaotic motion there).",
        stated="c = 0.3 m, m_c = 100 kg",
        check=Says("fig11b"),
        figure="fig11",
    ),
    Claim(
        key="fig12",
        place="section 4.2, Fig. 12",
        says="Periodic motion of the rear wheel at m_c = 30 kg.",
        stated="m_c = 30 kg, c = 0.2 m",
        check=Says("fig12"),
        figure="fig12",
    ),
    Claim(
        key="fig13",
        place="section 4.3, Fig. 13",
        says="Periodic oscillation when delta_f is smaller than 0.08 rad, a stable value when it "
        "is larger.",
        stated="u = 20 m/s, delta_f = 0.08 rad",
        check=Says("fig13"),
        figure="fig13",
    ),
    Claim(
        key="fig13-small",
        place="section 4.3",
        says="When delta_f is a smaller value (nearly straight road), vibration with a smaller "
        "amplitude occurs (smaller than at larger angles, as we read it).",
        stated="u = 20 m/s",
        check=Widths("delta_f", (0.0099, 0.1), (0.01, 0.02, 0.04, 0.06), {"u": 20.0}, key="fig13"),
        figure="fig13",
    ),
    Claim(
        key="fig13-inhibits",
        place="section 4.3",
        says="Larger front wheel steering angle: shimmy is inhibited by the tire lateral force.",
        stated="u = 20 m/s",
        check=Threshold("delta_f", _ANGLES, stabilises=True),
        figure="fig13",
    ),
    Claim(
        key="fig14a",
        place="section 4.3, Fig. 14(a)",
        says="When delta_f equals 0.04, periodic motion of the rear wheel occurs.",
        stated="delta_f = 0.04 rad",
        check=Says("fig14a"),
        figure="fig14",
    ),
    Claim(
        key="fig14b",
        place="section 4.3, Fig. 14(b)",
        says="When delta_f equals 0.12, the vehicle is stable and the equilibrium a stable focus.",
        stated="delta_f = 0.12 rad",
        check=Says("fig14b"),
        figure="fig14",
    ),
    Claim(
        key="one-vehicle",
        place="figures 3, 7, 9 and 13",
        says="All are of one vehicle, whose C_s (that is, A and h) is the same.",
        stated="",
        check=Together(("fig03", "fig07", "fig09", "fig13")),
    ),
    Claim(
        key="conclusion-1",
        place="section 5 (1)",
        says="The longitudinal velocity is an important bifurcation parameter: shimmy occurs above "
        "the critical velocity.",
        stated="",
        check=Threshold(
            "u", (6.0, 8.0, 10.0, 12.0, 15.0, 20.0, 30.0), stabilises=False, others=({},)
        ),
        figure="fig03",
    ),
    Claim(
        key="conclusion-2",
        place="section 5 (2)",
        says="A larger fractional order gives fluctuation of a higher level; with a smaller one it "
        "disappears and the vehicle becomes stable.",
        stated="",
        check=Threshold("alpha", _ORDERS, stabilises=False, others=({"u": 10.2}, {"u": 20.0})),
        figure="fig07",
    ),
    Claim(
        key="conclusion-3",
        place="section 5 (3)",
        says="Raising the elastic modulus contributes to the lateral stability.",
        stated="",
        check=Threshold(
            "E_0", (0.3e5, 0.5e5, 0.8e5, 1.2e5), stabilises=True, others=({"u": 10.2}, {"u": 20.0})
        ),
        figure="fig08",
    ),
    Claim(
        key="conclusion-4c",
        place="section 5 (4)",
        says="When c is larger than its critical value, shimmy occurs; the larger, the more "
        "serious.",
        stated="",
        check=Threshold("c", _ARMS, stabilises=False),
        figure="fig09",
    ),
    Claim(
        key="conclusion-4m",
        place="section 5 (4)",
        says="The larger mass value of RACS contributes to the lateral stability.",
        stated="",
        check=Threshold("m_c", _MASSES, stabilises=True, others=_MASS_AT),
        figure="fig10",
    ),
    Claim(
        key="conclusion-5",
        place="section 5 (5)",
        says="The smaller front wheel steering angle will lead to periodic motion.",
        stated="",
        check=Threshold("delta_f", _ANGLES, stabilises=True, others=_AT_20),
        figure="fig13",
    ),
)
