"""Volumes that are read a block at a time: the same mesh as of the whole, bit for bit, wherever the blocks are done."""

from __future__ import annotations

import errno
import json
import os
import pickle
import signal
import threading
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import chordal

STEPS: Any = {"spacing": (0.7, 1.1, 0.5), "origin": (-3.0, 4.0, 100.0)}


def same(one: chordal.Mesh, two: chordal.Mesh) -> bool:
    return one.vertices.tobytes() == two.vertices.tobytes() and one.faces.tobytes() == two.faces.tobytes()


def ball(shape: tuple[int, ...] = (23, 19, 27)) -> NDArray[np.float64]:
    middle = (np.array(shape) - 1) / 2
    places = np.moveaxis(np.indices(shape), 0, -1) - middle
    found: NDArray[np.float64] = np.linalg.norm(places, axis=-1) - 0.37 * min(shape)
    return found


class Slow:
    """An array that is read by slices alone, and that counts them."""

    def __init__(self, array: NDArray[Any], broken: tuple[int, int, int] | None = None) -> None:
        self._array, self.shape, self.dtype, self.broken = array, array.shape, array.dtype, broken
        self.reads: list[tuple[slice, ...]] = []

    def __getitem__(self, slices: tuple[slice, ...]) -> NDArray[Any]:
        self.reads.append(slices)
        if self.broken is not None and tuple(s.start for s in slices) == self.broken:
            raise OSError("checksum of the chunk is wrong")
        return self._array[slices]


@pytest.mark.parametrize("seed", range(10))
def test_blocks_of_any_shape_join_to_the_whole_bit_for_bit(seed: int) -> None:
    rng = np.random.default_rng(seed)
    shape = tuple(int(n) for n in rng.integers(2, 14, 3))
    kinds: list[Any] = [rng.normal(size=shape), rng.integers(0, 3, shape, dtype=np.uint8), ball(shape) if min(shape) > 4 else 0]
    samples = kinds[seed % 3] if not isinstance(kinds[seed % 3], int) else rng.normal(size=shape).astype(np.float32)
    iso = 0.1 if seed % 2 else 0.0
    border: Any = "capped" if seed % 2 else "open"
    whole = chordal.volume(samples, **STEPS).mesh(iso=iso, inside="high", border=border)
    for block in (3, 7, (2, 5, 40), (1, 1, 1) if samples.size < 200 else 11, 100):
        made = chordal.block_volume(samples, **STEPS).mesh(iso=iso, inside="high", border=border, block=block)
        assert same(made, whole), (shape, block)
        assert made.bound.evidence == "proved" and made.bound.at_most is not None
        assert whole.bound.at_least <= made.bound.at_most
    if border == "capped":
        assert made.is_watertight


def test_each_task_reads_its_own_block_once() -> None:
    slow = Slow(ball())
    made = chordal.block_volume(slow, **STEPS).mesh(iso=0, inside="low", block=10)
    assert same(made, chordal.volume(ball(), **STEPS).mesh(iso=0, inside="low"))
    assert len(slow.reads) == 3 * 2 * 3 and max(s.stop - s.start for read in slow.reads for s in read) == 11


def test_a_memory_mapped_file_is_a_volume(tmp_path: Path) -> None:
    np.save(tmp_path / "ball.npy", ball())
    made = chordal.block_volume(tmp_path / "ball.npy", unit="mm", **STEPS).mesh(iso=0, inside="low", block=9)
    whole = chordal.volume(ball(), unit="mm", **STEPS).mesh(iso=0, inside="low")
    assert same(made, whole)
    # What is done with it goes on as with any mesh.
    assert len(made.mesh(tol="0.5mm").faces) < len(made.faces)


