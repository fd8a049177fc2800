"""What can go wrong by a user's doing: one line that names the thing and the mend."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class RacsBifError(Exception):
    """Base of every error that a user may cause; its message is one line for people."""


class UsageError(RacsBifError, ValueError):
    """An argument, option or setting that cannot be used."""


class ModelError(RacsBifError, ValueError):
    """A model that cannot be built, or whose equations failed where they were evaluated."""


class ParameterError(RacsBifError, ValueError):
    """An unknown parameter, or a value outside the model's validity."""


class ValidityError(ParameterError, ArithmeticError):
    """A value at which a model or a law no longer holds; along a branch, where the branch ends.

    As an ArithmeticError it shortens a step that went too far, where one was taken.
    """


class ConvergenceError(RacsBifError, ArithmeticError):
    """An iteration that did not reach its tolerance."""


class FileError(RacsBifError, OSError):
    """A file that cannot be read or written."""


def nearest(name: str, known: Iterable[str]) -> str:
    """Say which known name is meant, or which there are.

    Parameters
    ----------
    name : str
        What the user wrote.
    known : iterable of str
        What there is.

    Returns
    -------
    str
        ``"did you mean 'x'?"`` where a name is close, otherwise a list of all names.

    Examples
    --------
    >>> nearest("alhpa", ["alpha", "gamma"])
    "did you mean 'alpha'?"
    >>> nearest("zz", ["alpha", "gamma"])
    'there are: alpha, gamma'
    """
    names = list(known)
    lowered = {known_name.lower(): known_name for known_name in names}
    close = difflib.get_close_matches(name.lower(), list(lowered), n=1, cutoff=0.6)
    if close:
        return f"did you mean '{lowered[close[0]]}'?"
    return "there are: " + ", ".join(names) if names else "there are none"
