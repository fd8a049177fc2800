"""Curves of folds of the exact model, on its equilibrium equations."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.equilibria.curve_problem import Measures, Span, critical_first
from racs_bif.equilibria.fold_curve import FoldCurve

if TYPE_CHECKING:
    from racs_bif.continuation.points import Array, Spectrum
    from racs_bif.fractional.realised import RealisedField
    from racs_bif.fractional.static import StaticField
    from racs_bif.symbolic.paths import ParameterPath


class ExactFoldCurve(FoldCurve):
    """Folds of the exact model, det Delta(0) = 0; ``z = (y, w, lambda_1, lambda_2)``.

    Other eigenvalues, and coefficients of normal forms, are those of the realisation at rest there.

    Parameters
    ----------
    static : StaticField
        The equilibrium equations.
    realised : RealisedField
        The realisation.
    path, span, measures
        See `CurveProblem`.
    """

    name = "exact fold curve"

    def __init__(
        self,
        static: StaticField,
        realised: RealisedField,
        path: ParameterPath,
        span: Span,
        measures: Measures | None = None,
    ) -> None:
        own = len(realised.compiled.states)
        super().__init__(static, path, span, own, measures)
        self._realised = realised

    def realised(self, z: Array) -> tuple[RealisedField, Array, Array]:
        """Return the realised field, its states (n,) at rest, and the base parameters."""
        X, p = self.base(z)
        return self._realised, self.resting(self._realised, X, p), p

    def alignment(self, z: Array) -> float:
        """Return w . v of the realisation's unit null vectors, turned as those of Delta(0)."""
        field, x, p = self.realised(z)
        left, _, right = np.linalg.svd(field.f_x(x, p))
        v, w = self.null_vectors(z)
        own = self.own
        sense = np.sign((right[-1][:own] @ v[:own]) * (left[:own, -1] @ w[:own]))
        return float(sense * (left[:, -1] @ right[-1]))

    def spectrum(self, z: Array) -> Spectrum:
        """Return the eigenvalues of the realisation, the one that is zero all along first."""
        from scipy.linalg import eigvals

        field, x, p = self.realised(z)
        return critical_first(eigvals(field.f_x(x, p), check_finite=False), (0.0,))

    def measures(self, z: Array) -> dict[str, float]:
        """Return further quantities of the point, from the realisation at rest."""
        return {} if self._measures is None else self._measures(*self.realised(z)[1:])