def test_other_processes_do_blocks(tmp_path: Path) -> None:
    np.save(tmp_path / "ball.npy", ball())
    volume = chordal.block_volume(tmp_path / "ball.npy", **STEPS)
    assert len(pickle.dumps(volume._array)) < 500
    seen: list[tuple[str, int, int]] = []
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        made = volume.mesh(iso=0, inside="low", block=9, executor=pool, progress=lambda *told: seen.append(told))
    assert same(made, chordal.volume(ball(), **STEPS).mesh(iso=0, inside="low"))
    assert [done for _, done, _ in seen] == list(range(1, 3 * 2 * 3 + 1))




def test_what_was_done_is_kept_in_a_folder(tmp_path: Path) -> None:
    folder, whole = tmp_path / "done", chordal.volume(ball(), **STEPS).mesh(iso=0, inside="low")
    arguments: Any = {"iso": 0, "inside": "low", "block": 10, "folder": folder}
    broken = Slow(ball(), broken=(10, 10, 0))
    with pytest.raises(chordal.Error, match=r"the block at \(10, 10, 0\) cannot be read: checksum of the chunk"):
        chordal.block_volume(broken, **STEPS).mesh(**arguments)
    n_kept = len(list(folder.glob("block_*")))
    assert 0 < n_kept < 18
    again = Slow(ball())
    assert same(chordal.block_volume(again, **STEPS).mesh(**arguments), whole)
    assert len(again.reads) == 18 - n_kept
    # One that is damaged, and one that is gone, are done again.
    (folder / "block_3.chordal").write_bytes((folder / "block_3.chordal").read_bytes()[:-1] + b"?")
    (folder / "block_4.chordal").unlink()
    third = Slow(ball())
    assert same(chordal.block_volume(third, **STEPS).mesh(**arguments), whole) and len(third.reads) == 2
    with pytest.raises(chordal.Error, match="blocks of another volume, level or version"):
        chordal.block_volume(Slow(ball()), **STEPS).mesh(**{**arguments, "iso": 0.5})


class Killing:
    """What kills the process that reads it."""

    shape, dtype = (9, 9, 9), np.dtype(np.float64)

    def __getitem__(self, slices: Any) -> Any:
        os._exit(9)


def test_a_worker_that_dies_says_with_which_block() -> None:
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        with pytest.raises(chordal.Error, match=r"the block at \(0, 0, 0\) was not done: BrokenProcessPool"):
            chordal.block_volume(Killing()).mesh(iso=0, inside="low", block=8, executor=pool)


