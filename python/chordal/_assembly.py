"""`scene` and `Placed`: meshes put together as a scene of parts, nodes and materials."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final, Literal, NamedTuple

from chordal import _chordal
from chordal._arguments import text, warn
from chordal._arrays import coordinates
from chordal._assets import Assets
from chordal._bound import Bound
from chordal._hints import hint_keywords_of, keywords_hinted
from chordal._material import Material
from chordal._pieces import _largest, _State
from chordal._scene import numbers_in
from chordal._transform import _volume_of
from chordal._units import METRES, refuse_unknown, unit_of

if TYPE_CHECKING:
    from typing import TypeAlias

    from numpy.typing import ArrayLike

    from chordal._mesh import Mesh
    from chordal._shape import Shape

    #: What a scene is made of: meshes, files, meshes of other libraries, and lists of them, by their names if you like.
    _Thing: TypeAlias = "Shape | Placed | Mapping[str, Any] | Sequence[Any] | Any"

_IDENTITY = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]


@dataclass(frozen=True, eq=False)
class Placed:
    """A mesh in a scene that is made by `scene`: its name, its material, and where it stands.

    >>> import chordal
    >>> wheel = chordal.shapes.cylinder(0.5, 0.2).mesh(tol=0.05)
    >>> axle = chordal.scene(chordal.Placed(wheel, [(0, 0, -1), (0, 0, 1)], name="wheel"))
    >>> len(axle.parts), [node.name for node in axle.nodes], len(axle.faces) == 2 * len(wheel.faces)
    (1, ['wheel', 'wheel'], True)
    """

    #: A mesh, or a file or a mesh of another library that is one; a scene of several parts; or a list of such things, or a
    #: dictionary of them by their names, which stand together.
    what: _Thing
    #: Where: a vector, by which it is moved, or a matrix, 4 × 4 or its first three rows; or several, n × 3, n × 4 × 4 or
    #: n × 3 × 4, for as many places of one part. None is where it is.
    at: ArrayLike | None = None
    #: The name of its node.
    name: str = ""
    #: What all of it looks like: a `Material`, or a dictionary as glTF describes one, without textures. None leaves it the
    #: materials that it has.
    material: Material | Mapping[str, Any] | None = None


hint_keywords_of(Placed)


@keywords_hinted
def scene(
    *things: _Thing,
    unit: Literal["um", "mm", "cm", "m", "km", "in", "ft"] | None = None,
    up: Literal["y", "z"] | None = None,
) -> Mesh:
    """A scene of meshes: a `Mesh` with `parts`, `nodes` and `materials`, which `export` writes as glTF, for one.

    The things are meshes, files, meshes of other libraries, lists of them, or a dictionary by their names; `Placed` says more of
    one. A mesh that is in it several times is one part, which several nodes show. Meshes that are scenes keep their parts,
    nodes and materials; what moves in them, cameras, lights and looks by variant stay behind, with a warning.

    `unit` and `up` are those of meshes that say none. The bound is the largest of all, stretched by the matrices over it, and
    holds their rounding.

    Raises `ValueError` where units or axes differ, a texture has no coordinates, or a matrix is not affine or flattens.

    >>> import chordal
    >>> from chordal.shapes import box, sphere
    >>> steel = chordal.Material("steel", color="#889", metallic=1, roughness=0.3)
    >>> ball = chordal.Placed(sphere(0.2).mesh(tol=0.01), [(-1, 0, 0.3), (1, 0, 0.3)], material=steel)
    >>> table = chordal.scene({"ball": ball, "top": box(3, 1, 0.2).mesh(tol=0.01)}, unit="m", up="z")
    >>> [part.name for part in table.parts], [node.part for node in table.nodes], table.materials[0]["name"]
    (['ball', 'top'], [0, 0, 1], 'steel')
    >>> table.bound.is_within(0.01 + 1e-12)
    True
    """
    if unit is not None:
        refuse_unknown(unit)
    if text("up", up) not in (None, "y", "z"):
        raise ValueError(f"up: y or z, not {up!r}")
    made = _Assembly()
    roots = made.nodes_of(things, "", None)
    if not roots:
        raise ValueError("things: there is none")
    if not made.has_parts:
        raise ValueError("things: there is no mesh in them")
    return made.mesh(roots, None if unit is None else float(METRES[unit]), up)


class _Assembly:
    """A scene on its way, as a text and blocks of numbers."""

    def __init__(self) -> None:
        self.assets: Final = Assets()
        self._blocks: list[bytes] = []
        self._parts: list[dict[str, Any]] = []
        self._nodes: list[dict[str, Any]] = []
        self._groups: dict[str, list[str]] = {}
        #: By things: the meshes that they are. By meshes and materials: their nodes, and the numbers that their parts have here.
        self._meshes: dict[int, tuple[Any, Mesh]] = {}
        self._taken: dict[tuple[int, int], _Taken] = {}
        #: By nodes how far all below them is from the truth.
        self._bounds: dict[int, Bound] = {}
        self._sources: dict[int, _chordal.Source] = {}
        self._lost: set[str] = set()

    @property
    def has_parts(self) -> bool:
        """Whether there is anything to show."""
        return bool(self._taken)

    def nodes_of(self, thing: Any, name: str, material: Any) -> list[int]:
        """The new nodes that show a thing, next to each other."""
        if isinstance(thing, Placed):
            return self._placed(thing, thing.name or name, material if thing.material is None else thing.material)
        if isinstance(thing, Mapping):
            return [node for title, one in thing.items() for node in self._titled(one, str(title), material)]
        if isinstance(thing, (list, tuple)):
            return [node for one in thing for node in self.nodes_of(one, name, material)]
        return [self._shown(self._mesh_of(thing), name, material)]

    def _titled(self, thing: Any, name: str, material: Any) -> list[int]:
        """What stands in a dictionary by a name: a node for each of its places, or one of all in it."""
        is_group = isinstance(thing, (Mapping, list, tuple))
        return [self._node(name, self.nodes_of(thing, "", material))] if is_group else self.nodes_of(thing, name, material)

    def _placed(self, placed: Placed, name: str, material: Any) -> list[int]:
        is_group = isinstance(placed.what, (Mapping, list, tuple, Placed))
        found = []
        for matrix in _matrices(placed.at):
            below = self.nodes_of(placed.what, "" if is_group else name, material)
            # What has a matrix of its own stands below another node.
            is_free = not is_group and self._nodes[below[0]]["matrix"] == _IDENTITY
            node = below[0] if is_free else self._node(name, below)
            self._nodes[node]["matrix"] = matrix
            found.append(node)
        return found

    def _node(self, name: str, children: list[int], part: int | None = None) -> int:
        self._nodes.append({"name": name, "matrix": _IDENTITY, "children": children, "part": part, "properties": {}})
        return len(self._nodes) - 1

    def _mesh_of(self, thing: Any) -> Mesh:
        from chordal._mesh import Mesh
        from chordal._verbs import shaped

        if id(thing) not in self._meshes:
            found = shaped("things", thing)
            if not isinstance(found, Mesh):
                raise TypeError(f"things: triangles, not {found._source.kinds}: mesh them first")
            self._meshes[id(thing)] = thing, found
        return self._meshes[id(thing)][1]

    def _shown(self, mesh: Mesh, name: str, material: Any) -> int:
        """A new node with all that a mesh shows in it, or below it."""
        key = id(mesh), id(material)
        if key not in self._taken:
            self._taken[key] = self._take(mesh, name, material)
        taken, own = self._taken[key], self._taken[key].nodes
        if len(own) == 1 and own[0]["part"] is not None and own[0]["matrix"] == _IDENTITY and not own[0]["properties"]:
            node = self._node(name or own[0]["name"], [], taken.parts[own[0]["part"]])
        else:
            first = len(self._nodes)
            for one in own:
                part = None if one["part"] is None else taken.parts[one["part"]]
                self._nodes.append({**one, "children": [first + child for child in one["children"]], "part": part})
            node = self._node(name, [first + root for root in taken.roots])
        self._bounds[node] = mesh.bound
        self._sources[node] = mesh._source
        return node

    def _take(self, mesh: Mesh, name: str, material: Any) -> _Taken:
        """The parts of a mesh after those that are there, with their numbers, and its nodes with those of its own."""
        state = _State(mesh)
        facts, blocks = state.facts, state.blocks
        names = facts["groups"].pop("material", [""])
        self._note_what_is_lost(facts)
        given = None if material is None else self.assets.number_of(material)
        # The first name of each kind is that of no group.
        offsets = {kind: len(self._groups.get(kind, [""])) - 1 for kind in facts["groups"]}
        offsets["material"] = self.assets.add(facts["assets"], blocks, names) if given is None else 0
        for kind, own in facts["groups"].items():
            self._groups.setdefault(kind, [""]).extend(own[1:])
        parts = []
        for part in facts["parts"]:
            if given is not None:
                self._paint(part, given, blocks)
            for one in part["attributes"]:
                if one["kind"] == "group" and offsets.get(one["of"]):
                    _shift(one, offsets[one["of"]], blocks)
            for mark in part["marks"]:
                if mark["material"] is not None:
                    mark["material"] = mark["material"] + offsets["material"] if given is None else given
            for holder, place in numbers_in(part):
                self._blocks.append(blocks[holder[place]])
                holder[place] = len(self._blocks) - 1
            if name and len(facts["parts"]) == 1:
                part["name"] = name
            parts.append(len(self._parts))
            self._parts.append({**part, "origin": facts["frame"]["texture_origin"]})
        return _Taken(mesh, material, facts["frame"], facts["nodes"], facts["roots"], parts)

    def _note_what_is_lost(self, facts: dict[str, Any]) -> None:
        assets = facts["assets"]
        self._lost |= {title for title in ("cameras", "animations", "skins") if assets[title]}
        self._lost |= {"looks by variant" for kind in assets["face_kinds"] if kind[2]}
        self._lost |= {f"{name} of the file" for name in assets["extensions"]}
        for node in facts["nodes"]:
            said = node["properties"]
            self._lost |= {f"{name} of nodes" for name in said.get("extensions", {})}
            node["properties"] = {key: value for key, value in said.items() if key not in ("camera", "skin", "extensions")}

    def _paint(self, part: dict[str, Any], material: int, blocks: list[bytes]) -> None:
        """Gives all faces of a part one material."""
        import numpy as np

        if self.assets.has_textures(material) and all(one["kind"] != "uv" for one in part["attributes"]):
            raise ValueError(
                "material: it has a texture, and the mesh no texture coordinates to put it on, as Mesh(…, uv=) takes"
            )
        # Three indices of four bytes.
        n_faces = len(blocks[part["faces"]]) // 12
        own = {"kind": "group", "of": "material", "domain": "face", "width": 1, "block": len(blocks)}
        blocks.append(np.full(n_faces, material + 1.0).tobytes())
        part["attributes"] = [one for one in part["attributes"] if (one["kind"], one["of"]) != ("group", "material")] + [own]

    def mesh(self, roots: list[int], metres: float | None, up: str | None) -> Mesh:
        """The scene, as it is now."""
        from chordal._mesh import Mesh

        frames = [taken.frame for taken in self._taken.values()]
        origin = self._one_origin()
        frame = {"texture_origin": origin, "metres_per_unit": _one_unit(frames, metres), "up": _one_up(frames, up)}
        names = ["", *(str(material.get("name", "")) for material in self.assets.materials)]
        groups = self._groups | ({"material": names} if self.assets.materials else {})
        state = {"parts": self._parts, "nodes": self._nodes, "roots": roots, "frame": frame, "groups": groups}
        state["assets"] = self.assets.facts(self._blocks)
        source = _chordal.scene_of_state(json.dumps(state), self._blocks, None)
        if self._lost:
            warn(f"{', '.join(sorted(self._lost))}: these stay behind, for a scene is of what stands still")
        bound = _largest(list(self._bounds.values()))
        known = [(node, one.at_most) for node, one in self._bounds.items() if one.at_most is not None]
        most = _chordal.composed_bound(source, known)
        if bound is not None:
            bound = replace(bound, at_most=None if bound.at_most is None else most)
        elif most:
            # Triangles that were given are the truth, but where they stand is rounded.
            bound = Bound(0.0, most, "proved", "hausdorff", "input triangles")
        made = Mesh._of_source(_chordal.scene_of_parts(source, list(self._sources.values()), list(self._sources)), bound)
        made._is_given = bound is None
        return made

    def _one_origin(self) -> str | None:
        """Where files count v from different ends, from below, as `concatenate`."""
        import numpy as np

        origins = [part.pop("origin") for part in self._parts]
        textured = [any(one["kind"] == "uv" for one in part["attributes"]) for part in self._parts]
        said = {origin for origin, has_uv in zip(origins, textured, strict=True) if has_uv}
        if len(said) < 2:
            return next(iter(said), None)
        for part, origin in zip(self._parts, origins, strict=True):
            for one in part["attributes"] if origin == "upper-left" else ():
                if one["kind"] == "uv":
                    rows = np.frombuffer(self._blocks[one["block"]]).reshape(-1, 2)
                    self._blocks[one["block"]] = (np.array([0.0, 1.0]) + rows * np.array([1.0, -1.0])).tobytes()
        return "lower-left"


class _Taken(NamedTuple):
    """What is taken of a mesh: with the mesh and the material, so that no others get their identities."""

    mesh: Mesh
    material: Any
    frame: dict[str, Any]
    nodes: list[dict[str, Any]]
    roots: list[int]
    parts: list[int]


def _shift(attribute: dict[str, Any], by: int, blocks: list[bytes]) -> None:
    """Numbers of groups after those that are there. 0 stays: it is no group."""
    import numpy as np

    values = np.frombuffer(blocks[attribute["block"]])
    attribute["block"] = len(blocks)
    blocks.append(np.where(values == 0, 0.0, values + by).tobytes())


def _one_unit(frames: list[dict[str, Any]], metres: float | None) -> float | None:
    units = {frame["metres_per_unit"] if frame["metres_per_unit"] is not None else metres for frame in frames}
    if len(units) > 1:
        said = ", ".join(sorted("none" if one is None else unit_of(one) or f"{one:g} m" for one in units))
        raise ValueError(
            f"things: they are in different units ({said}); to_unit makes them one, and unit= says that of those with none"
        )
    return units.pop()


def _one_up(frames: list[dict[str, Any]], up: str | None) -> str | None:
    said = {frame["up"] for frame in frames if frame["up"] is not None} | ({up} - {None})
    if len(said) > 1:
        raise ValueError('things: y is up in some and z in others; rotate("x", 90) brings y to z')
    return next(iter(said), None)


def _matrices(at: Any) -> list[list[float]]:
    """The matrices of places, column by column."""
    import numpy as np

    if at is None:
        return [_IDENTITY]
    found = coordinates("at", at)
    if found.shape[-1:] == (3,) and found.ndim in (1, 2):
        moved = np.tile(np.eye(4), (found.size // 3, 1, 1))
        moved[:, :3, 3] = found.reshape(-1, 3)
        found = moved
    elif found.ndim == 2:
        found = found[None]
    if found.ndim != 3 or found.shape[1:] not in ((3, 4), (4, 4)):
        raise ValueError(f"at: a vector, a matrix, or several of them: (3,), (4, 4), (n, 3) or (n, 4, 4), not {found.shape}")
    if found.shape[1] == 4 and not np.array_equal(found[:, 3], np.tile([0.0, 0.0, 0.0, 1.0], (len(found), 1))):
        raise ValueError("at: the last row of a matrix is 0, 0, 0, 1")
    for rows in found.tolist():
        if _volume_of(rows[:3]) == 0:
            raise ValueError("at: a matrix flattens; of a mesh without thickness nothing is the front")
    whole = np.tile(np.eye(4), (len(found), 1, 1))
    whole[:, :3] = found[:, :3]
    matrices: list[list[float]] = whole.transpose(0, 2, 1).reshape(-1, 16).tolist()
    return matrices
