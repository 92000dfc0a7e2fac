"""`Workers`: where tasks are done: here, in the processes of an executor, or on a Dask cluster."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, wait
from typing import Any, Final, TypeVar

from chordal._errors import Error
from chordal._libraries import library

Key = TypeVar("Key")
#: A task: what it is known by, what it is called in messages, and the arguments of its function, or what gives them when it
#: is begun: those of many tasks together may be more than memory.
Task = tuple[Key, str, tuple[Any, ...] | Callable[[], tuple[Any, ...]]]


class Workers:
    """Runs functions on arguments; used in a `with`, since a connection that it opened is closed after it."""

    def __init__(self, executor: Any | None, cluster: str | None) -> None:
        if cluster is not None and executor is not None:
            raise TypeError("executor, cluster: give one of them")
        self._is_own: Final = cluster is not None
        self._executor: Final[Any] = library("distributed").Client(cluster) if cluster is not None else executor
        self._is_dask: Final = hasattr(self._executor, "scheduler_info")

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, *error: object) -> None:
        if self._is_own:
            self._executor.close()

    def shared(self, value: Any) -> Any:
        """A value for many tasks. Samples in memory are sent once to each worker of a cluster, and not with every task."""
        if self._is_dask and hasattr(value, "__array_interface__"):
            return self._executor.scatter(value, broadcast=True)
        return value

    def run(self, ready: list[Task[Key]], call: Callable[..., bytes]) -> Iterator[tuple[Key, bytes]]:
        """What `call` makes of each task, as they are done. The last of `ready` is begun first, and whoever takes a result
        may append more. Few more run at a time than can at once, so that results do not pile up."""
        if self._executor is None:
            while ready:
                key, name, given = ready.pop()
                arguments = given() if callable(given) else given
                yield key, _checked(name, lambda arguments=arguments: call(*arguments))  # type: ignore[misc]
            return
        running: dict[Any, tuple[Key, str]] = {}
        try:
            while ready or running:
                # A cluster grows and shrinks; to ask it takes as long as a small task, so not for each.
                most = 2 * self._at_once()
                while ready and len(running) < most:
                    key, name, given = ready.pop()
                    running[self._executor.submit(call, *(given() if callable(given) else given))] = (key, name)
                for future in self._done(list(running)):
                    key, name = running.pop(future)
                    yield key, _checked(name, future.result)
        finally:
            for future in running:
                future.cancel()

    def _done(self, running: list[Any]) -> Any:
        if self._is_dask:
            return library("distributed").wait(running, return_when="FIRST_COMPLETED").done
        return wait(running, return_when=FIRST_COMPLETED).done

    def _at_once(self) -> int:
        """How many tasks it does at once, as far as it says."""
        if self._is_dask:
            # Of all workers, as many as there are now.
            return max(1, sum(int(threads) for threads in self._executor.nthreads().values()))
        return int(getattr(self._executor, "_max_workers", None) or os.cpu_count() or 1)


def _checked(name: str, result: Callable[[], bytes]) -> bytes:
    """What a worker made; where it was killed again and again, an `Error` that says which block that was."""
    try:
        return result()
    except (Error, MemoryError):
        raise
    except Exception as error:
        raise Error(f"{name} was not done: {type(error).__name__}: {error}") from error
