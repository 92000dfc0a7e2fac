"""`BlockVolume`: samples that stay on disk or elsewhere, meshed block by block, in this process or in others."""

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
from chordal._array_to_volume import steps_of
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
from chordal._html import table
from chordal._images import lattice_of
from chordal._meant import label_list
from chordal._mesh import Mesh
from chordal._units import VOLUME_METRES, refuse_unknown

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray


Result = TypeVar("Result")


class BlockVolume(Guessed):
    """Samples on a lattice that are read block by block: from a Zarr array, a memory-mapped file, a Dask array, or any object
    with a `shape`, a `dtype` and slices. `block_volume` creates it.

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
            hint = "; of several volumes take one, as in array[..., 0]" if len(array.shape) > 3 else ""
            raise ValueError(f"array: three axes, not {len(array.shape)}{hint}")
        self._array: Final = array
        rows = np.asarray(steps_of(spacing, origin, affine), dtype=np.float64).T
        self._affine: Final = tuple(tuple(float(x) for x in row) for row in rows)
        self._unit: Final = text("unit", unit)
        if unit is not None:
            refuse_unknown(unit, VOLUME_METRES)

    @property
    def shape(self) -> tuple[int, int, int]:
        """The number of samples along i, j and k."""
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
        """The 4 × 4 matrix that maps (i, j, k, 1) to space."""
        import numpy as np

        return np.array([*self._affine, (0.0, 0.0, 0.0, 1.0)])

    def blocks(self, block: SupportsIndex | Sequence[SupportsIndex] = 256) -> Iterator[Block]:
        """The blocks with `block` cells along a side, one number or three, in the order of the array."""
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
        """The isosurface at the level `iso`, block by block: bit for bit the vertices and triangles of
        `volume(array).mesh(iso=…)`, closed and manifold across blocks, with a proved bound against the trilinear
        interpolant. With `tol`, a length in the units of the volume or a text as in "0.1mm", the mesh is simplified within that
        length: each block by its worker, which keeps the triangles between blocks, and finally the whole mesh.

        Samples above the level are inside, or those below it if `inside` is "low", as for distances. At level 0 of a type that
        has negative numbers, `inside` is required, since a default would need a look at all samples.

        `block` is the number of cells along a side, one number or three; each task reads its own block and the samples that it
        shares with its neighbours. By default the blocks are meshed in this process one after the other, on all processors.
        `executor` is any object with `submit`: a `ProcessPoolExecutor`, or a `dask.distributed.Client`; `cluster` is the
        address of a Dask scheduler. The array is pickled for each task, so pass one that refers to its samples: a path, or a
        Zarr array.

        With a `folder`, finished blocks are kept in it, and a later call for the same volume, level and blocks resumes there;
        damaged files are computed again. Removing the folder is up to the caller.

        Memory: the result, and one block here or in each worker. Raises `Refused` if there is no surface, `BudgetUnmet` with
        the best mesh if `tol` is less than the error of the blocks themselves, and `Error` with the place of a block that
        cannot be read; finished blocks stay in the folder.
        """
        surface = self._surface(iso, inside, border)
        blocks = list(self.blocks(block))
        metres = self._metres()
        length = self._tolerance(tol)
        if length is None:
            if executor is None and cluster is None and folder is None:
                meshed = self._meshed_here(crossed(self._array, blocks, surface), surface, function("progress", progress))
            else:
                call = partial(mesh_block, surface)
                results = self._results(block, executor, cluster, folder, progress, surface, {}, call)
                results.reverse()
                # Popping frees the bytes of each block as soon as it is unpacked.
                meshed = [block_of(results.pop()) for _ in range(len(results))]
            source, bound = _chordal.joined([part for part in meshed if part.n_faces], metres)
            return Mesh._of_source(source, bound_of(json.loads(bound)))
        # A quarter of the length is for the triangles of a block, another quarter for simplifying it, and the rest for
        # simplifying the joined mesh, where the borders between blocks lose their triangles, too.
        surface = replace(surface, wanted=0.25 * length)
        call = partial(simplified_block, surface, 0.5 * length)
        results = self._results(block, executor, cluster, folder, progress, surface, {"tol": length}, call)
        results.reverse()
        parts = [part for part in (part_of(results.pop()) for _ in range(len(results))) if part is not None]
        if not parts:
            raise Refused("empty", "no block has a surface")
        high = [n - 1 for n in self.shape]
        joined = _chordal.join_parts(parts, {"low": [0, 0, 0], "high": high, "goes_on": [[False, False]] * 3})
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
        """A mesh for each label but 0, or for those in `only`, block by block: the triangles of `chordal.labels(array).mesh()`,
        closed and manifold across blocks, each mesh with a proved bound against its own mask.

        Two labels that meet share the vertices between them. Samples are whole numbers from 0 to 2⁶⁴ - 1. The other
        arguments are those of `mesh`. Memory: all meshes, and one block here or in each worker.

        >>> import chordal, numpy
        >>> halves = numpy.ones((12, 12, 12), numpy.uint8)
        >>> halves[6:] = 2
        >>> meshes = chordal.block_volume(halves, spacing=0.5).labels(block=5)
        >>> [(label, mesh.is_watertight) for label, mesh in meshes.items()]
        [(1, True), (2, True)]
        """
        surface = self._surface(0.5, "high", border)
        chosen = None if only is None else frozenset(label_list("only", only))
        call = partial(mesh_labels, surface, chosen)
        plan = {"labels": None if chosen is None else sorted(chosen)}
        results = self._results(block, executor, cluster, folder, progress, surface, plan, call)
        blocks: dict[int, list[bytes]] = {}
        for result in results:
            for label, content in labels_of(result):
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
        """Writes the meshes of labels to a folder for Neuroglancer (its legacy precomputed format): a fragment for each label
        and block, so that no mesh has to fit in memory. Returns the proved bound of each label.

        With `tol`, a length in the units of the volume, fragments are simplified. Fragments of one label fit together, but two
        labels that meet are simplified separately. The volume needs a unit, since these meshes are in nanometres. Finished
        blocks are kept in the subfolder `parts` until all are done. The other arguments are those of `labels`. Raises
        `BudgetUnmet` with the bounds if the error of a label exceeds `tol`; all files are written in this case, too.

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
            bounds = write_fragments(folder, plan, tasks, self._array, float(self._metres() or 0.0), workers, tell)
        return _within(length, bounds, list(bounds.values()))

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
        """Writes the meshes of labels to a folder for Neuroglancer, in its multi-resolution format, of which it loads coarse
        fragments far away and finer ones nearby. Returns the levels of each label, the finest first, with their bounds.

        The finest level has the meshes of blocks, simplified within `tol`, in the units of the volume. At each coarser level,
        the parts of a label in eight boxes are joined and simplified within twice the length, until one box has the whole
        label in about 64 triangles. The bound of a level is its proved distance to the label's mask, as stored in the file:
        cut and rounded. Neuroglancer shows the coarsest level whose bound is at most "Resolution (mesh)" pixels.

        Each level of a label is closed, except at borders that are left open. The volume needs a unit, since these meshes are
        in nanometres. Fragments are compressed by the package `DracoPy`: `ImportError` if it is missing. `BudgetUnmet`, with
        the levels, is raised as by `precomputed`, and the other arguments are those of `precomputed`. Memory: a block and its
        parts here or in each worker, and a few numbers for each fragment.

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
        # Raises if an axis has no cells.
        next(self.blocks(block))
        tree = LabelTree(surface, Cubes(self.shape, _sides(block)), chosen, length, float(self._metres() or 0.0))
        with Workers(executor, cluster) as workers:
            by_label = tree.build(folder, {**plan, "levels": True}, self._array, workers, function("progress", progress))
        return _within(length, by_label, [levels[0].bound for levels in by_label.values()])

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
        """Writes the isosurface at the level `iso` as 3D Tiles to a folder, also if it is larger than memory. Each block is
        simplified within `tol`, in the units of the volume. Eight blocks are joined and simplified within twice that length,
        and so on until one tile has the whole surface. Without `tol`, the finest tiles have all triangles.

        Tiles meet without cracks in any combination of levels: triangles at the border of two blocks are kept until the
        blocks are joined. The geometric error of a tile, which viewers need, is its proved distance to the trilinear
        interpolant. With `normals`, vertices have normals along the gradient, the same on both sides of a border.

        Tiles are written as soon as they are done, and `tileset.json` is the last file; the subfolder `parts` holds
        intermediate results, from which a later call resumes. `block`, `executor`, `cluster` and `progress` are as for
        `mesh`. Memory: a block and its triangles, here or in each worker, and a few numbers for each tile.

        Raises `Refused` if there is no surface, `BudgetUnmet` with the tileset if the error of the finest tiles exceeds `tol`,
        and `Error` with the place of a block that failed, or for a folder with other content.

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
        # Raises if an axis has no cells.
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
        """The options of meshes for Neuroglancer: the surface, the labels, the tolerance, and the plan of their folder."""
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
        """A text that identifies the samples, for a folder of results: their location, or a digest of their values."""
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

    def _meshed_here(
        self, blocks: list[Block], surface: Surface, tell: Callable[[str, int, int], object] | None
    ) -> list[_chordal.Block]:
        """Blocks that are meshed in this process and kept nowhere, without packing them as bytes."""
        meshed = []
        for block in blocks:
            meshed.append(meshed_block(surface, self._array, block))
            if tell is not None:
                tell("blocks", len(meshed), len(blocks))
        return meshed

    def _results(
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
        """The result of `call` for each block with a surface, in the order of blocks."""
        # Names in the folder count all blocks, so that they stay the same whichever blocks have a surface.
        numbers = {block_of_all: k for k, block_of_all in enumerate(self.blocks(block))}
        blocks = crossed(self._array, list(numbers), surface)
        folder_plan = {**surface.plan(_sides(block), self._identity()), **plan}
        tell = function("progress", progress)
        results: dict[int, bytes] = {}
        waiting: list[Task[int]] = []
        keeping = nullcontext() if folder is None else KeptFolder(folder, folder_plan)
        with keeping as kept, Workers(executor, cluster) as workers:
            array = workers.shared(self._array)
            # `Workers.run` begins with the last task of the list.
            for k in reversed(range(len(blocks))):
                kept_result = None if kept is None else kept.read(f"block_{numbers[blocks[k]]}")
                if kept_result is None:
                    waiting.append((k, named(blocks[k]), (array, blocks[k])))
                else:
                    results[k] = kept_result
            for k, result in workers.run(waiting, call):
                if kept is not None:
                    kept.write(f"block_{numbers[blocks[k]]}", result)
                results[k] = result
                if tell is not None:
                    tell("blocks", len(results), len(blocks))
        return [results[k] for k in range(len(blocks))]

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
    """A volume that is read block by block: see `BlockVolume`.

    `array` is any object with a `shape`, a `dtype` and slices, as an array of Zarr, HDF5 or Dask, or the path of
    - a Zarr array or an OME-Zarr image, by the package `zarr`: `level` is that of the image, 0 the finest;
    - a folder of Neuroglancer's precomputed samples, or its address, by the package `tensorstore`;
    - a NIfTI file, by the package `nibabel`, preferably uncompressed;
    - an .npy file.

    It may also be an image of another library, as for `volume`. Its samples are then in memory, except for a Dask array in an
    `xarray.DataArray`, and for an image of nibabel whose samples are still in a .nii file.

    Or it is a `Field`, sampled with the step `spacing` on a lattice over its box. The values are computed by the worker of
    each block, and blocks in which intervals prove that there is no surface are skipped: the cost of a tileset over 10¹²
    cells is that of its surface, and a mesh costs an interval for each block in addition. If the field is cut off at a box,
    the lattice has as many whole steps as fit in it. A function must return the same value for a point in every batch of
    the same size, whatever the other points are. Bounds are against the trilinear interpolant of the samples; for a bound
    against the field itself, use `Field.mesh`.

    `array[i, j, k]` is the sample at x = i, y = j, z = k. Axes, spacing, origin and unit are those of the file, unless
    `spacing`, `origin` or `affine` override them, as for `volume`. `channel` selects one channel of an image, or one volume of
    a NIfTI file, and is required if there are several.
    """
    if isinstance(array, Field):
        if affine is not None or spacing is None:
            raise TypeError("spacing: the step of the lattice on which a field is sampled, one number or three")
        rows = steps_of(spacing, origin, None)
        steps = [float(rows[k, k]) for k in range(3)]
        if min(steps) <= 0:
            raise ValueError(f"spacing: steps above 0, not {steps}")
        samples = FieldSamples.of(array, steps, None if origin is None else rows[3].tolist())
        return BlockVolume(samples, spacing=samples.steps, origin=samples.origin, unit=unit)
    if isinstance(array, (str, os.PathLike)):
        placed = opened(os.fspath(array), index(level), None if channel is None else index(channel))
    else:
        refuse_choice("level", index(level), "what is no path")
        placed, is_image = _placed_array(array, None if channel is None else index(channel))
        if is_image and (spacing is not None or origin is not None or affine is not None):
            raise TypeError("spacing, origin, affine: this image says them already; pass its array to say others")
    if placed.affine is not None and spacing is None and origin is None and affine is None:
        return BlockVolume(placed.array, affine=placed.affine, unit=unit or placed.unit)
    return BlockVolume(placed.array, spacing=spacing, origin=origin, affine=affine, unit=unit)


def _placed_array(array: Any, channel: int | None) -> tuple[Placed, bool]:
    """The samples of an array or image, in memory, in a mapped file, or in a file that was not read yet; and whether it is an
    image.
    """
    in_file = nibabel_in_file(array, channel)
    if in_file is not None:
        return in_file, True
    refuse_choice("channel", channel, "what is no path")
    lattice = lattice_of(array)
    if lattice is None:
        return Placed(mapped_file(array)), False
    return Placed(lattice.array, matrix_rows(lattice.affine), lattice.unit), True


def _within(length: float | None, result: Result, bounds: Sequence[Bound]) -> Result:
    """The result for labels, if all bounds are within a length; otherwise `BudgetUnmet` carries it."""
    reached = max((math.inf if bound.at_most is None else bound.at_most for bound in bounds), default=0.0)
    if length is not None and reached > length:
        raise BudgetUnmet(f"the meshes of labels are proved to be within {reached:.6g}, not within {length:.6g}", result)
    return result


def _sides(block: SupportsIndex | Sequence[SupportsIndex]) -> tuple[int, int, int]:
    sides = tuple(map(index, block)) if isinstance(block, Sequence) else (index(block),) * 3
    if len(sides) != 3 or min(sides) < 1:
        raise ValueError(f"block: one whole number of at least 1, or three, not {block!r}")
    i, j, k = sides
    return i, j, k
