"""`BlockTree`: simplifies blocks, joins them by eights and simplifies again, with a tile at each step; `Tileset`: the result."""

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

#: The subfolder of results while a tileset is written.
_PARTS = "parts"


@dataclass(frozen=True)
class Tileset:
    """3D Tiles that were written for the surface of a volume.

    `BlockVolume.tileset` returns it.
    """

    #: The path of its document, `tileset.json`.
    path: str
    #: The distance between the finest tiles and the true surface.
    bound: Bound
    #: The number of tiles.
    tiles: int
    #: The triangles of the finest tiles.
    triangles: int
    #: The triangles of the coarsest ones.
    coarsest: int


@dataclass
class _PartTiles:
    """A part with its tiles: `tops` are the tiles that show it at its present detail, `entries` those and all below them."""

    part: _chordal.BlockPart
    #: The tolerance of the next simplification.
    length: float
    tops: list[str] = field(default_factory=list)
    entries: list[TileEntry] = field(default_factory=list)
    files: list[tuple[str, bytes]] = field(default_factory=list)

    def put(self, part: _chordal.BlockPart, name: str, metres: float | None) -> None:
        """Adds a tile that replaces the present tops, which become its children."""
        content, (_, box, bound, triangles, _) = part.tile(name, metres)
        self.entries.append((name, box, bound, triangles, self.tops))
        self.files.append((name, content))
        self.part, self.tops = part, [name]

    def coarser(self, name: str, metres: float | None) -> None:
        """Simplifies the part, and adds a tile if that saves enough triangles."""
        fewer = self.part.simplified(self.length).rounded((0.0, 0.0, 0.0))
        if fewer.n_faces <= WORTH_IT * self.part.n_faces:
            self.put(fewer, name, metres)
        self.length *= 2.0

    def packed(self) -> bytes:
        content, bound = self.part.state()
        names = [name for name, _ in self.files]
        facts = {"bound": bound, "length": self.length, "tops": self.tops, "entries": self.entries, "files": names}
        return packed(facts, [content, *(tile for _, tile in self.files)])

    @staticmethod
    def of(content: bytes) -> _PartTiles | None:
        facts, arrays = unpacked(content)
        if facts["bound"] is None:
            return None
        least, most, at = facts["bound"]
        part = _chordal.BlockPart.of_state(arrays[0], (least, most, at))
        entries = [(name, box, tuple(bound), n, children) for name, box, bound, n, children in facts["entries"]]
        files = list(zip(facts["files"], arrays[1:], strict=True))
        return _PartTiles(part, facts["length"], facts["tops"], entries, files)


