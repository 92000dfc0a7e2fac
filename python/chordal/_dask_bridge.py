"""`python -m chordal._dask_bridge ADDRESS`: the jobs of a batch, lines on stdin, done by the workers of a Dask cluster; their
ends, lines on stdout. The batch starts it, and it ends with the batch."""

from __future__ import annotations

import asyncio
import concurrent.futures
import contextlib
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
from chordal._libraries import library

#: The most time for a connection. Defined: a scheduler answers in far less, and another call asks again.
_CONNECT_S: Final = 5
#: How often the workers are counted. Defined: well below the time that a worker takes to start.
_COUNT_S: Final = 1.0
#: The most time for saying good-bye. Defined: the scheduler notices it otherwise, too.
_CLOSE_S: Final = 3
#: How often a job is given out again that its worker let go of. Defined: as Dask does where a worker dies.
_TRIES: Final = 4


class Bridge:
    """The batch on one side, a client of a scheduler on the other."""

    def __init__(self, client: Any, address: str, out: int) -> None:
        self._client: Final = client
        self._address: Final = address
        self._out: Final = out
        self._running: Final[set[asyncio.Task[None]]] = set()
        self._is_over = False

    async def count(self) -> None:
        """Says how many threads all workers have, now and whenever that changes."""
        before = -1
        while True:
            try:
                slots = sum((await self._client.nthreads()).values())
            except Exception as error:
                # The batch waits for the first number. Later, without a connection, each job says so.
                if before < 0:
                    told = f"{type(error).__name__}: {error}"
                    _say(self._out, fault=f"{self._address}: the Dask scheduler tells of no workers ({told})")
                    return
            else:
                if slots != before:
                    before = slots
                    _say(self._out, slots=slots)
            await asyncio.sleep(_COUNT_S)

    def begin(self, line: bytes) -> None:
        """Gives a job to the cluster."""
        task = asyncio.get_running_loop().create_task(self._do(json.loads(line)))
        self._running.add(task)
        task.add_done_callback(self._running.discard)

    async def _do(self, job: dict[str, Any]) -> None:
        ended = None
        try:
            for _ in range(_TRIES):
                ended = await self._client.submit(do_job, job, pure=False)
                if ended is not None and os.path.exists(ended.get("unseen", ".")):
                    break
                # It is gone here, too: no matter of the worker.
                if ended is not None:
                    job["is_there"] = False
            line = _ended(job, ended)
        except (asyncio.CancelledError, concurrent.futures.CancelledError):
            line = {"fault": f"{self._address}: the Dask scheduler is gone, or has given up the files of this batch"}
        except Exception as error:
            line = _failed(job["number"], error)
        if not self._is_over:
            _say(self._out, **line)

    async def end(self) -> None:
        """Lets go of all jobs: their workers end them."""
        self._is_over = True
        for task in list(self._running):
            task.cancel()
        with contextlib.suppress(Exception):
            await asyncio.wait_for(self._client.close(), _CLOSE_S)


def _say(out: int, **line: Any) -> None:
    """One line to the batch; where that is gone, stdin ends as well. Parts of names that are no text are question marks."""
    plain = {name: value.encode(errors="replace").decode() if isinstance(value, str) else value for name, value in line.items()}
    data = json.dumps(plain).encode() + b"\n"
    with contextlib.suppress(OSError):
        while data:
            data = data[os.write(out, data) :]


def _ended(job: dict[str, Any], ended: dict[str, Any] | None) -> dict[str, Any]:
    number = job["number"]
    if ended is None:
        return {"job": number, "exit": None, "why": f"{_TRIES} workers were closed while they did it", "code": "killed-worker"}
    return ended if "fault" in ended else {"job": number, **ended}


def _failed(number: int, error: Exception) -> dict[str, Any]:
    """What to say of a job whose task did not come to an end of its own."""
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
        distributed = library("distributed")
        client = await distributed.Client(address, asynchronous=True, timeout=_CONNECT_S, set_as_default=False)
    except ImportError as error:
        _say(out, fault=f"Dask's distributed cannot be imported: {error}; it is installed by: pip install distributed")
        return
    except Exception as error:
        _say(out, fault=f"{address}: no Dask scheduler answers there ({type(error).__name__}: {error})")
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
    # What Dask logs is not told: whatever matters is said in a line. What it prints goes to stderr.
    warnings.simplefilter("ignore")
    logging.disable(logging.CRITICAL)
    out = os.dup(1)
    os.dup2(2, 1)
    asyncio.run(_serve(sys.argv[1], out))
    # Threads of the client, which have nothing more to do, hold nobody up.
    os._exit(0)


if __name__ == "__main__":
    main()
