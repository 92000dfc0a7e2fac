"""`BlockVolume`: samples that stay where they are, meshed block by block, here or in other processes."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from itertools import product
from operator import index
from typing import TYPE_CHECKING, Any, Final, Literal, SupportsFloat, SupportsIndex, TypeVar

from chordal import _chordal
from chordal._arguments import function, number, text
from chordal._blockwise.cubes import Cubes
from chordal._blockwise.folder import KeptFolder
from chordal._blockwise.level_files import MeshLevel
from chordal._blockwise.multiresolution import LabelTree
from chordal._blockwise.precomputed import write_fragments
from chordal._blockwise.sampled import FieldSamples, crossed
from chordal._blockwise.sources import (
    Placed,
    mapped_file,
    matrix_rows,
    nibabel_in_file,
    opened,
    refuse_choice,
    source_of,
)
from chordal._blockwise.tasks import (
    Block,
    Surface,
    block_of,
    labels_of,
    mesh_block,
    mesh_labels,
    meshed_block,
    named,
    part_of,
    simplified_block,
)
from chordal._blockwise.tree import BlockTree, Tileset
from chordal._blockwise.workers import Task, Workers
from chordal._bound import Bound, bound_of
from chordal._budget import Length, length_in
from chordal._errors import BudgetError, BudgetUnmet, Refused
from chordal._field import Field
from chordal._hints import Guessed, keywords_hinted
from chordal._images import lattice_of
from chordal._meant import label_list
from chordal._table import table
from chordal._units import VOLUME_METRES, refuse_unknown
from chordal._volume import _steps

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from chordal._mesh import Mesh


Made = TypeVar("Made")


class BlockVolume(Guessed):
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
            one = "; of several volumes take one, as in array[..., 0]" if len(array.shape) > 3 else ""
            raise ValueError(f"array: three axes, not {len(array.shape)}{one}")
        self._array: Final = array
        rows = np.asarray(_steps(spacing, origin, affine), dtype=np.float64).T
        self._affine: Final = tuple(tuple(float(x) for x in row) for row in rows)
        self._unit: Final = text("unit", unit)
        if unit is not None:
            refuse_unknown(unit, VOLUME_METRES)

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

    @keywords_hinted
    def mesh(
        self,
        *,
        iso: SupportsFloat,
        tol: Length | None = None,
        inside: Literal["high", "low"] | None = None,
        border: Literal["capped", "open"] = "capped",
        block: SupportsIndex | Sequence[SupportsIndex] = 256,
        executor: Any | None = None,
        cluster: str | None = None,
        folder: str | os.PathLike[str] | None = None,
        progress: Callable[[str, int, int], object] | None = None,
    ) -> Mesh:
        """The surface at the level `iso`, block by block: bit for bit the vertices and triangles of
        `volume(array).mesh(iso=…)`, closed and manifold across blocks, with a proved bound against the trilinear
        interpolant. With `tol`, a length in the units of the volume or a text as in "0.1mm", it has fewer triangles, within that
        length: each block is simplified where it is done, with the triangles between blocks as they are, and the whole at last.

        What is above the level is inside, or below it where `inside` is "low", as for distances; at level 0 of samples that
        may be negative one has to say which, since nobody looks at all samples first.

        `block` is the number of cells along a side, one or three; each task reads its own block and the samples that it
        shares with its neighbours. Without more the blocks are done here one after the other, on all processors. `executor`
        is anything with `submit`: a `ProcessPoolExecutor`, or a `dask.distributed.Client`; `cluster` is the address of a
        Dask scheduler. The array is pickled for each task, so give one that says where its samples are: a path, or a Zarr array.

        With a `folder` each block that is done is kept there, and a later call goes on where one ended, of the same volume,
        level and blocks; a file that is damaged is done again. Its results are removed by whoever made the folder.

        Memory is that of the result, and of one block here or in each worker. Raises `Refused` where there is no surface,
        `BudgetUnmet` with the best where `tol` is less than what the blocks themselves are off by, and `Error` with the place
        of a block that cannot be read; what is done stays in the folder.
        """
        from chordal._mesh import Mesh

        surface = self._surface(iso, inside, border)
        blocks = list(self.blocks(block))
        metres = self._metres()
        length = self._tolerance(tol)
        if length is None:
            if executor is None and cluster is None and folder is None:
                whole = self._here(crossed(self._array, blocks, surface), surface, function("progress", progress))
            else:
                call = partial(mesh_block, surface)
                done = self._done(block, executor, cluster, folder, progress, surface, {}, call)
                done.reverse()
                # The bytes of each are let go when it is made.
                whole = [block_of(done.pop()) for _ in range(len(done))]
            source, bound = _chordal.joined([part for part in whole if part.n_faces], metres)
            return Mesh._of_source(source, bound_of(json.loads(bound)))
        # A quarter for the triangles of a block, another for fewer, and what is left for the lines between them.
        surface = replace(surface, wanted=0.25 * length)
        call = partial(simplified_block, surface, 0.5 * length)
        done = self._done(block, executor, cluster, folder, progress, surface, {"tol": length}, call)
        done.reverse()
        parts = [part for part in (part_of(done.pop()) for _ in range(len(done))) if part is not None]
        if not parts:
            raise Refused("empty", "no block has a surface")
        most = tuple(n - 1 for n in self.shape)
        joined = _chordal.join_parts(parts, {"low": [0, 0, 0], "high": list(most), "goes_on": [[False, False]] * 3})
        if joined.at_most < length:
            joined = joined.simplified(length - joined.at_most)
        source, bound = joined.source(metres)
        mesh = Mesh._of_source(source, bound_of(json.loads(bound)))
        if joined.at_most > length:
            message = f"the triangles of the blocks are proved to be within {joined.at_most:.6g}, not within {length:.6g}"
            raise BudgetUnmet(message, mesh)
        return mesh

    @keywords_hinted
    def labels(
        self,
        only: Sequence[SupportsIndex] | SupportsIndex | None = None,
        *,
        border: Literal["capped", "open"] = "capped",
        block: SupportsIndex | Sequence[SupportsIndex] = 256,
        executor: Any | None = None,
        cluster: str | None = None,
        folder: str | os.PathLike[str] | None = None,
        progress: Callable[[str, int, int], object] | None = None,
    ) -> dict[int, Mesh]:
        """A mesh for each label but 0, or for `only` some, block by block: the triangles that `chordal.labels(array).mesh()`
        has for it, closed and manifold across blocks, each with a proved bound against its own mask.

        Two labels that meet have the same vertices between them. Samples are whole numbers from 0 to 2⁶⁴ - 1. The other
        arguments are those of `mesh`; memory is that of all meshes, and of one block here or in each worker.

        >>> import chordal, numpy
        >>> halves = numpy.ones((12, 12, 12), numpy.uint8)
        >>> halves[6:] = 2
        >>> meshes = chordal.block_volume(halves, spacing=0.5).labels(block=5)
        >>> [(label, mesh.is_watertight) for label, mesh in meshes.items()]
        [(1, True), (2, True)]
        """
        from chordal._mesh import Mesh

        surface = self._surface(0.5, "high", border)
        chosen = None if only is None else frozenset(label_list("only", only))
        call = partial(mesh_labels, surface, chosen)
        plan = {"labels": None if chosen is None else sorted(chosen)}
        done = self._done(block, executor, cluster, folder, progress, surface, plan, call)
        blocks: dict[int, list[bytes]] = {}
        for made in done:
            for label, content in labels_of(made):
                blocks.setdefault(label, []).append(content)
        metres = self._metres()
        meshes = {}
        for label in sorted(blocks):
            source, bound = _chordal.joined([block_of(content) for content in blocks.pop(label)], metres)
            meshes[label] = Mesh._of_source(source, bound_of(json.loads(bound)))
        return meshes

    @keywords_hinted
    def precomputed(
        self,
        folder: str | os.PathLike[str],
        only: Sequence[SupportsIndex] | SupportsIndex | None = None,
        *,
        tol: Length | None = None,
        border: Literal["capped", "open"] = "capped",
        block: SupportsIndex | Sequence[SupportsIndex] = 256,
        executor: Any | None = None,
        cluster: str | None = None,
        progress: Callable[[str, int, int], object] | None = None,
    ) -> dict[int, Bound]:
        """The meshes of labels in a folder that Neuroglancer reads (its legacy precomputed format), a fragment for each label
        and block, so that none of them is in one place. Gives back the bound of each label, proved.

        With `tol`, a length in the units of the volume, fragments have fewer triangles; those of one label fit, while two
        labels that meet are simplified each by itself. The volume needs a unit, since these meshes are in nanometres.
        What is done is kept in the subfolder `parts` until all is; the other arguments are those of `labels`. Raises
        `BudgetUnmet` with the bounds where a label is off by more than `tol`; all files are there then, too.

        >>> import chordal, numpy, os, tempfile
        >>> halves = numpy.ones((12, 12, 12), numpy.uint8)
        >>> halves[6:] = 2
        >>> folder = tempfile.mkdtemp()
        >>> bounds = chordal.block_volume(halves, spacing=0.5, unit="um").precomputed(folder, tol=0.2, block=6)
        >>> [(label, bound.at_most <= 0.2) for label, bound in bounds.items()], sorted(os.listdir(folder))[:2]
        ([(1, True), (2, True)], ['1:0', '1:0:0_0_0'])
        """
        surface, chosen, length, plan = self._labels_in_nanometres(only, tol, border, block)
        blocks = list(self.blocks(block))
        tell = function("progress", progress)
        with Workers(executor, cluster) as workers:
            tasks = (surface, blocks, chosen, length)
            made = write_fragments(folder, plan, tasks, self._array, float(self._metres() or 0.0), workers, tell)
        return _within(length, made, list(made.values()))

    @keywords_hinted
    def precomputed_levels(
        self,
        folder: str | os.PathLike[str],
        only: Sequence[SupportsIndex] | SupportsIndex | None = None,
        *,
        tol: Length | None = None,
        border: Literal["capped", "open"] = "capped",
        block: SupportsIndex | Sequence[SupportsIndex] = 128,
        executor: Any | None = None,
        cluster: str | None = None,
        progress: Callable[[str, int, int], object] | None = None,
    ) -> dict[int, tuple[MeshLevel, ...]]:
        """The meshes of labels in a folder that Neuroglancer reads, in its format of several levels: it loads few triangles for
        what is far, and more where one comes near. Gives back the levels of each label, the finest first, with their bounds.

        The finest level is that of blocks, simplified within `tol`, in the units of the volume. At each level beyond, the
        parts of a label in eight boxes are joined and simplified within twice the length, until one box has all of it in some
        64 triangles. A level's bound is its proved distance to the label's own mask, as the file has it: cut and rounded.
        Neuroglancer shows the coarsest level whose bound is at most as many pixels as its "Resolution (mesh)" says.

        The levels of a label are closed, each by itself, but for borders that are left open. The volume needs a unit, since
        these meshes are in nanometres, and fragments are compressed by the package `DracoPy`: `ImportError` where it is
        missing. `BudgetUnmet`, with the levels, is raised as by `precomputed`. The other arguments are those of
        `precomputed`; memory is that of a block and its parts here or in each worker, and here some numbers for each fragment.

        >>> import chordal, numpy, os, tempfile
        >>> i, j, k = numpy.indices((40, 40, 40)) - 20.0
        >>> ball = (i * i + j * j + k * k < 300).astype(numpy.uint8)
        >>> folder = tempfile.mkdtemp()
        >>> volume = chordal.block_volume(ball, spacing=8.0, unit="um")
        >>> levels = volume.precomputed_levels(folder, tol=4.0, block=16)
        >>> levels[1][0].bound.at_most <= 4.0 and levels[1][-1].triangles < 300, sorted(os.listdir(folder))
        (True, ['1', '1.index', 'info'])
        """
        surface, chosen, length, plan = self._labels_in_nanometres(only, tol, border, block)
        next(self.blocks(block))
        tree = LabelTree(surface, Cubes(self.shape, _sides(block)), chosen, length, float(self._metres() or 0.0))
        with Workers(executor, cluster) as workers:
            made = tree.build(folder, {**plan, "levels": True}, self._array, workers, function("progress", progress))
        return _within(length, made, [levels[0].bound for levels in made.values()])

    @keywords_hinted
    def tileset(
        self,
        folder: str | os.PathLike[str],
        *,
        iso: SupportsFloat,
        tol: Length | None = None,
        inside: Literal["high", "low"] | None = None,
        border: Literal["capped", "open"] = "capped",
        normals: bool = True,
        block: SupportsIndex | Sequence[SupportsIndex] = 128,
        executor: Any | None = None,
        cluster: str | None = None,
        progress: Callable[[str, int, int], object] | None = None,
    ) -> Tileset:
        """The surface at the level `iso` as 3D Tiles in a folder: it is never in one place, so that it may be larger than
        memory. Each block is simplified within `tol`, in the units of the volume, and eight blocks are simplified together
        within twice, four times that and so on until one tile shows all. Without `tol` the finest tiles have all triangles.

        Tiles meet without cracks whichever are shown: where blocks meet, their triangles stay as they are until these are
        one block. The error of a tile, which viewers ask for, is its proved distance to the trilinear interpolant. With
        `normals` vertices have the gradient's, the same on both sides of a block.

        Tiles are written as they are done and `tileset.json` at last; what is kept in the subfolder `parts` meanwhile lets a
        later call go on where one ended. `block`, `executor`, `cluster` and `progress` are as for `mesh`. Memory is that of a
        block and of its triangles, here or in each worker, and of a few numbers for each tile.

        Raises `Refused` where there is no surface, `BudgetUnmet` with the tileset where the finest tiles are off by more than
        `tol`, and `Error` with the place of a block that was not done, or for a folder that holds something else.

        >>> import chordal, numpy, tempfile
        >>> i, j, k = numpy.indices((40, 40, 40)) - 20.0
        >>> ball = chordal.block_volume(numpy.sqrt(i * i + j * j + k * k) - 15, spacing=0.5)
        >>> made = ball.tileset(tempfile.mkdtemp(), iso=0, inside="low", tol=0.1, block=16)
        >>> made.bound.evidence, made.bound.at_most <= 0.1, made.tiles > 9
        ('proved', True, True)
        """
        length = self._tolerance(tol)
        wanted = None if length is None else 0.5 * length
        surface = replace(self._surface(iso, inside, border), normals=bool(normals), wanted=wanted)
        metres = self._metres()
        tree = BlockTree(surface, Cubes(self.shape, _sides(block)), length, metres)
        next(self.blocks(block))
        plan = {**surface.plan(_sides(block), self._identity()), "tol": length, "unit": self._unit}
        with Workers(executor, cluster) as workers:
            return tree.build(folder, plan, self._array, workers, function("progress", progress))

    def _labels_in_nanometres(
        self,
        only: Sequence[SupportsIndex] | SupportsIndex | None,
        tol: Length | None,
        border: str,
        block: SupportsIndex | Sequence[SupportsIndex],
    ) -> tuple[Surface, frozenset[int] | None, float | None, dict[str, Any]]:
        """Which meshes of Neuroglancer's are meant: the surface, the labels, the length, and the plan of their folder."""
        if self._unit is None:
            raise ValueError("unit: these meshes are in nanometres; say that of the volume, as in block_volume(…, unit=\"nm\")")
        surface = self._surface(0.5, "high", border)
        chosen = None if only is None else frozenset(label_list("only", only))
        length = self._tolerance(tol)
        named_labels = None if chosen is None else sorted(chosen)
        plan = {**surface.plan(_sides(block), self._identity()), "labels": named_labels, "tol": length, "unit": self._unit}
        return surface, chosen, length, plan

    def _metres(self) -> float | None:
        return None if self._unit is None else float(VOLUME_METRES[self._unit])

    def _identity(self) -> str:
        """What tells these samples from others, for a folder of results: where they are, or some of them."""
        return f"{self.dtype} {source_of(self._array)}"

    def _tolerance(self, tol: Length | None) -> float | None:
        length = None if tol is None else length_in("tol", tol, self._unit)
        if length is not None and not length > 0:
            raise BudgetError(f"tol: a length above 0, not {length}")
        return length

    def _surface(self, iso: SupportsFloat, inside: str | None, border: str) -> Surface:
        level = number("iso", iso)
        if inside is None:
            if isinstance(self._array, FieldSamples):
                inside = "low"
            elif level == 0.0 and self.dtype.kind in "fi":
                raise ValueError("inside: 'low' if these are distances, else 'high'; level 0 alone does not say which")
            else:
                inside = "high"
        if inside not in ("high", "low"):
            raise ValueError(f"inside: 'high' or 'low', not {inside!r}")
        if border not in ("capped", "open"):
            raise ValueError(f"border: 'capped' or 'open', not {border!r}")
        return Surface(self._affine, self.shape, level, inside, border == "capped")

    def _here(
        self, blocks: list[Block], surface: Surface, tell: Callable[[str, int, int], object] | None
    ) -> list[_chordal.Block]:
        """Blocks that nobody else does and nothing keeps: these need not become bytes in between."""
        made = []
        for block in blocks:
            made.append(meshed_block(surface, self._array, block))
            if tell is not None:
                tell("blocks", len(made), len(blocks))
        return made

    def _done(
        self,
        block: SupportsIndex | Sequence[SupportsIndex],
        executor: Any | None,
        cluster: str | None,
        folder: str | os.PathLike[str] | None,
        progress: Callable[[str, int, int], object] | None,
        surface: Surface,
        plan: dict[str, Any],
        call: Callable[..., bytes],
    ) -> list[bytes]:
        """What is made of each block, in their order."""
        numbers = {one: k for k, one in enumerate(self.blocks(block))}
        blocks = crossed(self._array, list(numbers), surface)
        whole = {**surface.plan(_sides(block), self._identity()), **plan}
        tell = function("progress", progress)
        done: dict[int, bytes] = {}
        waiting: list[Task[int]] = []
        keeping = nullcontext() if folder is None else KeptFolder(folder, whole)
        with keeping as kept, Workers(executor, cluster) as workers:
            array = workers.shared(self._array)
            for k in reversed(range(len(blocks))):
                found = None if kept is None else kept.read(f"block_{numbers[blocks[k]]}")
                if found is None:
                    waiting.append((k, named(blocks[k]), (array, blocks[k])))
                else:
                    done[k] = found
            for k, made in workers.run(waiting, call):
                if kept is not None:
                    kept.write(f"block_{numbers[blocks[k]]}", made)
                done[k] = made
                if tell is not None:
                    tell("blocks", len(done), len(blocks))
        return [done[k] for k in range(len(blocks))]

    def _repr_html_(self) -> str:
        i, j, k = self.shape
        low, *steps = (", ".join(f"{row[column]:.6g}" for row in self._affine) for column in (3, 0, 1, 2))
        rows = [("samples", f"{i} × {j} × {k} of {self.dtype}, not read yet"), ("first sample", f"({low})")]
        rows += [(f"step of {axis}", f"({step})") for axis, step in zip("ijk", steps, strict=True)]
        return table("BlockVolume", [*rows, *([] if self._unit is None else [("unit", self._unit)])])

    def __repr__(self) -> str:
        i, j, k = self.shape
        return f"<BlockVolume: {i} × {j} × {k} of {self.dtype}>"


