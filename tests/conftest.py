"""Settings for every test, made before numpy is imported."""

import importlib
import os
import shutil
import tempfile
from pathlib import Path

# BLAS reads these when it is loaded: threads only cost time on matrices as small as ours.
for _variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_variable] = "1"
os.environ["MPLBACKEND"] = "Agg"
os.environ["NO_COLOR"] = "1"
# The user's own folders and compiled models stay out of the tests.
os.environ.pop("RACS_BIF_PATH", None)
_CACHE = tempfile.mkdtemp(prefix="racs-bif-tests-")
os.environ["RACS_BIF_CACHE"] = _CACHE

import pytest  # noqa: E402
from hypothesis import settings  # noqa: E402  # it may import numpy

# No deadline: a busy machine is not a mistake. The same examples in every run.
settings.register_profile("racs_bif", deadline=None, derandomize=True)
settings.load_profile("racs_bif")


@pytest.fixture(scope="session")
def benchmark_module():
    """Import a benchmark: they are scripts beside the package, at the root of the project."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(Path(__file__).parents[1]))
        yield lambda name: importlib.import_module(f"benchmarks.{name}")


def pytest_unconfigure():
    shutil.rmtree(_CACHE, ignore_errors=True)
