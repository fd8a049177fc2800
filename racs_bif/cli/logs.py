"""The log on the terminal: what ``-v`` and ``-vv`` show."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def log_shown(verbosity: int) -> Iterator[None]:
    """Write what is logged under ``racs_bif`` to stderr; as before afterwards.

    Parameters
    ----------
    verbosity : int
        0 nothing, 1 each step of a continuation, 2 trial steps too.
    """
    if not verbosity:
        yield
        return
    import logging

    logger = logging.getLogger("racs_bif")
    handler = logging.StreamHandler()
    before = logger.level
    logger.addHandler(handler)
    logger.setLevel(logging.INFO if verbosity == 1 else logging.DEBUG)
    try:
        yield
    finally:
        logger.setLevel(before)
        logger.removeHandler(handler)
