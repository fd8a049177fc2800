"""What to say of a user's function that failed."""

from __future__ import annotations

import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.symbolic.arguments import Arguments

_MOST = 6


def undefined(error: BaseException) -> bool:
    """Say whether an error means that the function has no value there, as 1/0 and log(-1) have."""
    if isinstance(error, ArithmeticError):
        return True
    words = str(error)
    return type(error) is ValueError and (
        words == "math domain error" or words.startswith(("math range error", "expected a "))
    )


def complaint(arguments: Arguments, error: BaseException, numbers: NDArray[Any]) -> str:
    """Say in one line which function failed, where in it, at which numbers, and how."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [f for f in frames if "racs_bif/symbolic" not in Path(f.filename).as_posix()]
    place = f", line {own[-1].lineno} of {Path(own[-1].filename).name}," if own else ""
    named = zip(arguments.names, numbers.tolist(), strict=True)
    told = [f"{name} = {value:.6g}" for name, value in named]
    at = ", ".join(told[:_MOST]) + (", ..." if len(told) > _MOST else "")
    words = " ".join(str(error).split())
    what = f"{type(error).__name__} at {at}: {words}".rstrip(": ")
    function = f"model '{arguments.model}': the function '{arguments.function}'{place}"
    return f"{function} raises {what}; make it return numbers there"
