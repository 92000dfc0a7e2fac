"""`python -m chordal._dask_bridge ADDRESS`: reads the jobs of a batch as lines from stdin, runs them on the workers of a Dask
cluster, and writes their results as lines to stdout. The batch starts it, and it ends with the batch."""

from __future__ import annotations

import asyncio
import concurrent.futures
import contextlib
import importlib
import json
import logging
import os
import signal
import sys
import threading
import warnings
from typing import Any, Final

from chordal._batch_job import do_job
from chordal._chordal import VERSION

#: The timeout of a connection. Defined: a scheduler answers in far less, and another call tries again.
_CONNECT_S: Final = 5
#: How often the workers are counted. Defined: well below the time that a worker takes to start.
_COUNT_S: Final = 1.0
#: The timeout for closing the connection. Defined: the scheduler notices the end of the client in any case.
_CLOSE_S: Final = 3
#: How often a job is submitted if its worker gives it up. Defined: as Dask does if a worker dies.
_TRIES: Final = 4


class Bridge:
    """Connects a batch with the client of a scheduler."""

    def __init__(self, client: Any, address: str, out: int) -> None:
        self._client: Final = client
        self._address: Final = address
        self._out: Final = out
        self._running: Final[set[asyncio.Task[None]]] = set()
        self._is_over = False

    async def count(self) -> None:
        """Reports the number of threads of all workers, now and whenever it changes."""
        last_slots = -1
        while True:
            try:
                slots = sum((await self._client.nthreads()).values())
            except Exception as error:
                # The batch waits for the first number. A later loss of the connection is reported by each job.
                if last_slots < 0:
                    reason = f"{type(error).__name__}: {error}"
                    _send(self._out, fault=f"{self._address}: the Dask scheduler tells of no workers ({reason})")
                    return
            else:
                if slots != last_slots:
                    last_slots = slots
                    _send(self._out, slots=slots)
            await asyncio.sleep(_COUNT_S)

    def begin(self, line: bytes) -> None:
        """Submits a job to the cluster."""
        task = asyncio.get_running_loop().create_task(self._do(json.loads(line)))
        self._running.add(task)
        task.add_done_callback(self._running.discard)

    async def _do(self, job: dict[str, Any]) -> None:
        result = None
        try:
            for _ in range(_TRIES):
                result = await self._client.submit(do_job, job, pure=False)
                if result is not None and os.path.exists(result.get("unseen", ".")):
                    break
                # The input that the worker does not see is gone here, too: the command itself will report it.
                if result is not None:
                    job["is_there"] = False
            line = _line_of(job, result)
        except (asyncio.CancelledError, concurrent.futures.CancelledError):
            line = {"fault": f"{self._address}: the Dask scheduler is gone, or has given up the files of this batch"}
        except Exception as error:
            line = _failed(job["number"], error)
        if not self._is_over:
            _send(self._out, **line)

    async def end(self) -> None:
        """Cancels all jobs, which makes their workers end them."""
        self._is_over = True
        for task in list(self._running):
            task.cancel()
        with contextlib.suppress(Exception):
            await asyncio.wait_for(self._client.close(), _CLOSE_S)


def _send(out: int, **line: Any) -> None:
    """Sends a line to the batch. If the batch is gone, the error is ignored, since stdin ends as well. Characters of names that
    are not valid text become question marks."""
    plain = {name: value.encode(errors="replace").decode() if isinstance(value, str) else value for name, value in line.items()}
    data = json.dumps(plain).encode() + b"\n"
    with contextlib.suppress(OSError):
        while data:
            data = data[os.write(out, data) :]


def _line_of(job: dict[str, Any], result: dict[str, Any] | None) -> dict[str, Any]:
    """The line for the result of a job."""
    number = job["number"]
    if result is None:
        return {"job": number, "exit": None, "why": f"{_TRIES} workers were closed while they did it", "code": "killed-worker"}
    return result if "fault" in result else {"job": number, **result}


def _failed(number: int, error: Exception) -> dict[str, Any]:
    """The line for a job whose task raised an exception."""
    if type(error).__name__ == "KilledWorker":
        worker: Any = getattr(error, "last_worker", None)
        name = getattr(worker, "address", worker)
        n = getattr(error, "allowed_failures", 0) + 1
        sentence = f"the workers that did it were killed ({n} of them, the last one {name})"
        return {"job": number, "exit": None, "why": sentence, "code": "killed-worker"}
    if isinstance(error, ImportError):
        return {"fault": f"a worker cannot import Chordal {VERSION}: {error}"}
    return {"fault": f"the cluster does not do files: {type(error).__name__}: {error}"}


async def _serve(address: str, out: int) -> None:
    try:
        distributed = importlib.import_module("distributed")
        client = await distributed.Client(address, asynchronous=True, timeout=_CONNECT_S, set_as_default=False)
    except ImportError as error:
        _send(out, fault=f"Dask's distributed cannot be imported: {error}; it is installed by: pip install distributed")
        return
    except Exception as error:
        _send(out, fault=f"{address}: no Dask scheduler answers there ({type(error).__name__}: {error})")
        return
    bridge = Bridge(client, address, out)
    loop = asyncio.get_running_loop()
    ended = asyncio.Event()

    def read() -> None:
        for line in sys.stdin.buffer:
            loop.call_soon_threadsafe(bridge.begin, line)
        loop.call_soon_threadsafe(ended.set)

    counting = loop.create_task(bridge.count())
    threading.Thread(target=read, daemon=True).start()
    await ended.wait()
    counting.cancel()
    await bridge.end()


def main() -> None:
    """Runs until stdin ends."""
    # Ctrl-C is for the batch, which ends this process.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # Logs of Dask are dropped, since every result and error is sent as a line. Its prints go to stderr, so that stdout has nothing
    # but lines.
    warnings.simplefilter("ignore")
    logging.disable(logging.CRITICAL)
    out = os.dup(1)
    os.dup2(2, 1)
    asyncio.run(_serve(sys.argv[1], out))
    # Ends the process without waiting for idle threads of the client.
    os._exit(0)


if __name__ == "__main__":
    main()
