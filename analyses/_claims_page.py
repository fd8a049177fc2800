"""The ledger as Markdown and as one HTML page that needs no other file."""

from __future__ import annotations

from collections import Counter
from html import escape
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:  # the folder is no package; the shelf finds its files in every installation
    from collections.abc import Sequence

    from analyses._claimed import describe
    from analyses._ledger import KINDS, Entry
else:
    from racs_bif.shelf.analyses._claimed import describe
    from racs_bif.shelf.analyses._ledger import KINDS

TITLE: Final = "The claims of the paper, checked"
PAPER: Final = (
    "Hopf Bifurcation Characteristics of the Vehicle with Rear Axle Compliance Steering. Variant "
    "paper of the model, exact fractional operator where not said otherwise. The paper gives no "
    "C_s. 'Calibrated': C_s = {:.3f} N/rad, which puts the Hopf point of Fig. 3 where it is. "
    "A claim about stability is checked over all C_s and tells for which of them it is true."
)
_COLOURS: Final = dict(
    zip(KINDS, ("#0072B2", "#009E73", "#E69F00", "#CC79A7", "#D55E00"), strict=True)
)
_STYLE: Final = """
:root { color-scheme: light dark; }
body { font: 15px/1.45 system-ui, sans-serif; max-width: 62rem;
  margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; }
table { border-collapse: collapse; margin: 1rem 0; }
td, th { padding: .2rem .8rem .2rem 0; text-align: left; vertical-align: top; }
td.n { text-align: right; }
article { border-left: .35rem solid var(--c); padding: .1rem 0 .1rem 1rem; margin: 1.4rem 0; }
article h2 { font-size: 1rem; margin: 0; }
article p { margin: .3rem 0; }
.badge { color: var(--c); font-weight: 600; }
dl { display: grid; grid-template-columns: 8rem 1fr; gap: .15rem .8rem; margin: .4rem 0; }
dt { opacity: .7; } dd { margin: 0; overflow-wrap: anywhere; }
@media (max-width: 40rem) { dl { grid-template-columns: 1fr; } dd { margin-bottom: .3rem; } }
"""


def to_markdown(entries: Sequence[Entry], pictures: Sequence[str], calibrated: float) -> str:
    """Return the ledger as Markdown.

    Parameters
    ----------
    entries : sequence of Entry
        The entries.
    pictures : sequence of str
        File names of the pictures there are, to be linked to.
    calibrated : float
        The calibrated C_s [N/rad].
    """
    lines = [f"# {TITLE}", "", PAPER.format(calibrated), "", "| verdict | claims |", "|---|---:|"]
    lines += [f"| {kind} | {count} |" for kind, count in _counts(entries)]
    lines += ["", "| claim | place | says | stated | computed | found | true for C_s [N/rad] "]
    lines[-1] += "| verdict | not together with |"
    lines.append("|" + "---|" * 9)
    for entry in entries:
        claim, finding = entry.claim, entry.finding
        links = ", ".join(f"[{name}]({name})" for name in _figures(entry, pictures))
        cells = (
            f"`{claim.key}`",
            claim.place + (f" ({links})" if links else ""),
            claim.says,
            claim.stated,
            finding.computed,
            finding.found,
            _where(entry),
            f"**{entry.verdict}**",
            ", ".join(entry.apart),
        )
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines) + "\n"


def to_html(entries: Sequence[Entry], pictures: Sequence[str], calibrated: float) -> str:
    """Return the ledger as a page of HTML; the arguments are those of `to_markdown`."""
    rows = "".join(
        f'<tr><td style="color:{_COLOURS[kind]}">&#9632; {escape(kind)}</td>'
        f'<td class="n">{count}</td></tr>'
        for kind, count in _counts(entries)
    )
    cards = "\n".join(_card(entry, pictures) for entry in entries)
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{TITLE}</title>\n<style>{_STYLE}</style>\n</head>\n<body>\n<h1>{TITLE}</h1>\n"
        f"<p>{escape(PAPER.format(calibrated))}</p>\n"
        f"<table>\n<tr><th>verdict</th><th>claims</th></tr>\n{rows}\n</table>\n"
        f"{cards}\n</body>\n</html>\n"
    )


def _card(entry: Entry, pictures: Sequence[str]) -> str:
    claim, finding = entry.claim, entry.finding
    rows = [
        ("stated", escape(claim.stated)),
        ("computed", escape(finding.computed)),
        ("found", escape(finding.found)),
        ("true for C_s", escape(_where(entry))),
        ("not with", ", ".join(f'<a href="#{key}">{key}</a>' for key in entry.apart)),
        ("pictures", ", ".join(f'<a href="{p}">{p}</a>' for p in _figures(entry, pictures))),
    ]
    listed = "".join(f"<dt>{name}</dt><dd>{text}</dd>" for name, text in rows if text)
    return (
        f'<article id="{claim.key}" style="--c:{_COLOURS[entry.kind]}">\n'
        f"<h2>{escape(claim.place)} <small>{claim.key}</small></h2>\n"
        f"<p>{escape(claim.says)}</p>\n"
        f'<p class="badge">{escape(entry.verdict)}</p>\n<dl>{listed}</dl>\n</article>'
    )


def _counts(entries: Sequence[Entry]) -> list[tuple[str, int]]:
    """Return how often each kind of verdict was given."""
    found = Counter(entry.kind for entry in entries)
    return [(kind, found[kind]) for kind in KINDS]


def _figures(entry: Entry, pictures: Sequence[str]) -> list[str]:
    prefix = entry.claim.figure
    return [name for name in pictures if prefix and name.startswith(prefix)]


def _where(entry: Entry) -> str:
    where = entry.finding.where
    return describe(where) if where else ""