def test_a_full_disk_names_the_file_of_the_block(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(path: Any, content: bytes) -> None:
        if "block_" in os.fspath(path):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        Path(path).write_bytes(content)

    monkeypatch.setattr("chordal._files.replace", full)
    with pytest.raises(OSError, match="block_0.chordal"):
        chordal.block_volume(ball()).mesh(iso=0, inside="low", block=10, folder=tmp_path / "done")


def test_arguments_are_named() -> None:
    volume = chordal.block_volume(ball())
    with pytest.raises(ValueError, match="block: one whole number"):
        volume.mesh(iso=0, inside="low", block=0)
    with pytest.raises(ValueError, match="inside"):
        volume.mesh(iso=0, inside="out")  # type: ignore[arg-type]
    with pytest.raises(chordal.Refused, match="no block has a surface"):
        volume.mesh(iso=1e6, inside="high")
    with pytest.raises(ValueError, match="three axes"):
        chordal.block_volume(np.zeros((3, 3)))
    with pytest.raises(chordal.Refused, match="no cells"):
        chordal.block_volume(np.zeros((3, 3, 1))).mesh(iso=1)


def corners(mesh: chordal.Mesh) -> list[Any]:
    """The triangles by the numbers of their corners, whatever their order."""
    return sorted(np.roll(face, -int(np.lexsort(face.T[::-1])[0]), axis=0).tolist() for face in mesh.vertices[mesh.faces])


def test_labels_of_blocks_are_those_of_the_whole(tmp_path: Path) -> None:
    rng = np.random.default_rng(4)
    samples = rng.integers(0, 4, (11, 8, 9), dtype=np.uint16) * 1000
    whole = {part.name: part for part in chordal.labels(samples, **STEPS).mesh().parts}
    volume = chordal.block_volume(samples, **STEPS)
    made = volume.labels(block=(4, 5, 3), folder=tmp_path / "done")
    assert [f"label {label}" for label in made] == list(whole) and list(made) == [1000, 2000, 3000]
    for label, mesh in made.items():
        part = whole[f"label {label}"]
        assert corners(mesh) == corners(chordal.Mesh(part.vertices, part.faces)) and mesh.is_watertight
        assert mesh.bound.evidence == "proved"
    assert list(volume.labels(only=[2000], block=6)) == [2000]
    with pytest.raises(chordal.Refused, match="a label is a whole number"):
        chordal.block_volume(samples + 0.5).labels()


def test_meshes_of_labels_for_neuroglancer_are_closed_across_fragments(tmp_path: Path) -> None:
    rng = np.random.default_rng(6)
    seeds = rng.uniform(0, 20, (5, 3))
    places = np.moveaxis(np.indices((20, 18, 21)), 0, -1)[..., None, :]
    samples = (np.argmin(((places - seeds) ** 2).sum(axis=-1), axis=-1) + 1).astype(np.uint32)
    volume = chordal.block_volume(samples, spacing=(0.7, 1.1, 0.5), unit="um")
    for tol in (None, 0.9):
        folder = tmp_path / f"within {tol}"
        bounds = volume.precomputed(folder, tol=tol, block=7)
        assert list(bounds) == [1, 2, 3, 4, 5] and json.loads((folder / "info").read_text())["@type"] == "neuroglancer_legacy_mesh"
        for label, bound in bounds.items():
            assert bound.evidence == "proved" and bound.at_most is not None
            points = []
            for name in json.loads((folder / f"{label}:0").read_text())["fragments"]:
                content = (folder / name).read_bytes()
                n = int.from_bytes(content[:4], "little")
                vertices = np.frombuffer(content, "<f4", 3 * n, 4).reshape(-1, 3)
                points.append(vertices[np.frombuffer(content, "<u4", offset=4 + 12 * n)])
            corner, index = np.unique(np.concatenate(points), axis=0, return_inverse=True)
            mesh = chordal.Mesh(corner / 1e3, index.reshape(-1, 3).astype(np.int64))
            whole = volume.labels([label])[label]
            assert whole.bound.at_most is not None
            assert mesh.is_watertight and mesh.deviation(whole).bound.at_least <= bound.at_most + whole.bound.at_most
            assert len(mesh.faces) == len(whole.faces) if tol is None else len(mesh.faces) < 0.7 * len(whole.faces)
            assert tol is None or bound.at_most <= tol
    with pytest.raises(chordal.Error, match="this folder holds meshes or samples"):
        volume.precomputed(tmp_path / "within None")
    with pytest.raises(ValueError, match="unit: these meshes are in nanometres"):
        chordal.block_volume(samples).precomputed(tmp_path / "no unit")


@pytest.mark.parametrize("delay", [0.05, 0.3])
@pytest.mark.parametrize("kind", ["mesh", "simplified", "labels", "tileset"])
def test_ctrl_c_is_obeyed_at_once(kind: str, delay: float, tmp_path: Path) -> None:
    i, j, k = np.indices((140, 140, 140), dtype=np.float32) * 0.3
    waves = chordal.block_volume(np.sin(i) * np.cos(j) + np.sin(j) * np.cos(k) + np.sin(k) * np.cos(i))
    cells = chordal.block_volume((i // 3 + j // 4 * 7 + k // 5 * 13).astype(np.uint16))
    work: dict[str, Callable[[], object]] = {
        "mesh": lambda: [waves.mesh(iso=0, inside="low", block=64) for _ in range(20)],
        "simplified": lambda: waves.mesh(iso=0, inside="low", tol=0.5, block=64),
        "labels": lambda: [cells.labels(block=64) for _ in range(20)],
        "tileset": lambda: waves.tileset(tmp_path, iso=0, inside="low", tol=0.3, block=64),
    }
    sent: list[float] = []

    def send() -> None:
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(delay, send)
    try:
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            work[kind]()
        # A fifth of a second is promised; a machine with other work on it takes some more to get round to it.
        assert time.perf_counter() - sent[0] < 0.5
    finally:
        timer.join()
        signal.signal(signal.SIGINT, before)


def test_labels_that_are_off_by_more_than_the_length_are_told(tmp_path: Path) -> None:
    dust = (np.random.default_rng(2).uniform(size=(24, 24, 24)) < 0.03).astype(np.uint8)
    volume = chordal.block_volume(dust, unit="um")
    with pytest.raises(chordal.BudgetUnmet, match=r"within 0\.\d+, not within 0\.01") as unmet:
        volume.precomputed(tmp_path / "one", tol=0.01, block=6)
    best: Any = unmet.value.best
    assert best[1].at_most > 0.01 and (tmp_path / "one" / "info").exists()


def test_labels_may_have_64_bits(tmp_path: Path) -> None:
    i, j, k = np.indices((17, 15, 13))
    small = ((i // 6) * 4 + (j // 5) * 2 + k // 7).astype(np.uint64)
    names = np.array([0, 1, 720575940621039146, 2**64 - 1, 5, 2**33, 7, 8, 9, 2**40, 11, 12, 13, 14], dtype=np.uint64)
    volume, large = chordal.block_volume(small.astype(np.uint32)), chordal.block_volume(names[small], spacing=1, unit="nm")
    expected, meshes = volume.labels(block=6), large.labels(block=6)
    assert sorted(meshes) == sorted(int(names[label]) for label in expected)
    assert all(same(meshes[int(names[label])], mesh) for label, mesh in expected.items())
    bounds = large.precomputed(tmp_path, only=[720575940621039146], tol=0.9, block=6)
    assert list(bounds) == [720575940621039146] and (tmp_path / "720575940621039146:0").exists()
    with pytest.raises(chordal.Error, match="label -3"):
        chordal.block_volume(np.full((4, 4, 4), -3, dtype=np.int64)).labels()


@pytest.mark.parametrize("way", ["npy", "mapped", "nii", "zarr", "array"])
def test_samples_that_were_written_anew_are_others(way: str, tmp_path: Path) -> None:
    """Of the same size, at the same place, and even at the same time: the folder does not hand out what was made of the old ones."""
    path = tmp_path / f"ball.{way}"

    def volume(samples: Any) -> chordal.BlockVolume:
        if way == "array":
            return chordal.block_volume(samples)
        if way == "nii":
            nibabel = pytest.importorskip("nibabel")
            nibabel.save(nibabel.Nifti1Image(samples, np.eye(4)), path)
        elif way == "zarr":
            zarr = pytest.importorskip("zarr")
            zarr.open_array(path, mode="w", shape=samples.shape, chunks=(9, 9, 9), dtype="f8")[:] = samples
        else:
            with path.open("wb") as file:
                np.save(file, samples)
            os.utime(path, ns=(0, 0))
        return chordal.block_volume(np.load(path, mmap_mode="r") if way == "mapped" else path)

    arguments: Any = {"iso": 0, "inside": "low", "block": 10, "folder": tmp_path / "done"}
    first = volume(ball()).mesh(**arguments)
    assert same(volume_again(volume, way, path).mesh(**arguments), first), "the same file goes on where it ended"
    with pytest.raises(chordal.Error, match="blocks of another volume"):
        volume(ball() - 1).mesh(**arguments)
    one = ball()
    one[1, 2, 3] += 0.5
    if way in ("array", "zarr"):
        with pytest.raises(chordal.Error, match="blocks of another volume"):
            volume(one).mesh(**arguments)


def volume_again(volume: Any, way: str, path: Path) -> chordal.BlockVolume:
    """The volume as another program opens it, with the same bytes."""
    if way == "array":
        made: chordal.BlockVolume = volume(ball())
        return made
    return chordal.block_volume(np.load(path, mmap_mode="r") if way == "mapped" else path)
