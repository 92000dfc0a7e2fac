"""Splitting a mesh into pieces, and concatenating meshes."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from chordal import _chordal
from chordal._arguments import warn
from chordal._bound import Bound
from chordal._corners import firsts_of
from chordal._registry import registered

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from chordal._mesh import Mesh
    from chordal._shape import Shape


class Splittable:
    """A mesh that can be split into pieces."""

    __slots__ = ()

    def split(self) -> list[Mesh]:
        """The connected components, which share no edge and no vertex, each a mesh with its attributes, materials and unit, in
        the order of their first faces. They count as given triangles and do not inherit the bound of the whole mesh.

        >>> import chordal
        >>> corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (5, 0, 0), (6, 0, 0), (5, 1, 0)]
        >>> [piece.bounds[0].tolist() for piece in chordal.Mesh(corners, [(0, 1, 2), (3, 4, 5)]).split()]
        [[0.0, 0.0, 0.0], [5.0, 0.0, 0.0]]
        """
        state = _State(self)
        return [state.piece(node, faces) for node in state.shown for faces in state.groups(state.nodes[node]["part"])]

    def __add__(self, other: Shape | Any) -> Mesh:
        """The triangles of both meshes, unmerged: `concatenate`. For the union as one closed mesh, use `|`."""
        assert isinstance(self, registered.mesh)
        other_mesh = other if isinstance(other, registered.mesh) else registered.mesh_of(other)
        if other_mesh is None:
            return NotImplemented
        return joined([self, other_mesh])


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """The triangles of meshes as one part."""
    import numpy as np

    if not meshes:
        raise ValueError("meshes: there is none")
    units = {mesh._metres() for mesh in meshes}
    if len(units) > 1:
        names = ", ".join(sorted(str(mesh.unit) for mesh in meshes))
        raise ValueError(f"meshes: they are in different units ({names}); to_unit makes them one")
    counts = [len(mesh.vertices) for mesh in meshes]
    starts = np.cumsum([0, *counts[:-1]])
    faces = np.concatenate([mesh.faces.astype(np.uint32) + np.uint32(start) for mesh, start in zip(meshes, starts, strict=True)])
    states = [_State(mesh) for mesh in meshes]
    position_ids = np.concatenate([state.position_ids() + start for state, start in zip(states, starts, strict=True)])
    _warn_of_materials(meshes)
    vertices = np.concatenate([mesh.vertices for mesh in meshes])
    blocks = [vertices.tobytes(), faces.tobytes(), position_ids.astype(np.uint32).tobytes()]
    attributes = []
    for kind, set_index in (("normal", None), ("uv", 0), ("color", 0)):
        rows = [mesh._vertex_rows(kind) for mesh in meshes]  # type: ignore[arg-type]
        if all(row is not None for row in rows) and len({row.shape[1] for row in rows}) == 1:
            width = rows[0].shape[1]
            attributes.append({"kind": kind, "of": set_index, "domain": "vertex", "width": width, "block": len(blocks)})
            blocks.append(np.concatenate(rows).tobytes())
    part = {"name": "triangles", "positions": 0, "faces": 1, "position_id": 2, "attributes": attributes}
    has_uv = any(attribute["kind"] == "uv" for attribute in attributes)
    frame = {"texture_origin": "lower-left" if has_uv else None, "metres_per_unit": units.pop()}
    state = json.dumps({"parts": [part], "frame": frame})
    source = _chordal.scene_of_parts(_chordal.scene_of_state(state, blocks, None), [mesh._source for mesh in meshes], None)
    # The transforms of nodes round the positions of the parts below them.
    roundings = [_chordal.composed_bound(mesh._source, []) for mesh in meshes]
    bound = _largest([_moved_by(mesh.bound, rounding) for mesh, rounding in zip(meshes, roundings, strict=True)])
    result = registered.mesh._of_source(source, bound)
    result._is_given = bound is None
    return result


def _warn_of_materials(meshes: Sequence[Mesh]) -> None:
    if any(mesh.materials for mesh in meshes):
        warn("materials: these stay behind, for all becomes one part; chordal.scene(a, b) keeps them")


def _moved_by(bound: Bound, distance: float) -> Bound:
    """The bound of a shape after its points moved by no more than a distance."""
    if distance == 0 or bound.at_most is None:
        return bound
    # The move may have brought the surfaces together, so no distance is certain. The next larger number, because the sum is
    # rounded to nearest.
    return replace(bound, at_least=0.0, at_most=math.nextafter(bound.at_most + distance, math.inf))


def _largest(bounds: list[Bound]) -> Bound | None:
    """The bound of several meshes together, the largest of theirs. None if all of them count as the true shape."""
    if all(bound.at_most == 0 and bound.evidence == "proved" for bound in bounds):
        return None
    kinds = ("proved", "proved-if", "measured", "estimated")
    metric = _weakest([bound.metric for bound in bounds])
    if metric == "solid" and any(bound.metric != "solid" and bound.at_most != 0 for bound in bounds):
        # A bound on distances between surfaces says nothing about the volumes between them.
        bounds = [*bounds, Bound(0.0, None, "estimated", "solid", bounds[0].reference)]
    tops = [bound.at_most for bound in bounds if bound.at_most is not None]
    references = list(dict.fromkeys(bound.reference for bound in bounds))
    samples = [bound.samples for bound in bounds if bound.samples is not None]
    # Evidence is as good as that of the weakest bound, and `kinds` goes from strong to weak.
    evidence = max((bound.evidence for bound in bounds), key=kinds.index)
    return Bound(
        at_least=0.0,
        # One mesh without an upper end leaves the whole without.
        at_most=max(tops) if len(tops) == len(bounds) else None,
        evidence=evidence,
        metric=metric,
        reference=" and ".join(references),
        assumptions=tuple(dict.fromkeys(line for bound in bounds for line in bound.assumptions)) if evidence == "proved-if" else (),
        samples=min(samples) if samples and evidence == "measured" else None,
    )


def _weakest(metrics: list[str]) -> str:
    """The weakest of some metrics, in which the bounds of all hold."""
    distinct = set(metrics)
    return metrics[0] if len(distinct) == 1 else next((m for m in ("solid", "one-sided") if m in distinct), "hausdorff")


class _State:
    """The state of a scene, as it is pickled: a JSON text, and blocks of numbers."""

    def __init__(self, mesh: Any) -> None:
        text, self.blocks = _chordal.scene_state(mesh._source)
        self.facts: dict[str, Any] = json.loads(text)
        self.nodes: list[dict[str, Any]] = self.facts["nodes"]
        self.shown = self._shown()

    def _shown(self) -> list[int]:
        """The nodes that show a part, in the order of the tree."""
        shown, stack = [], list(reversed(self.facts["roots"]))
        while stack:
            node = stack.pop()
            if self.nodes[node]["part"] is not None:
                shown.append(node)
            # The stack gives back the last one first.
            stack += reversed(self.nodes[node]["children"])
        return shown

    def numbers(self, block: int, kind: str, width: int) -> NDArray[Any]:
        import numpy as np

        return np.frombuffer(self.blocks[block], kind).reshape(-1, width)

    def position_ids_of(self, part: int) -> NDArray[np.int64]:
        """For each vertex of a part, the first vertex with the same position."""
        import numpy as np

        facts = self.facts["parts"][part]
        positions = self.numbers(facts["positions"], "f8", 3)
        if facts["position_id"] is not None:
            ids = self.numbers(facts["position_id"], "u4", 1).ravel()
            _, first, inverse = np.unique(ids, return_index=True, return_inverse=True)
            representatives: NDArray[np.int64] = first[inverse.ravel()]
            return representatives
        return np.arange(len(positions)) if facts["indexed"] else firsts_of(positions)

    def position_ids(self) -> NDArray[np.int64]:
        """The same for the vertices of all visible parts, one after the other."""
        import numpy as np

        ids_of_parts: list[NDArray[np.int64]] = [np.zeros(0, np.int64)]
        start = 0
        for node in self.shown:
            ids = self.position_ids_of(self.nodes[node]["part"])
            ids_of_parts.append(ids + start)
            start += len(ids)
        return np.concatenate(ids_of_parts)

    def groups(self, part: int) -> list[NDArray[np.int64]]:
        """The faces of each piece of a part, in the order of their first faces."""
        import numpy as np

        faces = self.numbers(self.facts["parts"][part]["faces"], "u4", 3)
        ids = self.position_ids_of(part)
        corners = ids[faces]
        # Union-find on arrays: `lowest` maps each vertex to a lower one of the same piece. Each round links the representatives
        # of a face's corners, then shortens all chains to a single step.
        lowest = np.arange(len(ids))
        while True:
            representatives = lowest[corners]
            least = representatives.min(axis=1)
            if np.array_equal(representatives, np.broadcast_to(least[:, None], representatives.shape)):
                break
            for corner in range(3):
                # Not `lowest[…] = least`: if a vertex occurs in several rows, that would keep only the last one.
                np.minimum.at(lowest, representatives[:, corner], least)
            while not np.array_equal(lowest, lowest[lowest]):
                lowest = lowest[lowest]
        _, first, numbers = np.unique(least, return_index=True, return_inverse=True)
        # Stable, so that the faces of a piece stay in order and its first is its lowest.
        order = np.argsort(numbers.ravel(), kind="stable")
        if len(first) == 0:
            return []
        pieces = np.split(order, np.cumsum(np.bincount(numbers.ravel()))[:-1])
        return sorted(pieces, key=lambda piece: int(piece[0]))

    def piece(self, node: int, chosen: NDArray[np.int64]) -> Mesh:
        """The chosen faces of a node's part, with everything else of the scene."""
        import numpy as np

        facts = json.loads(json.dumps(self.facts))
        blocks = list(self.blocks)
        part = facts["parts"][self.nodes[node]["part"]]

        def put(rows: NDArray[Any]) -> int:
            blocks.append(np.ascontiguousarray(rows).tobytes())
            return len(blocks) - 1

        faces = self.numbers(part["faces"], "u4", 3)[chosen]
        kept, numbers = np.unique(faces, return_inverse=True)
        ids = self.position_ids_of(self.nodes[node]["part"])[kept]
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
            # An id is the row of a vertex at the same position, and rows have new numbers: the first kept one stands for all
            # there.
            _, first, inverse = np.unique(ids, return_index=True, return_inverse=True)
            part["position_id"] = put(first[inverse.ravel()].astype(np.uint32))
        part["positions"] = put(self.numbers(part["positions"], "f8", 3)[kept])
        part["faces"] = put(numbers.reshape(-1, 3).astype(np.uint32))
        part["marks"] = []
        for number, node_facts in enumerate(facts["nodes"]):
            node_facts["part"] = 0 if number == node else None
        # These were about the whole scene and its file.
        facts |= {"parts": [part], "certificate": None, "composed": None, "sha256": None, "n_bytes": None}
        return registered.mesh._of_source(_chordal.scene_of_state(json.dumps(facts), blocks, None))
