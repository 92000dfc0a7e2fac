"""HOSTILE rows 81 and 82: arrays and callbacks that are not what one hopes for."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from conftest import TEAPOT
from numpy.typing import NDArray

import chordal

#: Small whole numbers, which every number type holds.
ARCH = np.array([[0, 0], [0, 3], [4, 3], [4, 0]], dtype=np.float64)
CHAIN = np.array([[0, 0], [0, 3], [4, 3], [4, 0], [4, -3], [9, -3], [9, 1]], dtype=np.float64)


def flattened(control: Any) -> NDArray[np.float64]:
    return chordal.shapes.bezier(control).flatten(tol=0.01).points


@pytest.mark.parametrize("control", [ARCH, CHAIN, np.stack([ARCH, ARCH + 1]), np.pad(CHAIN, ((0, 0), (0, 1)))])
@pytest.mark.parametrize(
    "other",
    [
        *(lambda a, kind=kind: a.astype(kind) for kind in "f2 f4 f8 >f4 >f8 i1 i2 >i4 i8 longdouble".split()),
        lambda a: np.asfortranarray(a),
        lambda a: np.ascontiguousarray(a[::-1])[::-1],
        lambda a: np.ascontiguousarray(a[..., ::-1])[..., ::-1],
        lambda a: np.repeat(a, 2, axis=-1)[..., ::2],
        lambda a: np.repeat(a, 3, axis=0)[::3],
        lambda a: np.broadcast_to(a, a.shape),
        lambda a: np.ma.masked_array(a),  # type: ignore[no-untyped-call]
        lambda a: a.tolist(),
        lambda a: memoryview(np.ascontiguousarray(a).tobytes()).cast("d", a.shape),
        lambda a: np.frombuffer(b"x" + np.ascontiguousarray(a).tobytes(), np.uint8)[1:].view("f8").reshape(a.shape),
    ],
)
def h81_any_real_numbers_in_any_layout_give_the_same(
    control: NDArray[np.float64], other: Callable[[NDArray[np.float64]], Any]
) -> None:
    assert flattened(other(control)).tobytes() == flattened(control).tobytes()


def h81_an_array_that_cannot_be_written_is_read() -> None:
    frozen = ARCH.copy()
    frozen.flags.writeable = False
    assert np.array_equal(flattened(frozen), flattened(ARCH))


@pytest.mark.parametrize(
    "control",
    [
        ARCH.astype(object),
        ARCH.astype(complex),
        ARCH.astype(bool),
        ARCH.astype(str),
        ARCH.astype(bytes),
        ARCH.astype("datetime64[s]"),
        np.zeros(4, dtype=[("x", "f8"), ("y", "f8")]),
        "M 0 0 C 0 3 4 3 4 0",
        None,
        {"control": 1},
        object(),
    ],
)
def h81_what_is_no_array_of_real_numbers_is_a_type_error(control: Any) -> None:
    with pytest.raises(TypeError, match="control: an array of real numbers"):
        chordal.shapes.bezier(control)


@pytest.mark.parametrize(
    ("control", "part"),
    [
        (np.ascontiguousarray(ARCH.T), "wrong way round"),
        (np.zeros((3, 10)), "wrong way round"),
        (np.zeros((4, 4)), "2 or 3 coordinates"),
        (np.zeros((4, 1)), "2 or 3 coordinates"),
        (np.zeros(8), "2 or 3 coordinates"),
        (np.float64(1), "2 or 3 coordinates"),
        (np.zeros((2, 2, 4, 2)), "2 or 3 coordinates"),
        (np.zeros((3, 2)), "4 points, or 3n"),
        (np.zeros((6, 2)), "4 points, or 3n"),
        (np.zeros((2, 7, 2)), "4 points for each"),
        (np.zeros((0, 2)), "no points"),
        (np.zeros((0, 4, 3)), "no points"),
        (np.zeros((5, 0, 3)), "no points"),
        ([], "2 or 3 coordinates"),
        ([[0, 0], [1, 1, 1], [2, 2], [3, 3]], "different lengths"),
        (np.where(ARCH == 3, np.nan, ARCH), r"the number at \(1, 1\) is not finite: nan"),
        (np.where(ARCH == 3, -np.inf, ARCH), "not finite: -inf"),
        (np.ma.masked_equal(ARCH, 3), "masked"),  # type: ignore[no-untyped-call]
        ((ARCH + 2**53 + 1).astype(np.int64) + 1, "double precision cannot hold"),
        (np.full((4, 2), 2**64 - 1, dtype=np.uint64), "double precision cannot hold"),
    ],
)
def h81_a_wrong_shape_or_number_is_a_value_error(control: Any, part: str) -> None:
    with pytest.raises(ValueError, match=f"control: .*{part}"):
        chordal.shapes.bezier(control)


def h81_numbers_that_overflow_on_the_way_are_refused() -> None:
    with pytest.raises(chordal.Refused) as caught:
        chordal.shapes.bezier(ARCH * 1e300).flatten(rel=0.1)
    assert caught.value.code == "not-finite"


def h81_what_goes_in_and_what_comes_out_share_nothing() -> None:
    control = ARCH.copy()
    curve = chordal.shapes.bezier(control)
    before = curve.flatten(tol=0.01).points
    assert not np.shares_memory(before, control)
    control[:] = 7
    assert np.array_equal(curve.flatten(tol=0.01).points, before)


def h81_an_array_that_fails_to_become_one_raises_its_own_exception() -> None:
    class Stubborn(Exception):
        pass

    class Array:
        def __array__(self, *_: object, **__: object) -> NDArray[np.float64]:
            raise Stubborn

    with pytest.raises(Stubborn):
        chordal.shapes.bezier(Array())


def h82_an_array_that_another_thread_writes_to_is_copied_first() -> None:
    """Whatever mixture of the old and the new the copy holds, the curve stays the one that was copied."""
    control = np.zeros((20_000, 4, 2))
    over = threading.Event()

    def write() -> None:
        value = 0.0
        while not over.is_set():
            value += 1.0
            control[:] = value

    writer = threading.Thread(target=write)
    writer.start()
    try:
        for _ in range(20):
            curve = chordal.shapes.bezier(control)
            first, second = curve.flatten(tol=0.1), curve.flatten(tol=0.1)
            assert first.points.tobytes() == second.points.tobytes()
            assert np.isfinite(first.points).all() and (first.points == np.floor(first.points)).any()
    finally:
        over.set()
        writer.join()


def h82_bytes_that_change_while_they_are_read_are_copied_first() -> None:
    content = bytearray(TEAPOT.read_bytes())
    shape = chordal.load(content)
    content[:] = b"x" * len(content)
    assert shape.mesh(tol=0.1).bound.at_most == chordal.load(TEAPOT).mesh(tol=0.1).bound.at_most


def h82_the_exception_of_a_callback_comes_back_unchanged() -> None:
    class Mine(Exception):
        pass

    mine = Mine("with", "arguments")
    teapot = chordal.load(TEAPOT)

    def progress(*_: object) -> None:
        raise mine

    with pytest.raises(Mine) as caught:
        teapot.mesh(tol=1e-4, progress=progress)
    assert caught.value is mine and caught.value.__cause__ is None
    with pytest.raises(SystemExit):
        teapot.mesh(tol=1e-4, progress=lambda *_: sys.exit(3))
    with pytest.raises(TypeError, match="positional argument"):
        teapot.mesh(tol=1e-4, progress=lambda: None)  # type: ignore[arg-type, misc]
    assert teapot.mesh(tol=0.1).bound.evidence == "proved"


def h82_what_a_callback_returns_is_ignored() -> None:
    teapot = chordal.load(TEAPOT)
    for answer in (float("nan"), np.ones((3, 3)), "stop", None):
        mesh = teapot.mesh(tol=0.01, progress=lambda *_, answer=answer: answer)
        assert mesh.bound.at_most is not None


def h82_a_callback_may_use_the_library_itself() -> None:
    teapot = chordal.load(TEAPOT)
    inner: list[int] = []
    teapot.mesh(tol=1e-3, progress=lambda *_: inner.append(len(teapot.mesh(tol=0.1).faces)))
    assert inner and set(inner) == {len(teapot.mesh(tol=0.1).faces)}
