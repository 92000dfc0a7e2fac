"""`Workers`: runs tasks in this process, in the processes of an executor, or on a Dask cluster."""

from __future__ import annotations

import importlib
import os
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, wait
from typing import Any, Final, TypeVar

from chordal._errors import Error

Key = TypeVar("Key")
#: A task: its key, its name in messages, and the arguments of its function; or a function that returns them when the task
#: begins, since the arguments of many tasks may exceed memory.
Task = tuple[Key, str, tuple[Any, ...] | Callable[[], tuple[Any, ...]]]


class Workers:
    """Runs functions on arguments. Used in a `with`, which closes the connection that it opened."""

    def __init__(self, executor: Any | None, cluster: str | None) -> None:
        if cluster is not None and executor is not None:
            raise TypeError("executor, cluster: give one of them")
        self._is_own: Final = cluster is not None
        self._executor: Final[Any] = importlib.import_module("distributed").Client(cluster) if cluster is not None else executor
        self._is_dask: Final = hasattr(self._executor, "scheduler_info")

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, *error: object) -> None:
        if self._is_own:
            self._executor.close()

    def shared(self, value: Any) -> Any:
        """A value for many tasks. Samples in memory are sent once to each worker of a cluster, instead of with every task."""
        if self._is_dask and hasattr(value, "__array_interface__"):
            return self._executor.scatter(value, broadcast=True)
        return value

    def run(self, ready: list[Task[Key]], call: Callable[..., bytes]) -> Iterator[tuple[Key, bytes]]:
        """The results of `call` for each task, as they finish. The last task of `ready` is begun first, and the consumer may
        append more tasks between results. Few more tasks are submitted than can run at once, so that results do not pile
        up."""
        if self._executor is None:
            while ready:
                key, name, source = ready.pop()
                arguments = source() if callable(source) else source
                yield key, _checked(name, lambda arguments=arguments: call(*arguments))  # type: ignore[misc]
            return
        running: dict[Any, tuple[Key, str]] = {}
        try:
            while ready or running:
                # A cluster grows and shrinks, but asking for its size takes as long as a small task: once a round will do.
                most = 2 * self._at_once()
                while ready and len(running) < most:
                    key, name, source = ready.pop()
                    running[self._executor.submit(call, *(source() if callable(source) else source))] = (key, name)
                for future in self._done(list(running)):
                    key, name = running.pop(future)
                    yield key, _checked(name, future.result)
        # Also if the consumer stops before the last result.
        finally:
            for future in running:
                future.cancel()

    def _done(self, running: list[Any]) -> Any:
        if self._is_dask:
            return importlib.import_module("distributed").wait(running, return_when="FIRST_COMPLETED").done
        return wait(running, return_when=FIRST_COMPLETED).done

    def _at_once(self) -> int:
        """The number of tasks that run at once, as far as the executor states it."""
        if self._is_dask:
            # The threads of all workers that are there now.
            return max(1, sum(int(threads) for threads in self._executor.nthreads().values()))
        return int(getattr(self._executor, "_max_workers", None) or os.cpu_count() or 1)


def _checked(name: str, result: Callable[[], bytes]) -> bytes:
    """The result of a worker. Other exceptions, as of a worker that was killed repeatedly, become an `Error` that names the task."""
    try:
        return result()
    except (Error, MemoryError):
        raise
    except Exception as error:
        raise Error(f"{name} was not done: {type(error).__name__}: {error}") from error
