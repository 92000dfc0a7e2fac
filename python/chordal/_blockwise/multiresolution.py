"""`LabelTree`: the labels of blocks simplified, joined by eights and simplified again, each level a fragment of Neuroglancer's
meshes. Level after level is done, since a label goes on only where it is in several cubes or large."""

from __future__ import annotations

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
from chordal._libraries import library

if TYPE_CHECKING:
    from chordal._blockwise.workers import Task, Workers

#: The bits of a coordinate in a fragment: the larger of the two numbers that the format has.
_BITS = 16
#: Rounding of the transform as the file says it, in units of the sum of its coordinates' sizes: two roundings of a product
#: to f64, and some room.
_TRANSFORM_ROUNDING = 2.0**-50
#: How often the length within which a block is simplified is halved, so that with what leaves the block it is within the
#: length that was asked for. Chosen; then its triangles stay as they are.
_HALVINGS = 3
#: How hard Draco tries, of 0 to 10: the default of its own encoder.
_DRACO_LEVEL = 7
#: Where the results of tasks are meanwhile.
_PARTS = "parts"


class _Grown(NamedTuple):
    """A label in a cube: its part, which goes into larger ones."""

    label: int
    part: _chordal.BlockPart
    length: float


class _Below(NamedTuple):
    """The level below one that is to be done: its cubes, and the labels that go on."""

    cubes: frozenset[Cube]
    left: frozenset[int]


class _Rounded(NamedTuple):
    """The vertices and triangles of a fragment in whole numbers, the eighths that it has, and its bound."""

    vertices: bytes
    faces: bytes
    octants: int
    at_most: float


class _Compressed(NamedTuple):
    """The bytes of a fragment; its triangles, its bound and the eighths that it has."""

    content: bytes
    facts: tuple[int, float, int]