def block_volume(
    array: Any,
    *,
    spacing: SupportsFloat | Sequence[SupportsFloat] | None = None,
    origin: Sequence[SupportsFloat] | None = None,
    affine: ArrayLike | None = None,
    unit: str | None = None,
    level: SupportsIndex = 0,
    channel: SupportsIndex | None = None,
) -> BlockVolume:
    """A volume that is read a block at a time: see `BlockVolume`.

    `array` is anything with a `shape`, a `dtype` and slices, as an array of Zarr, HDF5 or Dask, or the path of
    - a Zarr array or an OME-Zarr image, by the package `zarr`: `level` is that of the image, 0 the finest;
    - a folder of Neuroglancer's precomputed samples, or its address, by the package `tensorstore`;
    - a NIfTI file, by the package `nibabel`, best one that is not compressed;
    - an .npy file.

    An image of another library, as `volume` takes, will do as well: its samples are in memory then, but for an array of Dask
    in an `xarray.DataArray`, and an image of nibabel whose samples are in a .nii still.

    Or it is a `Field`, which `spacing` samples at the points of a lattice over its box: these values are computed where a
    block is done, and boxes of blocks in which intervals prove that there is no surface are passed over, so that the
    tileset of a lattice of 10¹² cells costs what its surface costs, and a mesh that and an interval for each block. A field
    that is cut off at a box has as many whole steps as are in that. A function is to have the same value for a point
    whichever others it is asked for with, in as many. Bounds are against the trilinear interpolant of the samples, not
    against the field: that is what `Field.mesh` does.

    `array[i, j, k]` is the sample at x = i, y = j, z = k; what a file says of axes, spacing, origin and unit holds unless
    `spacing`, `origin` or `affine` say others, as for `volume`. `channel` is that of an image of several, or the volume of
    a NIfTI file of several, where one has to say which.
    """
    if isinstance(array, Field):
        if affine is not None or spacing is None:
            raise TypeError("spacing: the step of the lattice on which a field is sampled, one number or three")
        rows = _steps(spacing, origin, None)
        steps = [float(rows[k, k]) for k in range(3)]
        if min(steps) <= 0:
            raise ValueError(f"spacing: steps above 0, not {steps}")
        samples = FieldSamples.of(array, steps, None if origin is None else rows[3].tolist())
        return BlockVolume(samples, spacing=samples.steps, origin=samples.origin, unit=unit)
    if isinstance(array, (str, os.PathLike)):
        found = opened(os.fspath(array), index(level), None if channel is None else index(channel))
    else:
        refuse_choice("level", index(level), "what is no path")
        found, is_image = _in_other_hands(array, None if channel is None else index(channel))
        if is_image and (spacing is not None or origin is not None or affine is not None):
            raise TypeError("spacing, origin, affine: this image says them already; pass its array to say others")
    if found.affine is not None and spacing is None and origin is None and affine is None:
        return BlockVolume(found.array, affine=found.affine, unit=unit or found.unit)
    return BlockVolume(found.array, spacing=spacing, origin=origin, affine=affine, unit=unit)


