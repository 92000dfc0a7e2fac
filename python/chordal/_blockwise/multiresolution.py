"""`LabelTree`: simplifies the labels of blocks, joins them by eights and simplifies again, with a fragment of Neuroglancer's
meshes at each step. The levels are done one after the other, since only labels that are in several cubes, or large, have a
coarser level."""

from __future__ import annotations

import importlib
import json
import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

from chordal import _chordal
from chordal._blockwise.cubes import ENOUGH, FIRST, MOST, MOST_TRIES, WORTH_IT, Cube, Cubes
from chordal._blockwise.folder import KeptFolder, left_over, refuse_finished, written
from chordal._blockwise.level_files import Fragment, LevelFiles, MeshLevel, fragments_of
from chordal._blockwise.packing import BoundState, packed, unpacked
from chordal._blockwise.precomputed import HOLDS, NANOMETRES
from chordal._blockwise.tasks import Surface, label_named, labelled
from chordal._errors import Refused

if TYPE_CHECKING:
    from chordal._blockwise.workers import Task, Workers

#: The bits of a coordinate in a fragment: the larger of the two numbers that the format allows.
_BITS = 16
#: Rounding of the transform in the file, in units of the sum of absolute coordinates: two roundings of a product to f64, and
#: some room.
_TRANSFORM_ROUNDING = 2.0**-50
#: How often the tolerance of a block is halved until its fragment, with the rounding, is within the tolerance of the call;
#: after that, its triangles are kept. Chosen: more attempts save triangles in few blocks, and each costs a simplification.
_HALVINGS = 3
#: Draco's compression level, from 0 to 10: the default of its own encoder.
_DRACO_LEVEL = 7
#: The subfolder of results until all are done.
_PARTS = "parts"


class _LabelPart(NamedTuple):
    """The part of a label in a cube, and the tolerance of its next simplification."""

    label: int
    part: _chordal.BlockPart
    length: float


class _FinerLevel(NamedTuple):
    """The level below the one that is being done: its cubes, and the labels that have a coarser level."""

    cubes: frozenset[Cube]
    unfinished: frozenset[int]


class _RoundedFragment(NamedTuple):
    """The vertices and triangles of a fragment as integers, the octants with triangles, and its bound."""

    vertices: bytes
    faces: bytes
    octants: int
    at_most: float


class _CompressedFragment(NamedTuple):
    """The bytes of a fragment; its number of triangles, its bound, and the octants with triangles."""

    content: bytes
    facts: tuple[int, float, int]


