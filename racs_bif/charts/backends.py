"""Where independent tasks are computed: here, in processes of this machine, or on a cluster."""

from __future__ import annotations

import itertools
from abc import ABC, abstractmethod
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from racs_bif.errors import ConvergenceError, UsageError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from concurrent.futures import Future

Done_co = TypeVar("Done_co", covariant=True)
"""What a task gives."""
_AHEAD = 2
"""Tasks handed out to each worker before any has come back: memory stays bounded."""
_DEATHS = 3


class Job(Protocol[Done_co]):
    """Numbered tasks that do not depend on each other; must be picklable, and what they give too.

    Those of a map are its tiles.
    """

    def compute(self, index: int) -> Done_co:
        """Do one task."""


def compute(job: Job[Done_co], index: int) -> Done_co:
    """Do one task of a job."""
    return job.compute(index)


class Backend(ABC):
    """Does tasks, in any order."""

    @abstractmethod
    def run(self, job: Job[Done_co], tiles: Sequence[int]) -> Iterator[tuple[int, Done_co]]:
        """Yield what every task gives, with its number, as it is done."""


class InProcess(Backend):
    """One task after another, here."""

    def run(self, job: Job[Done_co], tiles: Sequence[int]) -> Iterator[tuple[int, Done_co]]:
        """Yield what every task gives, with its number."""
        for index in tiles:
            yield index, compute(job, index)


class LocalProcesses(Backend):
    """Processes of this machine, started afresh so that every platform behaves alike.

    A script that uses it needs ``if __name__ == "__main__":`` around what it runs.

    Parameters
    ----------
    workers : int
        How many.

    Raises
    ------
    UsageError
        If there are none.
    """

    def __init__(self, workers: int) -> None:
        if workers < 1:
            msg = f"at least one worker is needed, not {workers}; give workers=1 or more"
            raise UsageError(msg)
        self.workers = workers

    def run(self, job: Job[Done_co], tiles: Sequence[int]) -> Iterator[tuple[int, Done_co]]:
        """Yield what every task gives, with its number, as it is done.

        Raises
        ------
        ConvergenceError
            If workers keep dying.
        """
        left = dict.fromkeys(tiles)
        for death in range(_DEATHS):
            try:
                for index, tile in self._run(job, list(left)):
                    del left[index]
                    yield index, tile
            except BrokenProcessPool:
                if death < _DEATHS - 1:
                    continue
                msg = (
                    f"worker processes died {_DEATHS} times, for want of memory perhaps; go on "
                    "with --resume and fewer --workers"
                )
                raise ConvergenceError(msg) from None
            return

    def _run(self, job: Job[Done_co], tiles: list[int]) -> Iterator[tuple[int, Done_co]]:
        waiting = iter(tiles)
        pool = ProcessPoolExecutor(
            self.workers, mp_context=get_context("spawn"), initializer=_receive, initargs=(job,)
        )
        try:
            running: dict[Future[Any], int] = {}
            for index in itertools.islice(waiting, _AHEAD * self.workers):
                running[pool.submit(_compute, index)] = index
            while running:
                done, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in done:
                    index = running.pop(future)
                    yield index, future.result()
                    following = next(waiting, None)
                    if following is not None:
                        running[pool.submit(_compute, following)] = following
            pool.shutdown()
        finally:
            # What is still running when the caller gives up is not waited for.
            pool.shutdown(wait=False, cancel_futures=True)


_job: Job[Any] | None = None


def _receive(job: Job[Any]) -> None:
    """Keep the job in a worker, which then gets numbers of tiles only."""
    global _job  # noqa: PLW0603 - a process of its own
    _job = job


def _compute(index: int) -> Any:  # noqa: ANN401 - whatever the job gives
    assert _job is not None  # `_receive` ran first
    return compute(_job, index)


def choose_backend(workers: int = 0, scheduler: str | None = None) -> Backend:
    """Return the backend that a user asked for.

    Parameters
    ----------
    workers : int
        Processes on this machine; 0 or 1 computes here.
    scheduler : str, optional
        Address of a Dask scheduler.

    Raises
    ------
    UsageError
        If both are given, or the number is negative.
    """
    if scheduler is not None:
        if workers:
            msg = "give either workers or a scheduler, not both"
            raise UsageError(msg)
        from racs_bif.charts.cluster import DaskCluster

        return DaskCluster(scheduler)
    if workers < 0:
        msg = f"the number of workers is {workers}; give 0 or more"
        raise UsageError(msg)
    return LocalProcesses(workers) if workers > 1 else InProcess()
