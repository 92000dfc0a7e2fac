"""`BlockTree`: blocks simplified, joined by eights and simplified again, each result a tile; `Tileset`: what was written."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

from chordal import _chordal
from chordal._blockwise.cubes import ENOUGH, FIRST, MOST, MOST_TRIES, WORTH_IT, Cube, Cubes
from chordal._blockwise.folder import KeptFolder, left_over, refuse_finished, written
from chordal._blockwise.packing import TileEntry, packed, unpacked
from chordal._blockwise.sampled import crossed
from chordal._blockwise.tasks import ROUNDING, Surface, part_of_block
from chordal._bound import Bound, bound_of
from chordal._errors import BudgetUnmet, Refused

if TYPE_CHECKING:
    from chordal._blockwise.workers import Task, Workers

#: Where the results of tasks are while a tileset is made.
_PARTS = "parts"


@dataclass(frozen=True)
class Tileset:
    """3D Tiles that were written: the surface of a volume that was never in one place.

    `BlockVolume.tileset` makes it.
    """

    #: The path of its document, `tileset.json`.
    path: str
    #: How far the finest tiles are from the true surface.
    bound: Bound
    #: The number of tiles.
    tiles: int
    #: The triangles of the finest tiles.
    triangles: int
    #: The triangles of the coarsest ones.
    coarsest: int


@dataclass
class _Grown:
    """A part with the tiles that were made of it: `tops` show it now, `entries` has those and all below them."""

    part: _chordal.BlockPart
    #: The length by which it is simplified next.
    length: float
    tops: list[str] = field(default_factory=list)
    entries: list[TileEntry] = field(default_factory=list)
    files: list[tuple[str, bytes]] = field(default_factory=list)

    def put(self, part: _chordal.BlockPart, name: str, metres: float | None) -> None:
        """A tile in place of those that show the part now."""
        content, (_, box, bound, triangles, _) = part.tile(name, metres)
        self.entries.append((name, box, bound, triangles, self.tops))
        self.files.append((name, content))
        self.part, self.tops = part, [name]

    def coarser(self, name: str, metres: float | None) -> None:
        """Fewer triangles, where these are worth a tile."""
        fewer = self.part.simplified(self.length).rounded((0.0, 0.0, 0.0))
        if fewer.n_faces <= WORTH_IT * self.part.n_faces:
            self.put(fewer, name, metres)
        self.length *= 2.0

    def packed(self) -> bytes:
        content, bound = self.part.state()
        names = [name for name, _ in self.files]
        facts = {"bound": bound, "length": self.length, "tops": self.tops, "entries": self.entries, "files": names}
        return packed(facts, [content, *(made for _, made in self.files)])

    @staticmethod
    def of(content: bytes) -> _Grown | None:
        facts, arrays = unpacked(content)
        if facts["bound"] is None:
            return None
        least, most, at = facts["bound"]
        part = _chordal.BlockPart.of_state(arrays[0], (least, most, at))
        entries = [(name, box, tuple(bound), n, children) for name, box, bound, n, children in facts["entries"]]
        files = list(zip(facts["files"], arrays[1:], strict=True))
        return _Grown(part, facts["length"], facts["tops"], entries, files)


@dataclass(frozen=True)
class BlockTree:
    """The cubes of a volume, and what is made of each: all that a worker needs, but for samples and parts."""

    surface: Surface
    cubes: Cubes
    #: The length within which the finest tiles are to be; None for all triangles.
    tolerance: float | None
    metres: float | None

    def build(
        self,
        folder: str | os.PathLike[str],
        plan: Mapping[str, Any],
        array: Any,
        workers: Workers,
        tell: Callable[[str, int, int], object] | None,
    ) -> Tileset:
        """All tiles and their document, in a folder."""
        target = os.fspath(folder)
        document = os.path.join(target, "tileset.json")
        root = self.cubes.root()
        total = self.cubes.n_below(root)
        refuse_finished(document, "a tileset")
        with KeptFolder(os.path.join(target, _PARTS), plan, is_alone=True) as kept:
            # Another program may have finished meanwhile.
            refuse_finished(document, "a tileset")
            leaves, left = self._open(root, array, kept)
            n_done = total - len(leaves) - len(left)
            shared = workers.shared(array)
            ready: list[Task[Cube]] = [(leaf, self.cubes.named(leaf), (shared, leaf, [])) for leaf in reversed(leaves)]
            ready += [self._task(cube, array, kept) for cube, n in left.items() if n == 0]
            for cube, made in workers.run(ready, partial(_made, self)):
                self._keep(cube, made, target, kept)
                n_done += 1
                if tell is not None:
                    tell("tiles", n_done, total)
                if cube != root:
                    left[cube.parent] -= 1
                    if left[cube.parent] == 0:
                        ready.append(self._task(cube.parent, array, kept))
            return self._finish(kept, root, document)

    def _finish(self, kept: KeptFolder, root: Cube, document: str) -> Tileset:
        """The document over all tiles."""
        grown = _Grown.of(kept.whole(root.kept, root.name))
        if grown is None:
            kept.remove()
            raise Refused("empty", "no block has a surface")
        number = {entry[0]: at for at, entry in enumerate(grown.entries)}
        entries = [(name, box, bound, n, [number[child] for child in below]) for name, box, bound, n, below in grown.entries]
        made = _chordal.tileset(entries, self.origin(), self.metres)
        for path in left_over(os.path.dirname(document)):
            os.unlink(path)
        written(document, made)
        kept.remove()
        bound = bound_of(json.loads(made)["extras"]["chordal"]["bound"])
        finest = sum(n for _, _, _, n, below in entries if not below)
        coarsest = sum(n for name, _, _, n, _ in entries if name in grown.tops)
        tileset = Tileset(document, bound, len(entries), finest, coarsest)
        if self.tolerance is not None and (bound.at_most is None or bound.at_most > self.tolerance):
            reached = math.inf if bound.at_most is None else bound.at_most
            message = f"the finest tiles are proved to be within {reached:.6g}, not within {self.tolerance:.6g}"
            raise BudgetUnmet(message, tileset)
        return tileset

    def _keep(self, cube: Cube, made: bytes, target: str, kept: KeptFolder) -> None:
        """Writes the tiles of a result, then the result without them: of those below it nothing is needed any more."""
        facts, arrays = unpacked(made)
        for name, content in zip(facts.get("files", []), arrays[1:], strict=True):
            path = os.path.join(target, name)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            written(path, content)
        if arrays:
            made = packed({**facts, "files": []}, arrays[:1])
        kept.write(cube.kept, made)
        if cube.level > 0:
            for child in self.cubes.children(cube):
                kept.forget(child.kept)

    def _below(self, cube: Cube, array: Any) -> list[Cube]:
        """The cubes of one that may have triangles."""
        cubes = list(self.cubes.children(cube))
        blocks = [self.cubes.block(one) for one in cubes]
        wanted = set(crossed(array, blocks, self.surface))
        return [one for one, block in zip(cubes, blocks, strict=True) if block in wanted]

    def _task(self, cube: Cube, array: Any, kept: KeptFolder) -> Task[Cube]:
        """That of a cube whose children are done."""
        below = [kept.whole(child.kept, child.name) for child in self._below(cube, array)]
        return cube, self.cubes.named(cube), (None, cube, below)

    def _open(self, root: Cube, array: Any, kept: KeptFolder) -> tuple[list[Cube], dict[Cube, int]]:
        """The blocks that are to be done, those of a cube together; and for each cube above them how many are, below it."""
        leaves: list[Cube] = []
        left: dict[Cube, int] = {}
        stack = [root]
        while stack:
            cube = stack.pop()
            if kept.read(cube.kept) is not None:
                continue
            if cube != root:
                left[cube.parent] += 1
            if cube.level == 0:
                leaves.append(cube)
            else:
                left[cube] = 0
                stack.extend(reversed(self._below(cube, array)))
        return leaves, left

    def origin(self) -> tuple[float, float, float]:
        """The middle of the lattice: coordinates of tiles are relative to it."""
        middle = [(n - 1) / 2 for n in self.surface.shape]
        x, y, z = (math.fsum(a * b for a, b in zip(row, [*middle, 1.0], strict=True)) for row in self.surface.affine)
        return x, y, z


def _made(tree: BlockTree, array: Any, cube: Cube, below: Sequence[bytes]) -> bytes:
    """What a worker makes of a block, or of the parts in a cube of them."""
    grown = _leaf(tree, array, cube) if cube.level == 0 else _joined(tree, cube, below)
    if grown is None:
        return packed({"bound": None}, [])
    if cube == tree.cubes.root():
        step = 0
        while grown.part.n_faces > ENOUGH and grown.length < tree.surface.extent():
            step += 1
            grown.coarser(f"{cube.name}_top{step}.glb", tree.metres)
    return grown.packed()


def _leaf(tree: BlockTree, array: Any, cube: Cube) -> _Grown | None:
    part = part_of_block(tree.surface, array, tree.cubes.block(cube))
    if part is None:
        return None
    part = part.rounded(tree.origin())
    if tree.tolerance is not None:
        room = tree.tolerance - part.at_most - ROUNDING * tree.surface.extent()
        if room > 0.0:
            part = part.simplified(room).rounded((0.0, 0.0, 0.0))
    length = max(part.at_most, FIRST * tree.surface.cell()) if tree.tolerance is None else tree.tolerance
    grown = _Grown(part, length)
    grown.put(part, f"{cube.name}.glb", tree.metres)
    return grown


def _joined(tree: BlockTree, cube: Cube, below: Sequence[bytes]) -> _Grown | None:
    parts = [grown for grown in map(_Grown.of, below) if grown is not None]
    if not parts:
        return None
    for number in range(MOST_TRIES):
        if sum(grown.part.n_faces for grown in parts) <= 2 * MOST:
            break
        for at, grown in enumerate(parts):
            grown.coarser(f"{cube.name}_{at}_{number}.glb", tree.metres)
    block = tree.cubes.block(cube)
    joined = _chordal.join_parts([grown.part for grown in parts], tree.surface.place(block))
    made = _Grown(joined, max(grown.length for grown in parts))
    for grown in parts:
        made.tops += grown.tops
        made.entries += grown.entries
        made.files += grown.files
    made.coarser(f"{cube.name}.glb", tree.metres)
    return made
