"""Runs of pytest in forked processes, of the package as it is or with one module changed.

The parent has imported all that the tests need but the package itself: a child is at its first test
in a fraction of a second. Its clock is its own processor time, so that a busy machine makes nothing
"too long"; when a test has used up its share, the system ends the child.
"""

from __future__ import annotations

import compileall
import gc
import math
import os
import resource
import signal
import sys
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from importlib import import_module
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, SourceFileLoader
from importlib.util import spec_from_file_location
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import CodeType

HERE: Final = Path(__file__).resolve().parents[1]
AT_FIRST: Final = 10.0
"""Processor seconds that the imports may take."""
AT_WORST: Final = 900
"""Seconds after which a child is ended that waits for something."""
MEMORY: Final = 6 * 2**30
"""Bytes a child may have: a loop that fills the memory is stopped."""
BROKEN: Final = (3, 4)
"""Exit codes of pytest itself: an error in it, and fixtures that cannot be imported."""
ALWAYS: Final = (
    *("-q", "-x", "--tb=no", "--no-header", "-p", "no:cacheprovider", "-p", "no:xdist"),
    *("--assert=plain", "-p", "no:cov", "-o", "addopts=--import-mode=importlib"),
)


class Watch:
    """A pytest plugin: which tests are run in which order, how long each may take, what it did.

    Parameters
    ----------
    tell
        Called with one line at each event.
    cache
        Folder of compiled models; mutants do not change what is in it.
    shares
        Processor seconds that each test may take, in the order in which they are to be run; None
        for all the tests there are.
    began
        Called with each test's identity before it is run.
    until
        Processor seconds of the child after which no test is begun: mutants may be slow.
    """

    def __init__(
        self,
        tell: Callable[[str], None],
        cache: Path,
        shares: Mapping[str, float] | None = None,
        began: Callable[[str], object] = lambda _: None,
        until: float = math.inf,
    ) -> None:
        self.tell, self.cache, self.shares, self.began = tell, cache, shares, began
        self.until = until

    def pytest_sessionstart(self, session: Any) -> None:  # noqa: ANN401  # pytest is not imported
        """Keep compiled models from one child to the next; a failure need not be made small."""
        self.session = session
        os.environ["RACS_BIF_CACHE"] = str(self.cache)
        hypothesis = import_module("hypothesis")
        phases = (hypothesis.Phase.explicit, hypothesis.Phase.generate)
        hypothesis.settings.register_profile("mutants", hypothesis.settings(), phases=phases)
        hypothesis.settings.load_profile("mutants")

    def pytest_collection_modifyitems(self, items: list[Any]) -> None:
        """Keep the tests that are wanted, in their order."""
        if self.shares is not None:
            place = {name: k for k, name in enumerate(self.shares)}
            items[:] = sorted(
                (item for item in items if item.nodeid in place), key=lambda i: place[i.nodeid]
            )

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        """Start a test's clock."""
        self.tell(f"began {nodeid}")
        if self.shares is not None:
            signal.setitimer(signal.ITIMER_PROF, self.shares[nodeid])
        self.began(nodeid)
        self.since = time.process_time()

    def pytest_runtest_logfinish(self, nodeid: str) -> None:
        """Tell how long it was."""
        self.tell(f"spent {time.process_time() - self.since:.4f} {nodeid}")
        if time.process_time() > self.until:
            self.session.shouldstop = "no time is left"

    def pytest_runtest_logreport(self, report: Any) -> None:  # noqa: ANN401
        """Tell of a failure."""
        if report.failed:
            self.tell(f"failed {report.nodeid}")

    def pytest_collectreport(self, report: Any) -> None:  # noqa: ANN401
        """Tell of a file that cannot be imported."""
        if report.failed:
            self.tell(f"failed {report.nodeid or 'import'}")


class Changed(MetaPathFinder):
    """Imports one module from the code given; its file is not touched."""

    def __init__(self, name: str, path: Path, code: CodeType) -> None:
        self._name, self._path, self._code = name, path, code

    def find_spec(self, fullname: str, *_: object) -> ModuleSpec | None:
        """Find the one module."""
        if fullname != self._name:
            return None
        loader = _Loader(fullname, str(self._path))
        loader.code = self._code
        return spec_from_file_location(fullname, self._path, loader=loader)


class _Loader(SourceFileLoader):
    code: CodeType

    def get_code(self, fullname: str) -> CodeType:  # there is one module only
        return self.code


def ready(names: Iterable[str]) -> None:
    """Import what the tests will need, and keep it out of the way of garbage collection."""
    for name in ("racs_bif", "tests"):
        compileall.compile_dir(HERE / name, quiet=1)
    for name in ("OPENBLAS", "OMP", "MKL"):  # read when numpy is loaded: threads only cost time
        os.environ[f"{name}_NUM_THREADS"] = "1"
    os.environ["MPLBACKEND"] = "Agg"
    for name in ("pytest", "hypothesis", "numpy", "scipy", "sympy", *names):
        with suppress(Exception):  # what cannot be imported here, a test will import itself
            import_module(name)
    gc.collect()
    gc.freeze()


def pytest(files: Iterable[str], watch: Watch) -> int:
    """Run the tests of some files in this process, which is a child; return pytest's exit code."""
    code = int(import_module("pytest").main([*ALWAYS, *files], plugins=[watch]))
    if code in BROKEN:
        watch.tell("failed before its tests")
    return code


def in_child(work: Callable[[Callable[[str], None]], None]) -> Iterator[str]:
    """Do `work` in a child; yield the lines that it tells, the last being how it ended.

    Yields
    ------
    str
        A line told, and at last ``ended`` with the number of the signal, negative, or 0.
    """
    reading, writing = os.pipe()
    child = os.fork()
    if not child:
        os.close(reading)
        with _alone():
            work(lambda line: _write(writing, line))
    os.close(writing)
    with os.fdopen(reading, encoding="utf-8") as stream:
        for line in stream:
            yield line.rstrip("\n")
    _, status = os.waitpid(child, 0)
    yield f"ended {os.waitstatus_to_exitcode(status)}"


def without_end() -> None:
    """Let this child take what time it needs."""
    signal.setitimer(signal.ITIMER_PROF, 0.0)
    signal.alarm(0)


def _write(to: int, line: str) -> None:
    os.write(to, f"{line}\n".encode())


@contextmanager
def _alone() -> Iterator[None]:
    """Be a child: silent, bounded, gone at the end whatever happens."""
    status = 3
    try:
        nothing = os.open(os.devnull, os.O_RDWR)
        for stream in (0, 1, 2):
            os.dup2(nothing, stream)
        os.chdir(HERE)
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        signal.setitimer(signal.ITIMER_PROF, AT_FIRST)
        signal.alarm(AT_WORST)
        sys.path[:0] = [str(HERE)]
        yield
        status = 0
    finally:
        os._exit(status)