@dataclass(frozen=True)
class LabelTree:
    """The cubes of a volume, and the options of their fragments: all that a worker needs except samples and parts."""

    surface: Surface
    cubes: Cubes
    only: frozenset[int] | None
    #: The tolerance of the finest level; None to keep all triangles.
    tolerance: float | None
    metres: float

    def build(
        self,
        folder: str | os.PathLike[str],
        plan: Mapping[str, Any],
        array: Any,
        workers: Workers,
        tell: Callable[[str, int, int], object] | None,
    ) -> dict[int, tuple[MeshLevel, ...]]:
        """Writes all files of a folder, and returns the levels of each label."""
        _draco()
        target = os.fspath(folder)
        document = os.path.join(target, "info")
        refuse_finished(document, HOLDS)
        with KeptFolder(os.path.join(target, _PARTS), plan, is_alone=True) as kept:
            # Another program may have finished meanwhile.
            refuse_finished(document, HOLDS)
            levels: list[dict[Cube, list[Fragment]]] = []
            stale = self._stale(kept)
            shared = workers.shared(array)
            cubes = list(self.cubes.of_level(0))
            below = _FinerLevel(frozenset(), frozenset())
            while cubes:
                level = self._level(cubes, stale, below, shared, kept, workers, tell)
                levels.append(level)
                unfinished = self._unfinished(level)
                below = _FinerLevel(frozenset(level), unfinished)
                parents = {
                    cube.parent
                    for cube, fragments in level.items()
                    if any(fragment.label in unfinished for fragment in fragments)
                }
                cubes = sorted(parents, key=lambda cube: cube.place)
            files = LevelFiles(self.cubes, levels)
            files.write(target, kept, self.surface.affine)
            if files.by_label:
                written(document, self._document())
            for path in left_over(target):
                os.unlink(path)
            kept.remove()
            if not files.by_label:
                raise Refused("empty", "no block has a label")
            return files.facts()

    def _level(
        self,
        cubes: list[Cube],
        stale: frozenset[Cube],
        below: _FinerLevel,
        array: Any,
        kept: KeptFolder,
        workers: Workers,
        tell: Callable[[str, int, int], object] | None,
    ) -> dict[Cube, list[Fragment]]:
        """The fragments of each cube of a level: kept ones, and those of workers for the other cubes."""
        done: dict[Cube, list[Fragment]] = {}
        waiting: list[Task[Cube]] = []
        # `Workers.run` begins with the last task of the list.
        for cube in reversed(cubes):
            kept_fragments = None if cube in stale else _fragments_kept(kept, cube)
            if kept_fragments is not None:
                done[cube] = kept_fragments
                continue
            if cube.level == 0:
                waiting.append((cube, self.cubes.named(cube), (array, cube, [])))
            else:
                waiting.append((cube, self.cubes.named(cube), partial(self._arguments, cube, below, kept)))
        for cube, result in workers.run(waiting, partial(_processed, self)):
            facts, arrays = unpacked(result)
            n = len(facts["parts"])
            kept.write(cube.kept, packed({"parts": facts["parts"]}, arrays[:n]))
            # The fragments are written after the parts, since they mark the cube as done.
            kept.write(fragments_of(cube), packed({"fragments": facts["fragments"]}, arrays[n:]))
            if cube.level > 0:
                # The children's parts are needed no more: this cube is done.
                for child in self.cubes.children(cube):
                    kept.forget(child.kept)
            done[cube] = [Fragment(*row) for row in facts["fragments"]]
            if tell is not None:
                tell(f"level {cube.level}", len(done), len(cubes))
        return {cube: done[cube] for cube in cubes}

    def _arguments(self, cube: Cube, below: _FinerLevel, kept: KeptFolder) -> tuple[None, Cube, list[bytes]]:
        """The arguments of a cube's task, with the parts of unfinished labels in its children."""
        parts: list[bytes] = []
        for child in self.cubes.children(cube):
            if child in below.cubes:
                facts, arrays = unpacked(kept.whole(child.kept, self.cubes.named(child)))
                rows = [(row, part) for row, part in zip(facts["parts"], arrays, strict=True) if row[0] in below.unfinished]
                parts.append(packed({"parts": [row for row, _ in rows]}, [part for _, part in rows]))
        return None, cube, parts

    def _stale(self, kept: KeptFolder) -> frozenset[Cube]:
        """The cubes that have fragments but need to be done again: their parts are gone, and a cube above them is not done."""
        stale: set[Cube] = set()
        top = self.cubes.root()
        while _fragments_kept(kept, top.parent) is not None:
            top = top.parent
        # From the top down: a cube that is done again needs the parts of its children. Whether the cube above the top has to be
        # done is not known yet, so it counts as open.
        open_above = {top.parent}
        for level in range(top.level, -1, -1):
            open_cubes = set()
            for cube in self.cubes.of_level(level):
                is_done = _fragments_kept(kept, cube) is not None
                if is_done and cube.parent in open_above and kept.read(cube.kept) is None:
                    stale.add(cube)
                if not is_done or cube in stale:
                    open_cubes.add(cube)
            open_above = open_cubes
        return frozenset(stale)

    def _unfinished(self, level: Mapping[Cube, Sequence[Fragment]]) -> frozenset[int]:
        """The labels that need a coarser level: those in several cubes, or with many triangles."""
        seen: set[int] = set()
        unfinished: set[int] = set()
        for fragments in level.values():
            for fragment in fragments:
                is_large = fragment.n_faces > ENOUGH and fragment.length < self.surface.extent()
                if is_large or fragment.label in seen:
                    unfinished.add(fragment.label)
                seen.add(fragment.label)
        return frozenset(unfinished)

    def _document(self) -> bytes:
        scale = self.metres * NANOMETRES
        rows = [[number * scale for number in row] for row in self.surface.affine]
        info = {
            "@type": "neuroglancer_multilod_draco",
            "vertex_quantization_bits": _BITS,
            "transform": [number for row in rows for number in row],
            "lod_scale_multiplier": 1,
        }
        return json.dumps(info).encode()

    def within(self, cube: Cube) -> _chordal.FragmentArguments:
        """The box of the fragments of a cube."""
        return {
            "low": list(self.cubes.low(cube)),
            "sides": list(self.cubes.sides_of(cube)),
            "affine": [list(row) for row in self.surface.affine],
            "is_halved": cube.level > 0,
        }

    def rounding(self) -> float:
        """The rounding error of the transform in the file, as a distance in the volume."""
        return _TRANSFORM_ROUNDING * self.surface.farthest()

    def step(self, cube: Cube) -> float:
        """The sum of half a step along each axis: about the distance by which rounding in a fragment moves a point."""
        sides = self.cubes.sides_of(cube)
        lengths = (math.hypot(*(row[k] for row in self.surface.affine)) * sides[k] for k in range(3))
        return 0.5 * sum(lengths) / ((1 << _BITS) - 1)


def _draco() -> Any:
    try:
        return importlib.import_module("DracoPy")
    except ImportError as error:
        message = "Neuroglancer's meshes of several levels are compressed by Draco: install the package DracoPy"
        raise ImportError(f"{message}, as by pip install DracoPy, here and where workers are", name="DracoPy") from error


def _fragments_kept(kept: KeptFolder, cube: Cube) -> list[Fragment] | None:
    """The fragments of a cube, if it is done."""
    content = kept.read(fragments_of(cube))
    return None if content is None else [Fragment(*row) for row in unpacked(content)[0]["fragments"]]


