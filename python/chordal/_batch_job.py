"""`do_job`: one file of a batch on a worker of a cluster, in a process of its own that ends with the worker."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import time
import uuid
from typing import Any, Final, TypedDict

from chordal import _chordal
from chordal._batch_child import INTERRUPTED, start
from chordal._chordal import VERSION
from chordal._libraries import library

#: What a name is sent as: text, or its bytes where it is no Unicode.
Name = str | list[int]


class Job(TypedDict):
    """What a worker is told of a file. The command's own part of the bridge writes it, in `batch/bridge.rs`."""

    version: str
    #: Where the batch runs: names and options are relative to it.
    cwd: Name
    input: Name
    #: Whether the batch sees it; where not, the command says so.
    is_there: bool
    #: Where outputs are written. It is there as long as anybody waits for them.
    work: Name
    #: What the folder of this file begins with, and the output's name in it.
    number: int
    name: Name
    is_report: bool
    #: The words of the command before the output and behind it.
    head: list[Name]
    tail: list[Name]
    #: Whether the worker's share of memory is to be said.
    shares_memory: bool
    timeout: float | None


#: How often it is asked whether anybody still waits. Defined: an end after Ctrl-C that nobody waits for, a small cost.
_POLL_S: Final = 0.25
#: The share of the worker's memory that its processes have. Defined: the rest is for the worker itself.
_MEMORY_SHARE: Final = 0.75


def do_job(job: Job) -> dict[str, Any] | None:
    """How the command ended, in the words of `batch/bridge.rs`; `{"fault": …}` where this worker can do no file of the
    batch; None where it ended the command because nobody waits for it any more."""
    worker = library("distributed").get_worker()
    where = f"worker {worker.address} on {socket.gethostname()}"
    cwd, work = text(job["cwd"]), text(job["work"])
    if VERSION != job["version"]:
        return {"fault": f"{where} has Chordal {VERSION}, and this batch is of {job['version']}"}
    unseen = next((f"the folder {path}" for path in (cwd, work) if not os.path.isdir(path)), None)
    given = os.path.join(cwd, text(job["input"]))
    if unseen is None and job["is_there"] and not os.path.exists(given):
        unseen = f"the file {given}"
    if unseen is not None:
        return {"fault": f"{where} does not see {unseen}: all workers need the same files", "unseen": given}
    # A folder of this try alone: a worker that was given up may go on for a while.
    folder = os.path.join(work, f"{job['number']}.{uuid.uuid4().hex}")
    try:
        os.mkdir(folder)
    except OSError as error:
        return {"fault": f"{where} cannot write in {work}: {error.strerror}"}
    words = [text(word) for word in job["head"]]
    if not job["is_report"]:
        words += ["-o", os.path.join(folder, text(job["name"]))]
    if job["shares_memory"]:
        words += _memory_words(worker)
    words += [text(word) for word in job["tail"]]
    started = time.monotonic()
    ended = _run(words, cwd, job["timeout"], _Asker(worker, work))
    if ended is None or ended["exit"] is None:
        shutil.rmtree(folder, ignore_errors=True)
    if ended is None:
        return None
    if ended.get("exit") is not None:
        ended["folder"] = os.path.basename(folder)
    ended["seconds"] = time.monotonic() - started
    if ended.pop("was_ended", False):
        ended["why"] += f" on {socket.gethostname()}, as when memory runs out"
    return ended


def text(name: Name) -> str:
    """A name as Python has it."""
    return name if isinstance(name, str) else os.fsdecode(bytes(name))


def _memory_words(worker: Any) -> list[str]:
    """The share of one of the worker's threads in its memory: in the machine's, where the worker has no limit."""
    limit = worker.memory_manager.memory_limit or library("distributed.system").MEMORY_LIMIT
    return ["--max-memory", str(max(1, int(limit * _MEMORY_SHARE / max(1, worker.state.nthreads))))]


class _Asker:
    """Whether anybody waits for what this task makes: the batch, whose folder is there, and a client of the scheduler."""

    def __init__(self, worker: Any, work: str) -> None:
        self._worker: Final = worker
        self._key: Final = worker.get_current_task()
        self._work: Final = work

    def is_wanted(self) -> bool:
        # The state is "cancelled" where the client let go, or is gone; and the worker's, "closing" where it is to end.
        task = self._worker.state.tasks.get(self._key)
        is_running = self._worker.status.name in ("running", "paused", "closing_gracefully")
        return is_running and task is not None and task.state != "cancelled" and os.path.isdir(self._work)


def _run(words: list[str], cwd: str, timeout: float | None, asker: _Asker) -> dict[str, Any] | None:
    """Runs the command until it ends, has taken too long, or nobody waits."""
    started = time.monotonic()
    # The process ends when nobody holds the other end of this pipe: so it ends with the worker, however that ends.
    read, held = os.pipe()
    try:
        process = subprocess.Popen(
            [*start(_chordal.__file__), *words],
            stdin=read,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            cwd=cwd,
            # A Ctrl-C at the terminal of the worker is for the worker.
            start_new_session=True,
        )
    except OSError as error:
        os.close(held)
        return {"exit": None, "why": f"the command cannot be started: {error.strerror}", "code": "not-started"}
    finally:
        os.close(read)
    with process:
        try:
            while True:
                left = _POLL_S if timeout is None else min(_POLL_S, max(0.0, started + timeout - time.monotonic()))
                try:
                    stdout, stderr = process.communicate(timeout=left)
                    break
                except subprocess.TimeoutExpired:
                    if timeout is not None and time.monotonic() >= started + timeout:
                        return {"exit": None, "timed_out": True}
                    if not asker.is_wanted():
                        return None
        finally:
            process.kill()
            os.close(held)
    said = {"stdout": stdout.decode(errors="replace"), "stderr": stderr.decode(errors="replace")}
    if process.returncode < 0:
        return {"exit": None, "why": f"the process was ended by signal {-process.returncode}", "was_ended": True, **said}
    if process.returncode == INTERRUPTED:
        # The command itself says so after SIGTERM, and the batch was not meant.
        return {"exit": None, "why": "the process was ended", "was_ended": True, **said}
    return {"exit": process.returncode, **said}