@dataclass(frozen=True)
class BlockTree:
    """The cubes of a volume, and the options of their tiles: all that a worker needs except samples and parts."""

    surface: Surface
    cubes: Cubes
    #: The tolerance of the finest tiles; None to keep all triangles.
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
        """Writes all tiles and their document to a folder."""
        target = os.fspath(folder)
        document = os.path.join(target, "tileset.json")
        root = self.cubes.root()
        total = self.cubes.n_below(root)
        refuse_finished(document, "a tileset")
        with KeptFolder(os.path.join(target, _PARTS), plan, is_alone=True) as kept:
            # Another program may have finished meanwhile.
            refuse_finished(document, "a tileset")
            leaves, n_open_children = self._open(root, array, kept)
            n_done = total - len(leaves) - len(n_open_children)
            shared = workers.shared(array)
            ready: list[Task[Cube]] = [(leaf, self.cubes.named(leaf), (shared, leaf, [])) for leaf in reversed(leaves)]
            ready += [self._task(cube, array, kept) for cube, n in n_open_children.items() if n == 0]
            for cube, result in workers.run(ready, partial(_processed, self)):
                self._keep(cube, result, target, kept)
                n_done += 1
                if tell is not None:
                    tell("tiles", n_done, total)
                if cube != root:
                    n_open_children[cube.parent] -= 1
                    # The last of `ready` runs next, so a parent is joined as soon as its children are done.
                    if n_open_children[cube.parent] == 0:
                        ready.append(self._task(cube.parent, array, kept))
            return self._finish(kept, root, document)

    def _finish(self, kept: KeptFolder, root: Cube, document: str) -> Tileset:
        """Writes the document of all tiles."""
        root_tiles = _PartTiles.of(kept.whole(root.kept, root.name))
        if root_tiles is None:
            kept.remove()
            raise Refused("empty", "no block has a surface")
        number = {entry[0]: k for k, entry in enumerate(root_tiles.entries)}
        entries = [(name, box, bound, n, [number[child] for child in below]) for name, box, bound, n, below in root_tiles.entries]
        content = _chordal.tileset(entries, self.origin(), self.metres)
        for path in left_over(os.path.dirname(document)):
            os.unlink(path)
        written(document, content)
        kept.remove()
        bound = bound_of(json.loads(content)["extras"]["chordal"]["bound"])
        finest = sum(n for _, _, _, n, below in entries if not below)
        coarsest = sum(n for name, _, _, n, _ in entries if name in root_tiles.tops)
        tileset = Tileset(document, bound, len(entries), finest, coarsest)
        if self.tolerance is not None and (bound.at_most is None or bound.at_most > self.tolerance):
            reached = math.inf if bound.at_most is None else bound.at_most
            message = f"the finest tiles are proved to be within {reached:.6g}, not within {self.tolerance:.6g}"
            raise BudgetUnmet(message, tileset)
        return tileset

    def _keep(self, cube: Cube, result: bytes, target: str, kept: KeptFolder) -> None:
        """Writes the tiles of a result, then the result without them, and removes the results of its children."""
        facts, arrays = unpacked(result)
        # Tiles first: the result says that they are there.
        for name, content in zip(facts.get("files", []), arrays[1:], strict=True):
            path = os.path.join(target, name)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            written(path, content)
        if arrays:
            result = packed({**facts, "files": []}, arrays[:1])
        kept.write(cube.kept, result)
        if cube.level > 0:
            for child in self.cubes.children(cube):
                kept.forget(child.kept)

    def _below(self, cube: Cube, array: Any) -> list[Cube]:
        """The children of a cube that may have triangles."""
        children = list(self.cubes.children(cube))
        blocks = [self.cubes.block(child) for child in children]
        crossed_blocks = set(crossed(array, blocks, self.surface))
        return [child for child, block in zip(children, blocks, strict=True) if block in crossed_blocks]

    def _task(self, cube: Cube, array: Any, kept: KeptFolder) -> Task[Cube]:
        """The task of a cube whose children are done."""
        below = [kept.whole(child.kept, child.name) for child in self._below(cube, array)]
        return cube, self.cubes.named(cube), (None, cube, below)

    def _open(self, root: Cube, array: Any, kept: KeptFolder) -> tuple[list[Cube], dict[Cube, int]]:
        """The unfinished blocks, with those of a cube next to each other; and for each unfinished cube above them, the number
        of its unfinished children."""
        leaves: list[Cube] = []
        n_open_children: dict[Cube, int] = {}
        stack = [root]
        while stack:
            cube = stack.pop()
            if kept.read(cube.kept) is not None:
                continue
            if cube != root:
                n_open_children[cube.parent] += 1
            if cube.level == 0:
                leaves.append(cube)
            else:
                n_open_children[cube] = 0
                # Reversed, since a stack gives back the last one first.
                stack.extend(reversed(self._below(cube, array)))
        return leaves, n_open_children

    def origin(self) -> tuple[float, float, float]:
        """The middle of the lattice: coordinates of tiles are relative to it."""
        middle = [(n - 1) / 2 for n in self.surface.shape]
        x, y, z = (math.fsum(a * b for a, b in zip(row, [*middle, 1.0], strict=True)) for row in self.surface.affine)
        return x, y, z


def _processed(tree: BlockTree, array: Any, cube: Cube, below: Sequence[bytes]) -> bytes:
    """The result of a worker for a block, or for a cube with the parts of its children."""
    tiles = _leaf(tree, array, cube) if cube.level == 0 else _joined(tree, cube, below)
    if tiles is None:
        return packed({"bound": None}, [])
    if cube == tree.cubes.root():
        step = 0
        while tiles.part.n_faces > ENOUGH and tiles.length < tree.surface.extent():
            step += 1
            tiles.coarser(f"{cube.name}_top{step}.glb", tree.metres)
    return tiles.packed()


def _leaf(tree: BlockTree, array: Any, cube: Cube) -> _PartTiles | None:
    part = part_of_block(tree.surface, array, tree.cubes.block(cube))
    if part is None:
        return None
    part = part.rounded(tree.origin())
    if tree.tolerance is not None:
        # The simplified part is rounded once more, within the tolerance.
        room = tree.tolerance - part.at_most - ROUNDING * tree.surface.extent()
        if room > 0.0:
            part = part.simplified(room).rounded((0.0, 0.0, 0.0))
    length = max(part.at_most, FIRST * tree.surface.cell()) if tree.tolerance is None else tree.tolerance
    tiles = _PartTiles(part, length)
    tiles.put(part, f"{cube.name}.glb", tree.metres)
    return tiles


def _joined(tree: BlockTree, cube: Cube, below: Sequence[bytes]) -> _PartTiles | None:
    children = [child for child in map(_PartTiles.of, below) if child is not None]
    if not children:
        return None
    for number in range(MOST_TRIES):
        if sum(child.part.n_faces for child in children) <= 2 * MOST:
            break
        for k, child in enumerate(children):
            child.coarser(f"{cube.name}_{k}_{number}.glb", tree.metres)
    block = tree.cubes.block(cube)
    joined = _chordal.join_parts([child.part for child in children], tree.surface.place(block))
    tiles = _PartTiles(joined, max(child.length for child in children))
    for child in children:
        tiles.tops += child.tops
        tiles.entries += child.entries
        tiles.files += child.files
    tiles.coarser(f"{cube.name}.glb", tree.metres)
    return tiles
