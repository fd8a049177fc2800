"""Tasks on an existing Dask cluster (extra ``cluster``)."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

from racs_bif.charts.backends import Backend, Done_co, Job, compute
from racs_bif.errors import ConvergenceError, UsageError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

_AHEAD = 3
_RETRIES = 3
_PATIENCE = 20.0


class DaskCluster(Backend):
    """The workers of a Dask scheduler; a task whose worker dies goes to another.

    Workers need racs_bif installed in the same version.

    Parameters
    ----------
    address : str
        Of the scheduler, ``tcp://host:port``.

    Raises
    ------
    UsageError
        If dask.distributed is not installed.
    """

    def __init__(self, address: str) -> None:
        self.address = address
        try:
            import distributed
        except ImportError:
            msg = "a scheduler needs dask.distributed: pip install 'racs-bif[cluster]'"
            raise UsageError(msg) from None
        self._dask: Any = distributed

    def run(self, job: Job[Done_co], tiles: Sequence[int]) -> Iterator[tuple[int, Done_co]]:
        """Yield what every task gives, with its number, as it is done.

        Raises
        ------
        UsageError
            If no scheduler answers at the address.
        ConvergenceError
            If the cluster gives a task up.
        """
        try:
            client = self._dask.Client(self.address, timeout=_PATIENCE, set_as_default=False)
        except (OSError, ValueError) as error:
            msg = f"no Dask scheduler answers at '{self.address}'; check the address ({error})"
            raise UsageError(msg) from None
        with client:
            yield from self._run(client, job, tiles)

    def _run(
        self,
        client: Any,  # noqa: ANN401 - has no types
        job: Job[Done_co],
        tiles: Sequence[int],
    ) -> Iterator[tuple[int, Done_co]]:
        waiting = iter(tiles)
        # Not scattered: data held by one worker alone would be lost with it.
        sent = client.submit(_same, job, pure=False, retries=_RETRIES)

        def hand(index: int) -> Any:  # noqa: ANN401 - as above
            return client.submit(compute, sent, index, pure=False, retries=_RETRIES)

        ahead = _AHEAD * max(len(client.scheduler_info()["workers"]), 1)
        numbers = {}
        for index in itertools.islice(waiting, ahead):
            numbers[hand(index)] = index
        running = self._dask.as_completed(list(numbers), loop=client.loop)
        for future in running:
            index = numbers.pop(future)
            try:
                tile = future.result()
            except Exception as error:
                msg = (
                    f"the cluster gave up task {index}: {type(error).__name__}: {error}; see that "
                    "its workers have this racs_bif, then go on with --resume"
                )
                raise ConvergenceError(msg) from error
            yield index, tile
            future.release()
            following = next(waiting, None)
            if following is not None:
                new = hand(following)
                numbers[new] = following
                running.add(new)


def _same(job: Job[Done_co]) -> Job[Done_co]:
    return job
