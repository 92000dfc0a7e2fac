"""`do_job`: one file of a batch on a worker of a cluster, in a process of its own that ends with the worker."""

from __future__ import annotations

import importlib
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

#: A file name in a message: text, or bytes if it is not valid Unicode.
Name = str | list[int]


class Job(TypedDict):
    """The job of a worker: one file of a batch. `batch/bridge.rs` of the command writes it."""

    version: str
    #: The folder of the batch: names and options are relative to it.
    cwd: Name
    input: Name
    #: Whether the batch sees the input; if not, the command reports it.
    is_there: bool
    #: The folder of outputs. It exists as long as the batch waits for them.
    work: Name
    #: The beginning of the name of this job's folder, and the name of the output in it.
    number: int
    name: Name
    is_report: bool
    #: The command's arguments before and after the output.
    head: list[Name]
    tail: list[Name]
    #: Whether the command is limited to a share of the worker's memory.
    shares_memory: bool
    timeout: float | None


#: The interval at which a job checks whether it is still wanted. Defined: short enough to end soon after Ctrl-C, at a small cost.
_POLL_S: Final = 0.25
#: The share of the worker's memory for its processes. Defined: the rest is for the worker itself.
_MEMORY_SHARE: Final = 0.75


def do_job(job: Job) -> dict[str, Any] | None:
    """Runs the command, and returns its result in the form of `batch/bridge.rs`; `{"fault": …}` if this worker cannot do any file
    of the batch; None if the command was ended because the result is not wanted any more."""
    worker = importlib.import_module("distributed").get_worker()
    where = f"worker {worker.address} on {socket.gethostname()}"
    cwd, work = text(job["cwd"]), text(job["work"])
    if VERSION != job["version"]:
        return {"fault": f"{where} has Chordal {VERSION}, and this batch is of {job['version']}"}
    unseen = next((f"the folder {path}" for path in (cwd, work) if not os.path.isdir(path)), None)
    input_path = os.path.join(cwd, text(job["input"]))
    if unseen is None and job["is_there"] and not os.path.exists(input_path):
        unseen = f"the file {input_path}"
    if unseen is not None:
        return {"fault": f"{where} does not see {unseen}: all workers need the same files", "unseen": input_path}
    # A folder for this attempt alone, since a worker that was given up may continue for a while.
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
    result = _run(words, cwd, job["timeout"], _TaskState(worker, work))
    if result is None or result["exit"] is None:
        shutil.rmtree(folder, ignore_errors=True)
    if result is None:
        return None
    if result.get("exit") is not None:
        result["folder"] = os.path.basename(folder)
    result["seconds"] = time.monotonic() - started
    if result.pop("was_ended", False):
        result["why"] += f" on {socket.gethostname()}, as when memory runs out"
    return result


def text(name: Name) -> str:
    """A name as a Python string."""
    return name if isinstance(name, str) else os.fsdecode(bytes(name))


def _memory_words(worker: Any) -> list[str]:
    """The option for the memory of one of the worker's threads: its share of the worker's limit, else of the machine's memory."""
    limit = worker.memory_manager.memory_limit or importlib.import_module("distributed.system").MEMORY_LIMIT
    return ["--max-memory", str(max(1, int(limit * _MEMORY_SHARE / max(1, worker.state.nthreads))))]


class _TaskState:
    """Knows whether the result of this task is still wanted: by the batch, whose folder exists, and by a client."""

    def __init__(self, worker: Any, work: str) -> None:
        self._worker: Final = worker
        self._key: Final = worker.get_current_task()
        self._work: Final = work

    def is_wanted(self) -> bool:
        # The task is "cancelled" if the client gave it up or is gone; the worker is "closing" if it has to end.
        task = self._worker.state.tasks.get(self._key)
        is_running = self._worker.status.name in ("running", "paused", "closing_gracefully")
        return is_running and task is not None and task.state != "cancelled" and os.path.isdir(self._work)


def _run(words: list[str], cwd: str, timeout: float | None, task: _TaskState) -> dict[str, Any] | None:
    """Runs the command until it ends, exceeds its time, or is not wanted any more."""
    started = time.monotonic()
    # The process ends when the other end of this pipe is closed, and thus with the worker, however that ends.
    read, held = os.pipe()
    try:
        process = subprocess.Popen(
            [*start(_chordal.__file__), *words],
            stdin=read,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            cwd=cwd,
            # Ctrl-C at the terminal of the worker is for the worker only.
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
                wait_s = _POLL_S if timeout is None else min(_POLL_S, max(0.0, started + timeout - time.monotonic()))
                try:
                    stdout, stderr = process.communicate(timeout=wait_s)
                    break
                except subprocess.TimeoutExpired:
                    if timeout is not None and time.monotonic() >= started + timeout:
                        return {"exit": None, "timed_out": True}
                    if not task.is_wanted():
                        return None
        finally:
            process.kill()
            os.close(held)
    output = {"stdout": stdout.decode(errors="replace"), "stderr": stderr.decode(errors="replace")}
    if process.returncode < 0:
        return {"exit": None, "why": f"the process was ended by signal {-process.returncode}", "was_ended": True, **output}
    if process.returncode == INTERRUPTED:
        # The command's own exit code after SIGTERM, which was sent to this process and not to the batch.
        return {"exit": None, "why": "the process was ended", "was_ended": True, **output}
    return {"exit": process.returncode, **output}
