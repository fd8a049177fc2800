"""Settings of a chart."""

from __future__ import annotations

from dataclasses import dataclass

from racs_bif.errors import UsageError

_DEEPEST = 12


@dataclass(frozen=True, kw_only=True)
class ChartSettings:
    """How finely a plane is searched; boundaries themselves are exact however coarse it is.

    Parameters
    ----------
    coarse : int
        The search starts on 2**coarse by 2**coarse cells.
    depth : int
        Cells that may hide a boundary are divided down to 2**depth by 2**depth. An island that is
        smaller than these, and steep, may be missed; and one narrower than a quarter of the first
        cells beside another boundary.
    step : float
        Largest step along a boundary, of a span.
    angle : float
        Largest turn of a boundary in a step, rad.

    Raises
    ------
    UsageError
        If a setting is out of its range.
    """

    coarse: int = 4
    depth: int = 7
    step: float = 1 / 40
    angle: float = 0.2

    def __post_init__(self) -> None:
        """Check the ranges."""
        if not 1 <= self.coarse <= self.depth <= _DEEPEST:
            msg = (
                f"chart settings must obey 1 <= coarse <= depth <= {_DEEPEST}, here coarse = "
                f"{self.coarse} and depth = {self.depth}"
            )
            raise UsageError(msg)
        for name in ("step", "angle"):
            value = getattr(self, name)
            if not 0.0 < value <= 0.5:
                msg = f"chart setting '{name}' must be above 0 and at most 0.5, not {value!r}"
                raise UsageError(msg)