@dataclass(frozen=True)
class LabelTree:
    """What is made of the labels in each cube of a volume: all that a worker needs, but for samples and parts."""

    surface: Surface
    cubes: Cubes
    only: frozenset[int] | None
    #: The length within which the finest level is to be; None for all triangles.
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
        """All files of a folder; the levels of each label."""
        _draco()
        target = os.fspath(folder)
        document = os.path.join(target, "info")
        refuse_finished(document, HOLDS)
        with KeptFolder(os.path.join(target, _PARTS), plan, is_alone=True) as kept:
            # Another program may have finished meanwhile.
            refuse_finished(document, HOLDS)
            found: list[dict[Cube, list[Fragment]]] = []
            again = self._again(kept)
            shared = workers.shared(array)
            cubes = list(self.cubes.of_level(0))
            below = _Below(frozenset(), frozenset())
            while cubes:
                found.append(self._level(cubes, again, below, shared, kept, workers, tell))
                left = self._unfinished(found[-1])
                below = _Below(frozenset(found[-1]), left)
                holding = (cube.parent for cube, fragments in found[-1].items() if any(one.label in left for one in fragments))
                cubes = sorted(set(holding), key=lambda cube: cube.place)
            made = LevelFiles(self.cubes, found)
            made.write(target, kept, self.surface.affine)
            if made.by_label:
                written(document, self._document())
            for path in left_over(target):
                os.unlink(path)
            kept.remove()
            if not made.by_label:
                raise Refused("empty", "no block has a label")
            return made.facts()

    def _level(
        self,
        cubes: list[Cube],
        again: frozenset[Cube],
        below: _Below,
        array: Any,
        kept: KeptFolder,
        workers: Workers,
        tell: Callable[[str, int, int], object] | None,
    ) -> dict[Cube, list[Fragment]]:
        """What each cube of a level has, those that are not done by workers."""
        done: dict[Cube, list[Fragment]] = {}
        waiting: list[Task[Cube]] = []
        for cube in reversed(cubes):
            found = None if cube in again else _fragments_kept(kept, cube)
            if found is not None:
                done[cube] = found
                continue
            if cube.level == 0:
                waiting.append((cube, self.cubes.named(cube), (array, cube, [])))
            else:
                waiting.append((cube, self.cubes.named(cube), partial(self._given, cube, below, kept)))
        for cube, made in workers.run(waiting, partial(_made, self)):
            facts, arrays = unpacked(made)
            n = len(facts["parts"])
            kept.write(cube.kept, packed({"parts": facts["parts"]}, arrays[:n]))
            # At last: it says that the cube is done.
            kept.write(fragments_of(cube), packed({"fragments": facts["fragments"]}, arrays[n:]))
            if cube.level > 0:
                for child in self.cubes.children(cube):
                    kept.forget(child.kept)
            done[cube] = [Fragment(*row) for row in facts["fragments"]]
            if tell is not None:
                tell(f"level {cube.level}", len(done), len(cubes))
        return {cube: done[cube] for cube in cubes}

    def _given(self, cube: Cube, below: _Below, kept: KeptFolder) -> tuple[None, Cube, list[bytes]]:
        """The arguments of a cube: of the parts below it those of labels that go on."""
        parts: list[bytes] = []
        for child in self.cubes.children(cube):
            if child in below.cubes:
                facts, arrays = unpacked(kept.whole(child.kept, self.cubes.named(child)))
                rows = [(row, part) for row, part in zip(facts["parts"], arrays, strict=True) if row[0] in below.left]
                parts.append(packed({"parts": [row for row, _ in rows]}, [part for _, part in rows]))
        return None, cube, parts

    def _again(self, kept: KeptFolder) -> frozenset[Cube]:
        """The cubes whose results are there and of no use: a cube above them is to be done, and their parts are gone."""
        again: set[Cube] = set()
        top = self.cubes.root()
        while _fragments_kept(kept, top.parent) is not None:
            top = top.parent
        # What is above is not known yet.
        open_above = {top.parent}
        for level in range(top.level, -1, -1):
            open_here = set()
            for cube in self.cubes.of_level(level):
                is_done = _fragments_kept(kept, cube) is not None
                if is_done and cube.parent in open_above and kept.read(cube.kept) is None:
                    again.add(cube)
                if not is_done or cube in again:
                    open_here.add(cube)
            open_above = open_here
        return frozenset(again)

    def _unfinished(self, level: Mapping[Cube, Sequence[Fragment]]) -> frozenset[int]:
        """The labels that go on: in several cubes, or of many triangles."""
        seen: set[int] = set()
        left: set[int] = set()
        for fragments in level.values():
            for one in fragments:
                is_large = one.n_faces > ENOUGH and one.length < self.surface.extent()
                if is_large or one.label in seen:
                    left.add(one.label)
                seen.add(one.label)
        return frozenset(left)

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
        """How far the transform in the file is from that of the volume."""
        return _TRANSFORM_ROUNDING * self.surface.farthest()

    def step(self, cube: Cube) -> float:
        """The sum of half a step along each axis: how far rounding in a fragment moves a point, about."""
        sides = self.cubes.sides_of(cube)
        lengths = (math.hypot(*(row[k] for row in self.surface.affine)) * sides[k] for k in range(3))
        return 0.5 * sum(lengths) / ((1 << _BITS) - 1)


def _draco() -> Any:
    try:
        return library("DracoPy")
    except ImportError as error:
        message = "Neuroglancer's meshes of several levels are compressed by Draco: install the package DracoPy"
        raise ImportError(f"{message}, as by pip install DracoPy, here and where workers are", name="DracoPy") from error


def _fragments_kept(kept: KeptFolder, cube: Cube) -> list[Fragment] | None:
    """What is known of the fragments of a cube that is done."""
    content = kept.read(fragments_of(cube))
    return None if content is None else [Fragment(*row) for row in unpacked(content)[0]["fragments"]]


def _made(tree: LabelTree, array: Any, cube: Cube, below: Sequence[bytes]) -> bytes:
    """What a worker makes of a block, or of the parts in a cube of them: the part of each label, and its fragment."""
    labels: list[tuple[int, BoundState, float]] = []
    parts: list[bytes] = []
    fragments: list[Fragment] = []
    contents: list[bytes] = []
    for grown, made in _leaves(tree, array, cube) if cube.level == 0 else _joined(tree, cube, below):
        content, bound = grown.part.state()
        labels.append((grown.label, bound, grown.length))
        parts.append(content)
        fragments.append(Fragment(grown.label, grown.length, grown.part.n_faces, *made.facts, len(made.content)))
        contents.append(made.content)
    return packed({"parts": labels, "fragments": fragments}, [*parts, *contents])


