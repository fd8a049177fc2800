"""The gallery: runs every other analysis and writes a page with all pictures and captions."""

from __future__ import annotations

import base64
import html
import inspect
import io
import re
import traceback
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from racs_bif.errors import UsageError
from racs_bif.plots.plate import read_plate
from racs_bif.results.atomic import write_text
from racs_bif.shelf import find, load_module, names

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

PAGE: Final = "index.html"
LAST: Final = ("claims",)
"""Run when all others are done, because they link to the others' pictures."""
_HEAVY: Final = ("fig03_speed", "basins", "chaos", "fig10_mass", "fig13_steering")
"""Begun first, so that no worker is left with a long one at the end."""
_SHOWN: Final = re.compile(r"!\[[^]]*\]\(([\w.-]+)\)")
"""Pictures in Markdown."""
_THUMBNAIL: Final = 1000
"""About the width of a thumbnail on the page, pixels."""
_STYLE: Final = """
body{font:16px/1.45 sans-serif;max-width:66rem;margin:2rem auto;padding:0 1rem;color:#111}
section{border-top:1px solid #ccc;padding:1rem 0}img{max-width:100%;height:auto}
h2{font-size:1.1rem}p{margin:.4rem 0}.failed{color:#b00}nav a{margin-right:1rem}
"""


