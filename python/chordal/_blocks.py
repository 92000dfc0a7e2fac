"""`BlockVolume`: samples that stay where they are, meshed block by block, here or in other processes."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, wait
from dataclasses import dataclass
from itertools import product
from operator import index
from typing import TYPE_CHECKING, Any, Final, Literal, SupportsFloat, SupportsIndex

from chordal import _chordal, _files
from chordal._arguments import function, number, text
from chordal._bound import bound_of
from chordal._errors import Error, Refused
from chordal._libraries import library
from chordal._volume import _steps, volume

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from chordal._mesh import Mesh

_METRES = {"um": 1e-6, "mm": 1e-3, "cm": 1e-2, "m": 1.0, "km": 1e3, "in": 0.0254, "ft": 0.3048}


@dataclass(frozen=True)
class Block:
    """A box of samples: `low` up to and with `high`, which neighbours share."""

    #: The index of its first sample along i, j and k.
    low: tuple[int, int, int]
    #: That of its last one.
    high: tuple[int, int, int]

    @property
    def slices(self) -> tuple[slice, slice, slice]:
        """Its place in the array."""
        i, j, k = (slice(low, high + 1) for low, high in zip(self.low, self.high, strict=True))
        return i, j, k


@dataclass(frozen=True)
class _Task:
    """All that another process needs to mesh a block, but for its samples."""

    affine: tuple[tuple[float, ...], ...]
    shape: tuple[int, int, int]
    iso: float
    inside: str
    capped: bool

    def done(self, block: Block, samples: NDArray[Any]) -> bytes:
        """The triangles of a block, as bytes."""
        expected = tuple(high - low + 1 for low, high in zip(block.low, block.high, strict=True))
        if samples.shape != expected:
            raise Error(f"the block at {block.low} has {samples.shape} samples, not {expected}")
        ends = [
            [self.capped and low == 0, self.capped and high + 1 == n]
            for low, high, n in zip(block.low, block.high, self.shape, strict=True)
        ]
        arguments: _chordal.BlockArguments = {
            "iso": self.iso,
            "inside": self.inside,
            "capped": ends,
            "offset": list(block.low),
            "affine": [list(row) for row in self.affine],
        }
        made = _chordal.block(volume(samples)._source, arguments)
        return _packed(*made.state())


def _run(task: _Task, array: Any, block: Block) -> bytes:
    """Reads and meshes a block: what a worker does."""
    import numpy as np

    try:
        samples = np.asarray(array[block.slices])
    except Exception as error:
        raise Error(f"the block at {block.low} cannot be read: {error}") from error
    return task.done(block, samples)


class BlockVolume:
    """Samples on a lattice that are read a block at a time: those of a Zarr array, of a memory-mapped file, of Dask, or of
    anything with a `shape`, a `dtype` and slices. `block_volume` makes it.

    >>> import chordal, numpy
    >>> i, j, k = numpy.indices((20, 21, 22)) - 10.0
    >>> ball = chordal.block_volume(numpy.sqrt(i * i + j * j + k * k) - 7, spacing=0.5)
    >>> whole = chordal.volume(numpy.sqrt(i * i + j * j + k * k) - 7, spacing=0.5).mesh(iso=0, inside="low")
    >>> blockwise = ball.mesh(iso=0, inside="low", block=8)
    >>> bool(numpy.array_equal(blockwise.vertices, whole.vertices) and numpy.array_equal(blockwise.faces, whole.faces))
    True
    """

    __slots__ = ("_affine", "_array", "_unit")

    def __init__(
        self,
        array: Any,
        *,
        spacing: SupportsFloat | Sequence[SupportsFloat] | None = None,
        origin: Sequence[SupportsFloat] | None = None,
        affine: ArrayLike | None = None,
        unit: str | None = None,
    ) -> None:
        import numpy as np

        if len(array.shape) != 3:
            raise ValueError(f"array: three axes, not {len(array.shape)}")
        self._array: Final = array
        rows = np.asarray(_steps(spacing, origin, affine), dtype=np.float64).T
        self._affine: Final = tuple(tuple(float(x) for x in row) for row in rows)
        self._unit: Final = text("unit", unit)
        if unit is not None and unit not in _METRES:
            raise ValueError(f"unit: one of {', '.join(_METRES)}, not '{unit}'")

    @property
    def shape(self) -> tuple[int, int, int]:
        """How many samples there are along i, j and k."""
        i, j, k = (int(n) for n in self._array.shape)
        return i, j, k

    @property
    def dtype(self) -> np.dtype[Any]:
        """The type of a sample."""
        import numpy as np

        dtype: np.dtype[Any] = np.dtype(self._array.dtype)
        return dtype

    @property
    def affine(self) -> NDArray[np.float64]:
        """The 4 × 4 matrix that takes (i, j, k, 1) to space."""
        import numpy as np

        return np.array([*self._affine, (0.0, 0.0, 0.0, 1.0)])

    def blocks(self, block: SupportsIndex | Sequence[SupportsIndex] = 256) -> Iterator[Block]:
        """The blocks of so many cells a side, in the order of the array."""
        sides = _sides(block)
        ranges = []
        for n, side in zip(self.shape, sides, strict=True):
            if n < 2:
                raise Refused("empty", f"an axis of {n} samples has no cells: pad it to give it thickness")
            ranges.append([(low, min(low + side, n - 1)) for low in range(0, n - 1, side)])
        for i, j, k in product(*ranges):
            yield Block((i[0], j[0], k[0]), (i[1], j[1], k[1]))

    def mesh(
        self,
        *,
        iso: SupportsFloat,
        inside: Literal["high", "low"] = "high",
        border: Literal["capped", "open"] = "capped",
        block: SupportsIndex | Sequence[SupportsIndex] = 256,
        executor: Any | None = None,
        cluster: str | None = None,
        folder: str | os.PathLike[str] | None = None,
        progress: Callable[[str, int, int], object] | None = None,
    ) -> Mesh:
        """The surface at the level `iso`, block by block: bit for bit the vertices and triangles of
        `volume(array).mesh(iso=…)`, closed and manifold across blocks, with a proved bound against the trilinear
        interpolant.

        `block` is the number of cells along a side, one or three; each task reads its own block and the samples that it
        shares with its neighbours. Without more the blocks are done here one after the other, on all processors. `executor`
        is anything with `submit`: a `ProcessPoolExecutor`, or a `dask.distributed.Client`; `cluster` is the address of a
        Dask scheduler. The array is pickled for each task, so give one that says where its samples are: a path, or a Zarr array.

        With a `folder` each block that is done is kept there, and a later call goes on where one ended, of the same volume,
        level and blocks; a file that is damaged is done again. Its results are removed by whoever made the folder.

        Memory is that of the result, and of one block here or in each worker. Raises `Refused` where there is no surface,
        and `Error` with the place of a block that cannot be read; what is done stays in the folder.
        """
        from chordal._mesh import Mesh

        if inside not in ("high", "low"):
            raise ValueError(f"inside: 'high' or 'low', not {inside!r}")
        if border not in ("capped", "open"):
            raise ValueError(f"border: 'capped' or 'open', not {border!r}")
        task = _Task(self._affine, self.shape, number("iso", iso), inside, border == "capped")
        blocks = list(self.blocks(block))
        kept = None if folder is None else _Folder(folder, task, blocks, str(self.dtype))
        tell = function("progress", progress)
        closing = None
        if cluster is not None:
            if executor is not None:
                raise TypeError("executor, cluster: give one of them")
            distributed = library("distributed")

            executor = closing = distributed.Client(cluster)
        done: dict[int, bytes] = {}
        waiting = []
        for k in range(len(blocks)):
            found = None if kept is None else kept.read(k)
            if found is None:
                waiting.append(k)
            else:
                done[k] = found
        try:
            results = self._here(task, blocks, waiting) if executor is None else self._there(executor, task, blocks, waiting)
            for k, made in results:
                if kept is not None:
                    kept.write(k, made)
                done[k] = made
                if tell is not None:
                    tell("blocks", len(done), len(blocks))
        finally:
            if closing is not None:
                closing.close()
        parts = [_chordal.Block.of_state(*_unpacked(done.pop(k))) for k in range(len(blocks))]
        metres = None if self._unit is None else _METRES[self._unit]
        source, bound = _chordal.joined([part for part in parts if part.n_faces], metres)
        return Mesh._of_source(source, bound_of(json.loads(bound)))

    def _here(self, task: _Task, blocks: list[Block], waiting: list[int]) -> Iterator[tuple[int, bytes]]:
        for k in waiting:
            yield k, _run(task, self._array, blocks[k])

    def _there(
        self, executor: Any, task: _Task, blocks: list[Block], waiting: list[int]
    ) -> Iterator[tuple[int, bytes]]:
        """In other processes; few more at a time than these do at once, so that results do not pile up."""
        is_dask = hasattr(executor, "scheduler_info")
        most = 2 * _workers(executor)
        array = self._array
        if is_dask and hasattr(array, "__array_interface__"):
            # Samples in memory are sent once to each worker, and not with every block.
            array = executor.scatter(array, broadcast=True)
        left = list(reversed(waiting))
        running: dict[Any, int] = {}
        try:
            while left or running:
                while left and len(running) < most:
                    k = left.pop()
                    running[executor.submit(_run, task, array, blocks[k])] = k
                if is_dask:
                    distributed = library("distributed")

                    ready = distributed.wait(list(running), return_when="FIRST_COMPLETED").done
                else:
                    ready = wait(list(running), return_when=FIRST_COMPLETED).done
                for future in ready:
                    k = running.pop(future)
                    yield k, _result(future, blocks[k])
        finally:
            for future in running:
                future.cancel()

    def __repr__(self) -> str:
        i, j, k = self.shape
        return f"<BlockVolume: {i} × {j} × {k} of {self.dtype}>"


def _result(future: Any, block: Block) -> bytes:
    """What a worker made of a block; where it was killed again and again, an `Error` that says which block that was."""
    try:
        made: bytes = future.result()
    except Error:
        raise
    except Exception as error:
        raise Error(f"the block at {block.low} was not done: {type(error).__name__}: {error}") from error
    return made


def block_volume(
    array: Any,
    *,
    spacing: SupportsFloat | Sequence[SupportsFloat] | None = None,
    origin: Sequence[SupportsFloat] | None = None,
    affine: ArrayLike | None = None,
    unit: str | None = None,
) -> BlockVolume:
    """A volume that is read a block at a time: see `BlockVolume`. `array` is anything with a `shape`, a `dtype` and slices,
    or the path of a Zarr array or an .npy file; `array[i, j, k]` is the sample at x = i, y = j, z = k. `spacing`, `origin`,
    `affine` and `unit` are as for `volume`.
    """
    if isinstance(array, (str, os.PathLike)):
        path = os.fspath(array)
        if path.endswith(".npy"):
            array = _NpyFile(path)
        else:
            zarr = library("zarr")

            array = zarr.open_array(path, mode="r")
    return BlockVolume(array, spacing=spacing, origin=origin, affine=affine, unit=unit)


class _NpyFile:
    """The array of an .npy file, which each process opens for itself: a pickle of it is its name."""

    def __init__(self, path: str) -> None:
        self._path: Final = os.path.abspath(path)
        array = self._opened()
        self.shape, self.dtype = array.shape, array.dtype

    def _opened(self) -> Any:
        import numpy as np

        return np.load(self._path, mmap_mode="r")

    def __getitem__(self, slices: tuple[slice, ...]) -> Any:
        return self._opened()[slices]


def _sides(block: SupportsIndex | Sequence[SupportsIndex]) -> tuple[int, int, int]:
    sides = tuple(map(index, block)) if isinstance(block, Sequence) else (index(block),) * 3
    if len(sides) != 3 or min(sides) < 1:
        raise ValueError(f"block: one whole number of at least 1, or three, not {block!r}")
    i, j, k = sides
    return i, j, k


def _workers(executor: Any) -> int:
    """How many tasks it does at once, as far as it says."""
    if hasattr(executor, "scheduler_info"):
        workers = executor.scheduler_info()["workers"].values()
        return max(1, sum(int(worker["nthreads"]) for worker in workers))
    return int(getattr(executor, "_max_workers", None) or os.cpu_count() or 1)


def _packed(arrays: list[bytes], bound: tuple[float, float, list[float] | None] | None) -> bytes:
    """A block as bytes: how long its text is, the text with the lengths of its arrays, the arrays."""
    facts = {"version": _chordal.VERSION, "lengths": [len(array) for array in arrays], "bound": bound}
    text = json.dumps(facts).encode()
    return b"".join([len(text).to_bytes(8, "little"), text, *arrays])


def _unpacked(content: bytes) -> tuple[list[bytes], tuple[float, float, list[float] | None] | None]:
    start = 8 + int.from_bytes(content[:8], "little")
    facts = json.loads(content[8:start])
    if facts["version"] != _chordal.VERSION:
        raise Error(f"a block was made by version {facts['version']}, and this is {_chordal.VERSION}: blocks of both may not fit")
    arrays = []
    for length in facts["lengths"]:
        arrays.append(content[start : start + length])
        start += length
    bound = facts["bound"]
    return arrays, None if bound is None else (bound[0], bound[1], bound[2])


class _Folder:
    """Blocks that are done, in a folder: a file for each, with the digest of what is in it, under a plan that says of what."""

    def __init__(self, folder: str | os.PathLike[str], task: _Task, blocks: list[Block], dtype: str) -> None:
        self._folder: Final = os.fspath(folder)
        plan = {
            "version": _chordal.VERSION,
            "shape": list(task.shape),
            "dtype": dtype,
            "affine": [list(row) for row in task.affine],
            "iso": task.iso,
            "inside": task.inside,
            "capped": task.capped,
            "blocks": [[list(block.low), list(block.high)] for block in blocks],
        }
        content = json.dumps(plan).encode()
        os.makedirs(self._folder, exist_ok=True)
        path = os.path.join(self._folder, "plan.json")
        if os.path.exists(path):
            if _files.read(path) != content:
                raise Error(f"{_files.shown(path)}: this folder holds blocks of another volume, level or version; choose another")
        else:
            _files.replace(path, content)

    def _path(self, k: int) -> str:
        return os.path.join(self._folder, f"block_{k}.chordal")

    def write(self, k: int, made: bytes) -> None:
        """Keeps a block: the file is whole or not there."""
        try:
            _files.replace(self._path(k), _digest(made) + made)
        except OSError as error:
            # A full disk has no name of its own.
            raise OSError(error.errno, error.strerror, self._path(k)) from error

    def read(self, k: int) -> bytes | None:
        """A block that was kept; None where there is none, or where it is damaged."""
        try:
            content = _files.read(self._path(k))
        except FileNotFoundError:
            return None
        made = content[_DIGEST_BYTES:]
        return made if _digest(made) == content[:_DIGEST_BYTES] else None


#: Of SHA-256.
_DIGEST_BYTES = 32


def _digest(content: bytes) -> bytes:
    import hashlib

    return hashlib.sha256(content).digest()

