"""The ledger: every claim of the paper, what was computed to check it, and the verdict.

The claims are data, in `_claims_behaviour` (sections 2 and 3) and `_claims_factors` (sections 4 and
5); how they are checked is in `_checks_stability` and `_checks_motion`, and how a verdict follows
from what was found in `_ledger`. No verdict is typed in anywhere. Everything is of the default
variant `paper`; `which_stiffness` has the others.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from racs_bif import load_model
from racs_bif.results.atomic import write_text

if TYPE_CHECKING:  # the folder is no package; the shelf finds its files in every installation
    from collections.abc import Callable
    from pathlib import Path

    from analyses import _claims_behaviour, _claims_factors
    from analyses._claims_page import to_html, to_markdown
    from analyses._ledger import Bench, Claim, Entry, examine
else:
    from racs_bif.shelf.analyses._claims_page import to_html, to_markdown
    from racs_bif.shelf.analyses._ledger import Bench, examine

    from racs_bif.shelf.analyses import _claims_behaviour, _claims_factors

CLAIMS: tuple[Claim, ...] = (*_claims_behaviour.CLAIMS, *_claims_factors.CLAIMS)
"""All claims, in the paper's order."""


def run(
    out: Path,
    *,
    resolution: int = 400,
    seconds: float = 100.0,
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Write ``claims.md`` and ``claims.html`` and return the path of the latter.

    Parameters
    ----------
    out : Path
        Folder. Pictures ``figNN...`` in it are linked to.
    resolution : int
        Stiffnesses at which roots are counted; boundaries themselves are exact.
    seconds : float
        Length of the simulations from which Lyapunov exponents are taken.
    progress : callable, optional
        Told the share that is done.
    """
    entries = check(CLAIMS, resolution=resolution, seconds=seconds, progress=progress)
    out.mkdir(parents=True, exist_ok=True)
    pictures = sorted(path.name for path in out.glob("fig*.png"))
    calibrated = load_model("racs").parameters["C_s"]
    write_text(out / "claims.md", to_markdown(entries, pictures, calibrated))
    path = out / "claims.html"
    write_text(path, to_html(entries, pictures, calibrated))
    return path


def check(
    claims: tuple[Claim, ...],
    *,
    resolution: int = 400,
    seconds: float = 100.0,
    progress: Callable[[float], None] | None = None,
) -> list[Entry]:
    """Check claims and return the entries of the ledger.

    Parameters
    ----------
    claims : tuple of Claim
        Some of `CLAIMS`, or others.
    resolution, seconds, progress
        As for `run`.
    """
    bench = Bench(claims, resolution, seconds)
    findings = []
    for k, claim in enumerate(claims):
        findings.append(claim.check.find(bench))
        if progress is not None:
            progress((k + 1) / len(claims))
    return examine(claims, findings, bench)