def run(
    out: Path,
    *,
    workers: int = 2,
    reduced: int = 0,
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Run all analyses and return the path of the page, ``index.html``.

    Parameters
    ----------
    out : Path
        Folder of all files.
    workers : int
        Processes.
    reduced : int
        1 runs everything at a low resolution, to see that it works: a tenth of the numbers.
    progress : callable, optional
        Told the share that is done.

    Raises
    ------
    UsageError
        If there is no worker.
    """
    if workers < 1:
        msg = f"at least one worker is needed, not {workers}"
        raise UsageError(msg)
    own = Path(__file__).stem
    known = [name for name in names("analyses") if name != own]
    first = [name for name in _HEAVY if name in known]
    order = [*first, *(n for n in known if n not in {*first, *LAST})]
    tasks = {name: _numbers(name, reduced=bool(reduced)) for name in known}
    out.mkdir(parents=True, exist_ok=True)
    failures = _compute(out, order, tasks, workers, progress)
    failures |= _compute(out, [n for n in LAST if n in known], tasks, 1, None)
    write_text(out / PAGE, page(out, known, failures))
    if progress is not None:
        progress(1.0)
    return out / PAGE


def _numbers(name: str, *, reduced: bool) -> dict[str, float]:
    """Return the numbers that an analysis is run with: its own, or a tenth of the large ones."""
    if not reduced:
        return {}
    found: dict[str, float] = {}
    signature = inspect.signature(load_module(find("analyses", name)).run)
    for key, parameter in signature.parameters.items():
        value = parameter.default
        if isinstance(value, bool) or not isinstance(value, int | float) or value < 10:
            continue
        smaller = max(8, value // 10) if isinstance(value, int) else max(8.0, 0.25 * value)
        found[key] = value if key == "speed" else smaller
    return found


def _compute(
    out: Path,
    order: list[str],
    tasks: Mapping[str, dict[str, float]],
    workers: int,
    progress: Callable[[float], None] | None,
) -> dict[str, str]:
    """Run analyses in processes of their own; return what those that failed said."""
    if not order:
        return {}
    context = get_context("spawn")
    shares = context.Array("d", len(order))
    failures: dict[str, str] = {}
    pool = ProcessPoolExecutor(
        min(workers, len(order)), mp_context=context, initializer=_receive, initargs=(shares,)
    )
    try:
        waiting: dict[Future[str], str] = {
            pool.submit(_one, name, k, out, tasks[name]): name for k, name in enumerate(order)
        }
        while waiting:
            done, _ = wait(waiting, timeout=0.5, return_when=FIRST_COMPLETED)
            for future in done:
                name = waiting.pop(future)
                error = future.exception()
                text = str(error) if error is not None else future.result()
                if text:
                    failures[name] = text
            if progress is not None:
                progress(float(sum(shares[:])) / len(order))
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
    return failures


_shares: Any = None


def _receive(shares: Any) -> None:  # noqa: ANN401 - multiprocessing brings no type
    """Keep the array of progress in a worker."""
    global _shares  # noqa: PLW0603 - a process of its own
    _shares = shares


def _one(name: str, number: int, out: Path, options: dict[str, Any]) -> str:
    """Run one analysis; return the end of the traceback if it fails."""

    def report(share: float) -> None:
        _shares[number] = share

    try:
        function = load_module(find("analyses", name)).run
        if "progress" in inspect.signature(function).parameters:
            options = {**options, "progress": report}
        function(out, **options)
    except Exception:  # noqa: BLE001 - the file may be the user's, and the others go on
        return "\n".join(traceback.format_exc().strip().splitlines()[-3:])
    finally:
        report(1.0)
    return ""


def page(out: Path, known: list[str], failures: Mapping[str, str]) -> str:
    """Return the gallery as HTML that needs no other file but for the links.

    Parameters
    ----------
    out : Path
        Folder with what the analyses wrote.
    known : list of str
        Analyses, in the order of the page.
    failures : mapping of str to str
        Those that failed, and why.
    """
    links = " ".join(f'<a href="#{name}">{html.escape(name)}</a>' for name in known)
    parts = [_section(out, name, failures.get(name, "")) for name in known]
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        f"<title>racs_bif: the paper, figure by figure</title><style>{_STYLE}</style></head><body>"
        f"<h1>The paper, figure by figure</h1><nav>{links}</nav>{''.join(parts)}</body></html>\n"
    )


def _section(out: Path, name: str, failure: str) -> str:
    document = load_module(find("analyses", name)).__doc__ or name
    title = html.escape(document.strip().partition("\n")[0])
    text = [f'<section id="{name}"><h2>{title}</h2>']
    if failure:
        text.append(f'<pre class="failed">failed: {html.escape(failure)}</pre></section>')
        return "".join(text)
    files = _files(out, name)
    text += [
        f'<a href="{picture.name}"><img alt="{title}" '
        f'src="data:image/png;base64,{thumbnail(picture)}"></a>'
        for picture in files
        if picture.suffix == ".png"
    ]
    plate = read_plate(out, name)
    if plate is not None:
        text += [f"<p>{html.escape(paragraph)}</p>" for paragraph in plate.caption]
    links = " ".join(f'<a href="{path.name}">{html.escape(path.name)}</a>' for path in files)
    text.append(f"<p>{links}</p></section>")
    return "".join(text)


def _files(out: Path, name: str) -> list[Path]:
    """Return the files of an analysis: those that bear its name, and what its page shows.

    Pictures with a plate of their own belong to another.
    """
    found = {path for path in out.glob(f"{name}*") if path.is_file()}
    for written in [path for path in found if path.suffix == ".md"]:
        shown = _SHOWN.findall(written.read_text(encoding="utf-8"))
        found |= {out / n for n in shown if (out / n).is_file() and not _has_plate(out / n)}
    return sorted(found)


def _has_plate(path: Path) -> bool:
    return path.with_suffix(".json").is_file()


def thumbnail(path: Path) -> str:
    """Return a picture, made smaller by averaging blocks of pixels, as base64 text."""
    import numpy as np
    from matplotlib import image

    pixels = image.imread(path)
    block = max(1, round(pixels.shape[1] / _THUMBNAIL))
    rows, columns = pixels.shape[0] // block, pixels.shape[1] // block
    cut = pixels[: rows * block, : columns * block]
    mean = cut.reshape(rows, block, columns, block, -1).mean(axis=(1, 3))
    small = io.BytesIO()
    image.imsave(small, np.clip(mean, 0.0, 1.0), format="png")
    return base64.b64encode(small.getvalue()).decode("ascii")
