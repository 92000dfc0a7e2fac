"""Long work: other threads run, Ctrl-C ends it, progress is told, exceptions come back as they are, forks are safe."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from hashlib import sha256

import pytest
from conftest import TEAPOT

import chordal

#: Takes some seconds, if nobody ends it; what would take longer is refused on machines of 24 GiB, as it needs too much memory.
ENDLESS = 1e-6


@pytest.fixture(scope="module")
def teapot() -> chordal.Shape:
    return chordal.load(TEAPOT)


def digest(shape: chordal.Shape) -> str:
    mesh = shape.mesh(tol=0.003)
    return sha256(mesh.vertices.tobytes() + mesh.faces.tobytes()).hexdigest()


class Counter(threading.Thread):
    """Counts as long as it is not stopped, whenever it gets Python's lock."""

    def __init__(self) -> None:
        super().__init__()
        self.steps = 0
        self._over = threading.Event()

    def run(self) -> None:
        while not self._over.is_set():
            self.steps += 1

    def __enter__(self) -> Counter:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self.join()


def test_other_threads_run_meanwhile(teapot: chordal.Shape) -> None:
    with Counter() as counter:
        before = counter.steps
        teapot.mesh(tol=1e-4)
        assert counter.steps - before > 1000


@pytest.fixture
def soon() -> Iterator[None]:
    """Sends SIGINT to this process in a moment: the work takes a hundred times as long, so it comes in the middle.

    What shells start in the background ignores it, and so would Python.
    """
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    yield
    timer.join()
    signal.signal(signal.SIGINT, before)


def test_ctrl_c_ends_the_work_and_frees_the_threads(teapot: chordal.Shape, soon: None) -> None:
    with pytest.raises(KeyboardInterrupt):
        teapot.mesh(tol=ENDLESS)
    assert digest(teapot) == digest(teapot)


def test_a_signal_is_handled_in_the_middle_of_the_work(teapot: chordal.Shape, soon: None) -> None:
    handled: list[int] = []
    with Counter() as counter:
        before = signal.signal(signal.SIGINT, lambda *_: handled.append(counter.steps))
        try:
            teapot.mesh(tol=2e-5)
            after = counter.steps
        finally:
            signal.signal(signal.SIGINT, before)
    # A handler that had to wait for the end of the work would run right here, with nothing counted in between.
    assert handled and after - handled[0] > 1000


def test_what_a_signal_handler_raises_comes_back(teapot: chordal.Shape, soon: None) -> None:
    class Enough(Exception):
        pass

    def handler(*_: object) -> None:
        raise Enough

    before = signal.signal(signal.SIGINT, handler)
    try:
        with pytest.raises(Enough):
            teapot.mesh(tol=ENDLESS)
    finally:
        signal.signal(signal.SIGINT, before)


def test_progress_comes_from_the_calling_thread_and_in_order(teapot: chordal.Shape) -> None:
    told: list[tuple[str, int, int]] = []
    threads = set()

    def progress(stage: str, done: int, total: int) -> object:
        threads.add(threading.get_ident())
        told.append((stage, done, total))
        return NotImplemented

    teapot.mesh(tol=1e-4, progress=progress)
    assert told and threads == {threading.get_ident()}
    assert all(stage and 0 <= done <= total for stage, done, total in told)


def test_threads_at_once_get_what_they_get_alone(teapot: chordal.Shape) -> None:
    alone = digest(teapot)
    found: list[str] = []
    threads = [threading.Thread(target=lambda: found.append(digest(teapot))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [alone] * 4


@pytest.fixture
def fork() -> Iterator[multiprocessing.context.ForkContext]:
    if "fork" not in multiprocessing.get_all_start_methods():
        pytest.skip("this system has no fork")
    yield multiprocessing.get_context("fork")


def child_digest(_: int) -> str:
    return digest(chordal.load(TEAPOT))


def child_levels(_: int) -> int:
    return len(chordal.load(TEAPOT).mesh(tol=0.05).lod(tol=0.1)) + len(chordal.load(TEAPOT).mesh(tol=0.05, triangles=5_000).faces)


# Newer Pythons warn that a fork of several threads may lock up: that it does not is what is tested.
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_child_of_a_fork_has_threads_of_its_own(
    fork: multiprocessing.context.ForkContext, teapot: chordal.Shape
) -> None:
    here = digest(teapot)
    with fork.Pool(2) as pool:
        assert pool.map_async(child_digest, range(4)).get(120) == [here] * 4
    assert digest(teapot) == here


@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_child_simplifies_after_its_parent_did(fork: multiprocessing.context.ForkContext) -> None:
    here = child_levels(0)
    with fork.Pool(2) as pool:
        assert pool.map_async(child_levels, range(2)).get(120) == [here] * 2


@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_fork_in_the_middle_of_work_is_safe(
    fork: multiprocessing.context.ForkContext, teapot: chordal.Shape
) -> None:
    here = digest(teapot)
    started, over = threading.Event(), threading.Event()

    def work() -> None:
        while not over.is_set():
            teapot.mesh(tol=1e-4, progress=lambda *_: started.set())

    worker = threading.Thread(target=work)
    worker.start()
    try:
        assert started.wait(60)
        for _ in range(3):
            with fork.Pool(1) as pool:
                assert pool.map_async(child_digest, [0]).get(120) == [here]
    finally:
        over.set()
        worker.join()


FLUSH = """
import ctypes, chordal, sys
def flush():
    libm, state = ctypes.CDLL("libm.so.6"), (ctypes.c_uint8 * 32)()
    libm.fegetenv(state)
    word = int.from_bytes(bytes(state[28:32]), "little") | 0x8040  # FTZ and DAZ in MXCSR
    state[28:32] = list(word.to_bytes(4, "little"))
    libm.fesetenv(state)
shape = chordal.load(sys.argv[1])
before = shape.mesh(tol=0.01).vertices.tobytes()
flush()
print(shape.mesh(tol=0.01).vertices.tobytes() == before)
"""


@pytest.mark.skipif(sys.platform != "linux" or os.uname().machine != "x86_64", reason="MXCSR is x86-64's")
def test_a_thread_that_flushes_subnormals_changes_no_result() -> None:
    done = subprocess.run(
        [sys.executable, "-c", FLUSH, TEAPOT], capture_output=True, text=True, check=False, timeout=120
    )
    assert (done.stdout, done.stderr) == ("True\n", "")