def _in_other_hands(array: Any, channel: int | None) -> tuple[Placed, bool]:
    """What is no path: samples in memory, mapped, or in the file of an image that was not read yet; and whether it is an image."""
    in_file = nibabel_in_file(array, channel)
    if in_file is not None:
        return in_file, True
    refuse_choice("channel", channel, "what is no path")
    known = lattice_of(array)
    if known is None:
        return Placed(mapped_file(array)), False
    return Placed(known.array, matrix_rows(known.affine), known.unit), True


def _within(length: float | None, made: Made, bounds: Sequence[Bound]) -> Made:
    """What was made of labels; raised as the best there is where one is off by more than a length."""
    reached = max((math.inf if bound.at_most is None else bound.at_most for bound in bounds), default=0.0)
    if length is not None and reached > length:
        raise BudgetUnmet(f"the meshes of labels are proved to be within {reached:.6g}, not within {length:.6g}", made)
    return made


def _sides(block: SupportsIndex | Sequence[SupportsIndex]) -> tuple[int, int, int]:
    sides = tuple(map(index, block)) if isinstance(block, Sequence) else (index(block),) * 3
    if len(sides) != 3 or min(sides) < 1:
        raise ValueError(f"block: one whole number of at least 1, or three, not {block!r}")
    i, j, k = sides
    return i, j, k