def _leaves(tree: LabelTree, array: Any, cube: Cube) -> Iterator[tuple[_Grown, _Compressed]]:
    """The labels of a block, within the length where that can be."""
    block = tree.cubes.block(cube)
    arguments = tree.surface.arguments(block, block.low)
    samples, names = labelled(array, block)
    for rank, part in _chordal.label_parts(samples, arguments, tree.surface.place(block)):
        label = label_named(rank, names)
        if tree.only is not None and label not in tree.only:
            continue
        first = FIRST * tree.surface.cell()
        if tree.tolerance is None:
            yield _Grown(label, part, max(part.at_most, first)), _compressed(_fragment(tree, cube, part))
            continue
        room = tree.tolerance - part.at_most - tree.step(cube) - tree.rounding()
        for halving in range(_HALVINGS + 1 if room > 0.0 else 0):
            chosen = part.simplified(room * 0.5**halving)
            fragment = _fragment(tree, cube, chosen)
            if fragment.at_most <= tree.tolerance:
                break
        else:
            chosen, fragment = part, _fragment(tree, cube, part)
        yield _Grown(label, chosen, max(tree.tolerance, first)), _compressed(fragment)


def _joined(tree: LabelTree, cube: Cube, below: Sequence[bytes]) -> Iterator[tuple[_Grown, _Compressed]]:
    """The parts of each label as one, with fewer triangles where that is worth it."""
    place = tree.surface.place(tree.cubes.block(cube))
    by_label: dict[int, list[_Grown]] = {}
    for child in below:
        facts, arrays = unpacked(child)
        for (label, (least, most, at), length), content in zip(facts["parts"], arrays, strict=True):
            part = _chordal.BlockPart.of_state(content, (least, most, at))
            by_label.setdefault(label, []).append(_Grown(label, part, length))
    for label in sorted(by_label):
        parts = by_label.pop(label)
        for _ in range(MOST_TRIES):
            if sum(one.part.n_faces for one in parts) <= 2 * MOST:
                break
            parts = [_coarser(one) for one in parts]
        joined = _chordal.join_parts([one.part for one in parts], place)
        grown = _coarser(_Grown(label, joined, max(one.length for one in parts)))
        yield grown, _compressed(_fragment(tree, cube, grown.part))


def _coarser(grown: _Grown) -> _Grown:
    """Fewer triangles, where these are fewer by enough; next time within twice the length."""
    fewer = grown.part.simplified(grown.length)
    is_worth_it = fewer.n_faces <= WORTH_IT * grown.part.n_faces
    return _Grown(grown.label, fewer if is_worth_it else grown.part, 2.0 * grown.length)


def _fragment(tree: LabelTree, cube: Cube, part: _chordal.BlockPart) -> _Rounded:
    """A part as a fragment has it."""
    vertices, faces, octants, moved = part.lattice_fragment(tree.surface.place(tree.cubes.block(cube)), tree.within(cube))
    at_most: float = part.at_most
    for more in (moved, tree.rounding()):
        at_most = math.nextafter(at_most + more, math.inf)
    return _Rounded(vertices, faces, octants, at_most)


def _compressed(fragment: _Rounded) -> _Compressed:
    import numpy as np

    # Whole numbers of 32 bits with a sign: Neuroglancer takes no others, and Draco keeps them as they are.
    numbers = np.frombuffer(fragment.vertices, np.int32).reshape(-1, 3)
    corners = np.frombuffer(fragment.faces, np.uint32).reshape(-1, 3)
    content = bytes(_draco().encode(numbers, corners, compression_level=_DRACO_LEVEL))
    return _Compressed(content, (len(corners), fragment.at_most, fragment.octants))
