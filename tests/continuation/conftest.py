"""Problems with exact solutions, and the textbook's detectors."""

from types import SimpleNamespace

import numpy as np
import pytest

from racs_bif.continuation import Detector, Problem


class Scalar(Problem):
    """One equation f(x, p) = 0 with its derivatives; counts its residuals."""

    name = "scalar"
    parameter = "p"

    def __init__(self, f, f_x, f_p, *, spectral=True):
        self.f, self.f_x, self.f_p, self.spectral = f, f_x, f_p, spectral
        self.residuals = 0

    def residual(self, z):
        self.residuals += 1
        return np.array([self.f(z[0], z[1])])

    def jacobian(self, z):
        return np.array([[self.f_x(z[0], z[1]), self.f_p(z[0], z[1])]])

    def spectrum(self, z):
        if not self.spectral:
            return super().spectrum(z)
        return np.array([self.f_x(z[0], z[1])], dtype=complex)

    def measures(self, z):
        return {"x": float(z[0])}


class Pairs(Problem):
    """x = sin p with prescribed complex pairs; pair k has the frequency k + 1."""

    name = "pairs"
    parameter = "p"

    def __init__(self, *real_parts):
        self.real_parts = real_parts

    def residual(self, z):
        return np.array([z[0] - np.sin(z[1])])

    def jacobian(self, z):
        return np.array([[1.0, -np.cos(z[1])]])

    def spectrum(self, z):
        upper = [real(z[1]) + 1j * (k + 1) for k, real in enumerate(self.real_parts)]
        return np.array([*upper, *np.conj(upper)])


class Fold(Detector):
    label = "LP"
    crossings = 1

    def value(self, problem, point):
        return point.tangent[-1]

    def data(self, problem, point):
        return {}


class BranchPoint(Detector):
    label = "BP"
    crossings = 1

    def value(self, problem, point):
        return np.linalg.det(np.vstack([problem.jacobian(point.z), point.tangent]))

    def data(self, problem, point):
        return {}


class Hopf(Detector):
    """The product of all real parts of upper eigenvalues."""

    label = "H"
    crossings = 2

    def value(self, problem, point):
        return np.prod(point.spectrum.real[point.spectrum.imag > 0])

    def data(self, problem, point):
        nearest = point.spectrum[np.argmin(np.abs(point.spectrum.real))]
        return {"omega": abs(nearest.imag)}


class Given(Detector):
    """A test function given as f(z)."""

    label = "G"

    def __init__(self, function):
        self.function = function

    def value(self, problem, point):
        return self.function(point.z)

    def data(self, problem, point):
        return {}


@pytest.fixture
def kinds():
    """The classes of this file."""
    return SimpleNamespace(
        Scalar=Scalar, Pairs=Pairs, Fold=Fold, BranchPoint=BranchPoint, Hopf=Hopf, Given=Given
    )


@pytest.fixture
def circle():
    return Scalar(
        lambda x, p: x * x + p * p - 1, lambda x, p: 2 * x, lambda x, p: 2 * p, spectral=False
    )


@pytest.fixture
def fold():
    return Scalar(lambda x, p: p - x * x, lambda x, p: -2 * x, lambda x, p: 1.0)


@pytest.fixture
def line():
    """The straight branch x = p."""
    return Scalar(lambda x, p: x - p, lambda x, p: 1.0, lambda x, p: -1.0, spectral=False)