def _processed(tree: LabelTree, array: Any, cube: Cube, below: Sequence[bytes]) -> bytes:
    """The result of a worker for a block, or for a cube with the parts of its children: each label's part and fragment."""
    labels: list[tuple[int, BoundState, float]] = []
    parts: list[bytes] = []
    fragments: list[Fragment] = []
    contents: list[bytes] = []
    for label_part, compressed in _leaves(tree, array, cube) if cube.level == 0 else _joined(tree, cube, below):
        label, part, length = label_part
        state, bound = part.state()
        labels.append((label, bound, length))
        parts.append(state)
        fragments.append(Fragment(label, length, part.n_faces, *compressed.facts, len(compressed.content)))
        contents.append(compressed.content)
    return packed({"parts": labels, "fragments": fragments}, [*parts, *contents])


def _leaves(tree: LabelTree, array: Any, cube: Cube) -> Iterator[tuple[_LabelPart, _CompressedFragment]]:
    """The labels of a block, within the tolerance if that is possible."""
    block = tree.cubes.block(cube)
    arguments = tree.surface.arguments(block, block.low)
    samples, names = labelled(array, block)
    for rank, part in _chordal.label_parts(samples, arguments, tree.surface.place(block)):
        label = label_named(rank, names)
        if tree.only is not None and label not in tree.only:
            continue
        first = FIRST * tree.surface.cell()
        if tree.tolerance is None:
            yield _LabelPart(label, part, max(part.at_most, first)), _compressed(_fragment(tree, cube, part))
            continue
        room = tree.tolerance - part.at_most - tree.step(cube) - tree.rounding()
        # The loss by rounding is known only afterwards, so the room is halved until the fragment is within the tolerance.
        # Without room, or if no try is, the part stays as it is.
        for halving in range(_HALVINGS + 1 if room > 0.0 else 0):
            chosen = part.simplified(room * 0.5**halving)
            fragment = _fragment(tree, cube, chosen)
            if fragment.at_most <= tree.tolerance:
                break
        else:
            chosen, fragment = part, _fragment(tree, cube, part)
        yield _LabelPart(label, chosen, max(tree.tolerance, first)), _compressed(fragment)


def _joined(tree: LabelTree, cube: Cube, below: Sequence[bytes]) -> Iterator[tuple[_LabelPart, _CompressedFragment]]:
    """The joined parts of each label, simplified if that saves enough triangles."""
    place = tree.surface.place(tree.cubes.block(cube))
    by_label: dict[int, list[_LabelPart]] = {}
    for child in below:
        facts, arrays = unpacked(child)
        for (label, (least, most, at), length), content in zip(facts["parts"], arrays, strict=True):
            part = _chordal.BlockPart.of_state(content, (least, most, at))
            by_label.setdefault(label, []).append(_LabelPart(label, part, length))
    for label in sorted(by_label):
        parts = by_label.pop(label)
        for _ in range(MOST_TRIES):
            if sum(label_part.part.n_faces for label_part in parts) <= 2 * MOST:
                break
            parts = [_coarser(label_part) for label_part in parts]
        joined = _chordal.join_parts([label_part.part for label_part in parts], place)
        coarser = _coarser(_LabelPart(label, joined, max(label_part.length for label_part in parts)))
        yield coarser, _compressed(_fragment(tree, cube, coarser.part))


def _coarser(finer: _LabelPart) -> _LabelPart:
    """Simplifies a part, if that saves enough triangles; the next tolerance is twice as large in any case."""
    simplified = finer.part.simplified(finer.length)
    is_worth_it = simplified.n_faces <= WORTH_IT * finer.part.n_faces
    return _LabelPart(finer.label, simplified if is_worth_it else finer.part, 2.0 * finer.length)


def _fragment(tree: LabelTree, cube: Cube, part: _chordal.BlockPart) -> _RoundedFragment:
    """The fragment of a part, with its coordinates rounded to the lattice of the format."""
    vertices, faces, octants, moved = part.lattice_fragment(tree.surface.place(tree.cubes.block(cube)), tree.within(cube))
    at_most: float = part.at_most
    for error in (moved, tree.rounding()):
        at_most = math.nextafter(at_most + error, math.inf)
    return _RoundedFragment(vertices, faces, octants, at_most)


def _compressed(fragment: _RoundedFragment) -> _CompressedFragment:
    import numpy as np

    # Signed 32-bit integers are the only type that Neuroglancer accepts, and Draco keeps them exactly.
    numbers = np.frombuffer(fragment.vertices, np.int32).reshape(-1, 3)
    corners = np.frombuffer(fragment.faces, np.uint32).reshape(-1, 3)
    content = bytes(_draco().encode(numbers, corners, compression_level=_DRACO_LEVEL))
    return _CompressedFragment(content, (len(corners), fragment.at_most, fragment.octants))
