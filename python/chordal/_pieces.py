"""Meshes in pieces, and pieces as one mesh."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from chordal import _chordal
from chordal._arguments import warn
from chordal._bound import Bound
from chordal._corners import firsts_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from chordal._mesh import Mesh
    from chordal._shape import Shape


class Splittable:
    """A mesh that may have several pieces."""

    __slots__ = ()

    def split(self) -> list[Mesh]:
        """Its pieces that no edge and no vertex joins, each a mesh with its attributes, materials and unit, in the order of
        their first faces. Pieces are triangles that are given: the bound of the whole is not theirs.

        >>> import chordal
        >>> corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (5, 0, 0), (6, 0, 0), (5, 1, 0)]
        >>> [piece.bounds[0].tolist() for piece in chordal.Mesh(corners, [(0, 1, 2), (3, 4, 5)]).split()]
        [[0.0, 0.0, 0.0], [5.0, 0.0, 0.0]]
        """
        state = _State(self)
        return [state.piece(node, faces) for node in state.shown for faces in state.groups(state.nodes[node]["part"])]

    def __add__(self, other: Shape | Any) -> Mesh:
        """The triangles of both, next to each other: `concatenate`. For one closed mesh of both use `|`."""
        from chordal._interop import mesh_of
        from chordal._mesh import Mesh

        assert isinstance(self, Mesh)
        found = other if isinstance(other, Mesh) else mesh_of(other)
        if found is None:
            return NotImplemented
        return concatenate([self, found])


def concatenate(meshes: Iterable[Shape | Any] | Shape, /, *more: Shape | Any) -> Mesh:
    """The triangles of meshes, files or meshes of other libraries, next to each other as one part, of a list or one after
    the other. Nothing is cut or joined:
    `union` makes one closed mesh of solids.

    Normals, texture coordinates and colours stay where every mesh has them for its vertices; materials stay behind, which a
    `UserWarning` tells: `scene` keeps them. The bound is the largest of all. Raises `ValueError` where units differ, or where
    there is no mesh.

    >>> import chordal
    >>> one = chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    >>> both = chordal.concatenate([one, one.translate(0, 0, 1)])
    >>> both.faces.tolist(), len(both.split())
    ([[0, 1, 2], [3, 4, 5]], 2)
    """
    import numpy as np

    from chordal._mesh import Mesh
    from chordal._shape import Shape
    from chordal._verbs import shaped

    several = [meshes, *more] if more or isinstance(meshes, Shape) else meshes
    given = [shaped("meshes", one) for one in several]
    found = [one for one in given if isinstance(one, Mesh)]
    if len(found) < len(given):
        other = next(one for one in given if not isinstance(one, Mesh))
        raise TypeError(f"meshes: triangles, not {other._source.kinds}: mesh them first")
    if not found:
        raise ValueError("meshes: there is none")
    units = {one._metres() for one in found}
    if len(units) > 1:
        names = ", ".join(sorted(str(one.unit) for one in found))
        raise ValueError(f"meshes: they are in different units ({names}); to_unit makes them one")
    counts = [len(one.vertices) for one in found]
    starts = np.cumsum([0, *counts[:-1]])
    faces = np.concatenate([one.faces.astype(np.uint32) + np.uint32(start) for one, start in zip(found, starts, strict=True)])
    states = [_State(one) for one in found]
    ties = np.concatenate([state.ties() + start for state, start in zip(states, starts, strict=True)]).astype(np.uint32)
    _warn_of_materials(found)
    blocks = [np.concatenate([one.vertices for one in found]).tobytes(), faces.tobytes(), ties.tobytes()]
    attributes = []
    for kind, of in (("normal", None), ("uv", 0), ("color", 0)):
        rows = [one._vertex_rows(kind) for one in found]  # type: ignore[arg-type]
        if all(row is not None for row in rows) and len({row.shape[1] for row in rows}) == 1:
            width = rows[0].shape[1]
            attributes.append({"kind": kind, "of": of, "domain": "vertex", "width": width, "block": len(blocks)})
            blocks.append(np.concatenate(rows).tobytes())
    part = {"name": "triangles", "positions": 0, "faces": 1, "position_id": 2, "attributes": attributes}
    has_uv = any(attribute["kind"] == "uv" for attribute in attributes)
    frame = {"texture_origin": "lower-left" if has_uv else None, "metres_per_unit": units.pop()}
    state = json.dumps({"parts": [part], "frame": frame})
    source = _chordal.scene_of_parts(_chordal.scene_of_state(state, blocks, None), [one._source for one in found], None)
    # What stands below nodes is rounded where they put it.
    offs = [_chordal.composed_bound(one._source, []) for one in found]
    made = Mesh._of_source(source, _largest([_moved_by(one.bound, off) for one, off in zip(found, offs, strict=True)]))
    made._is_given = made._bound is None
    return made


def _warn_of_materials(meshes: list[Mesh]) -> None:
    if any(one.materials for one in meshes):
        warn("materials: these stay behind, for all becomes one part; chordal.scene(a, b) keeps them")


def _moved_by(bound: Bound, off: float) -> Bound:
    """The bound of what was moved by no more than a length."""
    if off == 0 or bound.at_most is None:
        return bound
    return replace(bound, at_least=0.0, at_most=math.nextafter(bound.at_most + off, math.inf))


def _largest(bounds: list[Bound]) -> Bound | None:
    """The bound of all together: none of their points is farther than it would be alone. Nothing where all are the truth."""
    if all(bound.at_most == 0 and bound.evidence == "proved" for bound in bounds):
        return None
    kinds = ("proved", "proved-if", "measured", "estimated")
    metric = _weakest([bound.metric for bound in bounds])
    if metric == "solid" and any(bound.metric != "solid" and bound.at_most != 0 for bound in bounds):
        # How far a surface is says nothing of sides.
        bounds = [*bounds, Bound(0.0, None, "estimated", "solid", bounds[0].reference)]
    tops = [bound.at_most for bound in bounds if bound.at_most is not None]
    references = list(dict.fromkeys(bound.reference for bound in bounds))
    samples = [bound.samples for bound in bounds if bound.samples is not None]
    evidence = max((bound.evidence for bound in bounds), key=kinds.index)
    return Bound(
        at_least=0.0,
        at_most=max(tops) if len(tops) == len(bounds) else None,
        evidence=evidence,
        metric=metric,
        reference=" and ".join(references),
        assumptions=tuple(dict.fromkeys(line for bound in bounds for line in bound.assumptions)) if evidence == "proved-if" else (),
        samples=min(samples) if samples and evidence == "measured" else None,
    )


def _weakest(metrics: list[str]) -> str:
    """The metric in which all that is known holds."""
    found = set(metrics)
    return metrics[0] if len(found) == 1 else next((one for one in ("solid", "one-sided") if one in found), "hausdorff")


class _State:
    """A scene as a text and blocks of numbers, as it is pickled."""

    def __init__(self, mesh: Any) -> None:
        text, self.blocks = _chordal.scene_state(mesh._source)
        self.facts: dict[str, Any] = json.loads(text)
        self.nodes: list[dict[str, Any]] = self.facts["nodes"]
        self.shown = self._shown()

    def _shown(self) -> list[int]:
        """The nodes that show a part, in the order of the tree."""
        found, waiting = [], list(reversed(self.facts["roots"]))
        while waiting:
            node = waiting.pop()
            if self.nodes[node]["part"] is not None:
                found.append(node)
            waiting += reversed(self.nodes[node]["children"])
        return found

    def numbers(self, block: int, kind: str, width: int) -> NDArray[Any]:
        import numpy as np

        return np.frombuffer(self.blocks[block], kind).reshape(-1, width)

    def ties_of(self, part: int) -> NDArray[np.int64]:
        """For each vertex of a part the first one that is the same position."""
        import numpy as np

        facts = self.facts["parts"][part]
        positions = self.numbers(facts["positions"], "f8", 3)
        if facts["position_id"] is not None:
            ids = self.numbers(facts["position_id"], "u4", 1).ravel()
            _, first, inverse = np.unique(ids, return_index=True, return_inverse=True)
            found: NDArray[np.int64] = first[inverse.ravel()]
            return found
        return np.arange(len(positions)) if facts["indexed"] else firsts_of(positions)

    def ties(self) -> NDArray[np.int64]:
        """The same for all that is shown."""
        import numpy as np

        found: list[NDArray[np.int64]] = [np.zeros(0, np.int64)]
        start = 0
        for node in self.shown:
            ties = self.ties_of(self.nodes[node]["part"])
            found.append(ties + start)
            start += len(ties)
        return np.concatenate(found)

    def groups(self, part: int) -> list[NDArray[np.int64]]:
        """The faces of each piece of a part, in the order of their first faces."""
        import numpy as np

        faces = self.numbers(self.facts["parts"][part]["faces"], "u4", 3)
        ties = self.ties_of(part)
        corners = ties[faces]
        lowest = np.arange(len(ties))
        # The lowest vertex that is known to hang together with each: over a face, then over what was found so far.
        while True:
            seen = lowest[corners]
            least = seen.min(axis=1)
            if np.array_equal(seen, np.broadcast_to(least[:, None], seen.shape)):
                break
            for corner in range(3):
                np.minimum.at(lowest, seen[:, corner], least)
            while not np.array_equal(lowest, lowest[lowest]):
                lowest = lowest[lowest]
        _, first, numbers = np.unique(least, return_index=True, return_inverse=True)
        order = np.argsort(numbers.ravel(), kind="stable")
        if len(first) == 0:
            return []
        pieces = np.split(order, np.cumsum(np.bincount(numbers.ravel()))[:-1])
        return sorted(pieces, key=lambda piece: int(piece[0]))

    def piece(self, node: int, chosen: NDArray[np.int64]) -> Mesh:
        """Some faces of what a node shows, with everything else of the scene."""
        import numpy as np

        from chordal._mesh import Mesh

        facts = json.loads(json.dumps(self.facts))
        blocks = list(self.blocks)
        part = facts["parts"][self.nodes[node]["part"]]

        def put(rows: NDArray[Any]) -> int:
            blocks.append(np.ascontiguousarray(rows).tobytes())
            return len(blocks) - 1

        faces = self.numbers(part["faces"], "u4", 3)[chosen]
        kept, numbers = np.unique(faces, return_inverse=True)
        ties = self.ties_of(self.nodes[node]["part"])[kept]
        for attribute in part["attributes"]:
            rows = self.numbers(attribute["block"], "f8", attribute["width"])
            if attribute["domain"] == "vertex":
                rows = rows[kept]
            elif attribute["domain"] == "face":
                rows = rows[chosen]
            else:
                rows = rows.reshape(-1, 3, attribute["width"])[chosen]
            attribute["block"] = put(rows)
        if part["position_id"] is not None:
            _, first, inverse = np.unique(ties, return_index=True, return_inverse=True)
            part["position_id"] = put(first[inverse.ravel()].astype(np.uint32))
        part["positions"] = put(self.numbers(part["positions"], "f8", 3)[kept])
        part["faces"] = put(numbers.reshape(-1, 3).astype(np.uint32))
        part["marks"] = []
        for number, one in enumerate(facts["nodes"]):
            one["part"] = 0 if number == node else None
        facts |= {"parts": [part], "certificate": None, "composed": None, "sha256": None, "n_bytes": None}
        return Mesh._of_source(_chordal.scene_of_state(json.dumps(facts), blocks, None))
