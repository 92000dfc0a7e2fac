"""Long work: other threads run, Ctrl-C ends it, progress is told, exceptions come back as they are, forks are safe."""

from __future__ import annotations

import inspect
import multiprocessing
import os
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from hashlib import sha256
from typing import Any

import numpy as np
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


@pytest.mark.skipif(sys.platform != "linux" or os.uname().machine != "x86_64", reason="sets MXCSR in glibc's fenv_t")
def test_a_thread_that_flushes_subnormals_changes_no_result() -> None:
    done = subprocess.run(
        [sys.executable, "-c", FLUSH, TEAPOT], capture_output=True, encoding="utf-8", check=False, timeout=120
    )
    assert (done.stdout, done.stderr) == ("True\n", "")


CORNERS = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
QUADS = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
CUBE = chordal.Mesh(CORNERS, [face for a, b, c, d in QUADS for face in ((a, b, c), (a, c, d))])
OTHER = CUBE.translate((0.5, 0.25, 0.125))
SAMPLES = chordal.volume(np.linalg.norm(np.indices((9, 9, 9)) - 4.0, axis=0) - 3)
CIRCLE = chordal.load(b'<svg xmlns="http://www.w3.org/2000/svg"><circle r="1"/></svg>')
STL = os.path.join(tempfile.mkdtemp(), "a.stl")
#: Every call that takes `progress`, of a shape that is done in no time; large ones only take longer.
VERBS: dict[str, Callable[[Any], object]] = {
    "mesh of a cage": lambda tell: chordal.load(TEAPOT).mesh(tol=0.05, progress=tell),
    "mesh of a volume": lambda tell: SAMPLES.mesh(iso=0, progress=tell),
    "mesh of a volume within a length": lambda tell: SAMPLES.mesh(iso=0, tol=0.5, progress=tell),
    "mesh of labels": lambda tell: chordal.labels(SAMPLES.array < 0).mesh(tol=1, progress=tell),
    "mesh of triangles": lambda tell: CUBE.mesh(tol=0.1, progress=tell),
    "mesh of so many triangles": lambda tell: CUBE.mesh(triangles=12, progress=tell),
    "mesh of a field": lambda tell: chordal.shapes.sphere(1).mesh(tol=0.1, progress=tell),
    "mesh of a drawing": lambda tell: CIRCLE.mesh(tol=0.1, progress=tell),
    "flatten": lambda tell: CIRCLE.flatten(tol=0.1, progress=tell),
    "lod": lambda tell: CUBE.lod(tol=0.1, progress=tell),
    "deviation": lambda tell: CUBE.deviation(OTHER, progress=tell),
    "mend": lambda tell: CUBE.mend(weld=True, progress=tell),
    "render": lambda tell: CUBE.render(size=(32, 24), progress=tell),
    "bake": lambda tell: CUBE.bake(cells=4, progress=tell),
    "combine": lambda tell: CUBE.combine(("union", OTHER), progress=tell),
    "union": lambda tell: CUBE.union(OTHER, progress=tell),
    "difference": lambda tell: CUBE.difference(OTHER, progress=tell),
    "intersection": lambda tell: CUBE.intersection(OTHER, progress=tell),
    "the function union": lambda tell: chordal.union(CUBE, OTHER, progress=tell),
    "convert": lambda tell: chordal.convert(CUBE, STL, progress=tell),
    "export of what was made": lambda tell: chordal.shapes.sphere(1).mesh(tol=0.1).export(STL, progress=tell),
    "verify": lambda tell: chordal.verify(chordal.shapes.sphere(1).mesh(tol=0.1), chordal.shapes.sphere(1), progress=tell),
}


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_tells_of_its_beginning_and_its_end(verb: str) -> None:
    told: list[tuple[str, int, int]] = []
    VERBS[verb](lambda *said: told.append(said))
    assert len(told) >= 2 and all(stage and 0 <= done <= total for stage, done, total in told)
    (first, none, _), (last, done, total) = told[0], told[-1]
    assert first == last and none == 0 and done == total


def test_all_that_takes_long_takes_progress() -> None:
    known = {word for name in VERBS for word in name.split()}
    for name in sorted(chordal.__all__):
        if inspect.isfunction(getattr(chordal, name)) and "progress" in inspect.signature(getattr(chordal, name)).parameters:
            assert name in known or name in ("batch", "plot_error", "union", "difference", "intersection"), name
    for kind in (chordal.Mesh, chordal.Field, chordal.Volume):
        for name in ("mesh", "lod", "deviation", "bake", "combine", "union", "difference", "intersection", "mend", "render", "export"):
            assert "progress" in inspect.signature(getattr(kind, name)).parameters, name


def test_who_waits_hears_the_last_word_again() -> None:
    """A function that lets its caller wait until it was told three times: nothing else is said meanwhile."""
    heard = threading.Semaphore(0)
    is_first = threading.Event()

    def slow(points: Any) -> Any:
        if threading.current_thread() is not threading.main_thread() and not is_first.is_set():
            is_first.set()
            for _ in range(3):
                assert heard.acquire(timeout=60)
        return np.linalg.norm(points, axis=1) - 1

    ball = chordal.field(slow, bounds=((-1.5,) * 3, (1.5,) * 3))
    assert len(ball.mesh(tol=0.2, progress=lambda *_: heard.release()).faces) > 10


def test_what_progress_raises_comes_back_from_every_verb() -> None:
    def tell(*_: object) -> None:
        raise KeyError("enough")

    for verb, call in VERBS.items():
        with pytest.raises(KeyError, match="enough"):
            call(tell)
        assert verb
