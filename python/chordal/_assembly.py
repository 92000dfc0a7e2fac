"""`scene` and `Placed`: meshes assembled to a scene of parts, nodes and materials."""

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
from chordal._mesh import Mesh
from chordal._pieces import _largest, _State
from chordal._registry import registered
from chordal._scene import numbers_in
from chordal._transform import _volume_of
from chordal._units import METRES, refuse_unknown, unit_of

if TYPE_CHECKING:
    from typing import TypeAlias

    from numpy.typing import ArrayLike

    from chordal._shape import Shape

    #: The contents of a scene: meshes, files, meshes of other libraries, and lists or dictionaries of them.
    _Thing: TypeAlias = "Shape | Placed | Mapping[str, Any] | Sequence[Any] | Any"

_IDENTITY = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]


@dataclass(frozen=True, eq=False)
class Placed:
    """A mesh with its place, name and material, for `scene`.

    >>> import chordal
    >>> wheel = chordal.shapes.cylinder(0.5, 0.2).mesh(tol=0.05)
    >>> axle = chordal.scene(chordal.Placed(wheel, [(0, 0, -1), (0, 0, 1)], name="wheel"))
    >>> len(axle.parts), [node.name for node in axle.nodes], len(axle.faces) == 2 * len(wheel.faces)
    (1, ['wheel', 'wheel'], True)
    """

    #: A mesh, a file, or a mesh of another library; a scene of several parts; or a group of them, as a list or a dictionary by
    #: their names.
    what: _Thing
    #: Its place: a translation vector, or a matrix, 4 × 4 or its first three rows. Or several, n × 3, n × 4 × 4 or n × 3 × 4,
    #: for as many instances of one part. None leaves it in its place.
    at: ArrayLike | None = None
    #: The name of its node.
    name: str = ""
    #: The material of all its faces: a `Material`, or a dictionary as glTF describes one, without textures. None keeps its own
    #: materials.
    material: Material | Mapping[str, Any] | None = None


hint_keywords_of(Placed)


@keywords_hinted
def scene(
    *things: _Thing,
    unit: Literal["um", "mm", "cm", "m", "km", "in", "ft"] | None = None,
    up: Literal["y", "z"] | None = None,
) -> Mesh:
    """A scene of meshes: a `Mesh` with `parts`, `nodes` and `materials`, which `export` writes as glTF, for example.

    The things are meshes, files, meshes of other libraries, lists of them, or a dictionary by their names; `Placed` adds a
    place, a name and a material. A mesh that occurs several times becomes one part with several nodes. Meshes that are scenes
    keep their parts, nodes and materials; animations, cameras, lights and material variants are dropped with a warning.

    `unit` and `up` apply to meshes without their own. The bound is the largest of all meshes, scaled by the matrices of their
    nodes, and includes the rounding of positions.

    Raises `ValueError` if units or axes differ, a texture has no coordinates, or a matrix is not affine or is singular.

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
    assembly = _Assembly()
    roots = assembly.nodes_of(things, "", None)
    if not roots:
        raise ValueError("things: there is none")
    if not assembly.has_parts:
        raise ValueError("things: there is no mesh in them")
    return assembly.mesh(roots, None if unit is None else float(METRES[unit]), up)


class _Assembly:
    """A scene under construction: its JSON facts, and blocks of numbers."""

    def __init__(self) -> None:
        self.assets: Final = Assets()
        self._blocks: list[bytes] = []
        self._parts: list[dict[str, Any]] = []
        self._nodes: list[dict[str, Any]] = []
        self._groups: dict[str, list[str]] = {}
        #: The mesh of each thing, by identity. The thing is kept, so that its identity is not reused.
        self._meshes: dict[int, tuple[Any, Mesh]] = {}
        #: The parts and nodes of each pair of a mesh and a material, by their identities.
        self._added: dict[tuple[int, int], _AddedMesh] = {}
        #: For each node that shows a mesh, the bound of this mesh.
        self._bounds: dict[int, Bound] = {}
        self._sources: dict[int, _chordal.Source] = {}
        self._lost: set[str] = set()

    @property
    def has_parts(self) -> bool:
        """Whether the scene has a part."""
        return bool(self._added)

    def nodes_of(self, thing: Any, name: str, material: Any) -> list[int]:
        """Adds the nodes of a thing, and returns their numbers."""
        if isinstance(thing, Placed):
            return self._placed(thing, thing.name or name, material if thing.material is None else thing.material)
        if isinstance(thing, Mapping):
            return [node for title, item in thing.items() for node in self._titled(item, str(title), material)]
        if isinstance(thing, (list, tuple)):
            return [node for item in thing for node in self.nodes_of(item, name, material)]
        return [self._shown(self._mesh_of(thing), name, material)]

    def _titled(self, thing: Any, name: str, material: Any) -> list[int]:
        """The nodes of a named entry of a dictionary: one for each place of a thing, or a single one for a group."""
        is_group = isinstance(thing, (Mapping, list, tuple))
        return [self._node(name, self.nodes_of(thing, "", material))] if is_group else self.nodes_of(thing, name, material)

    def _placed(self, placed: Placed, name: str, material: Any) -> list[int]:
        is_group = isinstance(placed.what, (Mapping, list, tuple, Placed))
        nodes = []
        for matrix in _matrices(placed.at):
            # Each place has nodes of its own; `_shown` adds the parts below them only once.
            children = self.nodes_of(placed.what, "" if is_group else name, material)
            # A node that already has a matrix gets a parent with the new one.
            # What is no group has a single node.
            is_free = not is_group and self._nodes[children[0]]["matrix"] == _IDENTITY
            node = children[0] if is_free else self._node(name, children)
            self._nodes[node]["matrix"] = matrix
            nodes.append(node)
        return nodes

    def _node(self, name: str, children: list[int], part: int | None = None) -> int:
        self._nodes.append({"name": name, "matrix": _IDENTITY, "children": children, "part": part, "properties": {}})
        return len(self._nodes) - 1

    def _mesh_of(self, thing: Any) -> Mesh:
        if id(thing) not in self._meshes:
            shape = registered.shaped("things", thing)
            if not isinstance(shape, Mesh):
                raise TypeError(f"things: triangles, not {shape._source.kinds}: mesh them first")
            self._meshes[id(thing)] = thing, shape
        return self._meshes[id(thing)][1]

    def _shown(self, mesh: Mesh, name: str, material: Any) -> int:
        """Adds a node that shows a mesh: itself if the mesh is a single plain node, else by the nodes of the mesh below it."""
        key = id(mesh), id(material)
        if key not in self._added:
            self._added[key] = self._add(mesh, name, material)
        added, own_nodes = self._added[key], self._added[key].nodes
        only = own_nodes[0] if len(own_nodes) == 1 else None
        if only is not None and only["part"] is not None and only["matrix"] == _IDENTITY and not only["properties"]:
            node = self._node(name or only["name"], [], added.parts[only["part"]])
        else:
            # The mesh's nodes are appended in their order, so all their numbers move by `first`.
            first = len(self._nodes)
            for own_node in own_nodes:
                part = None if own_node["part"] is None else added.parts[own_node["part"]]
                children = [first + child for child in own_node["children"]]
                self._nodes.append({**own_node, "children": children, "part": part})
            node = self._node(name, [first + root for root in added.roots])
        self._bounds[node] = mesh.bound
        self._sources[node] = mesh._source
        return node

    def _add(self, mesh: Mesh, name: str, material: Any) -> _AddedMesh:
        """Adds the parts of a mesh, and returns their numbers with the mesh's own nodes, which are not added yet."""
        state = _State(mesh)
        facts, blocks = state.facts, state.blocks
        names = facts["groups"].pop("material", [""])
        self._note_what_is_lost(facts)
        override = None if material is None else self.assets.number_of(material)
        # Group 0 of each kind means "no group", and its name is empty.
        offsets = {kind: len(self._groups.get(kind, [""])) - 1 for kind in facts["groups"]}
        # Face groups that name materials move by the number of materials that are there already.
        offsets["material"] = self.assets.add(facts["assets"], blocks, names) if override is None else 0
        for kind, own_names in facts["groups"].items():
            self._groups.setdefault(kind, [""]).extend(own_names[1:])
        parts = []
        for part in facts["parts"]:
            if override is not None:
                self._paint(part, override, blocks)
            for attribute in part["attributes"]:
                if attribute["kind"] == "group" and offsets.get(attribute["of"]):
                    _shift(attribute, offsets[attribute["of"]], blocks)
            for mark in part["marks"]:
                if mark["material"] is not None:
                    mark["material"] = mark["material"] + offsets["material"] if override is None else override
            for holder, key in numbers_in(part):
                self._blocks.append(blocks[holder[key]])
                holder[key] = len(self._blocks) - 1
            if name and len(facts["parts"]) == 1:
                part["name"] = name
            parts.append(len(self._parts))
            self._parts.append({**part, "origin": facts["frame"]["texture_origin"]})
        return _AddedMesh(mesh, material, facts["frame"], facts["nodes"], facts["roots"], parts)

    def _note_what_is_lost(self, facts: dict[str, Any]) -> None:
        """Notes the data of a mesh that a scene does not keep, for the warning, and removes it from the nodes."""
        assets = facts["assets"]
        self._lost |= {title for title in ("cameras", "animations", "skins") if assets[title]}
        self._lost |= {"looks by variant" for kind in assets["face_kinds"] if kind[2]}
        self._lost |= {f"{name} of the file" for name in assets["extensions"]}
        for node in facts["nodes"]:
            properties = node["properties"]
            self._lost |= {f"{name} of nodes" for name in properties.get("extensions", {})}
            node["properties"] = {key: value for key, value in properties.items() if key not in ("camera", "skin", "extensions")}

    def _paint(self, part: dict[str, Any], material: int, blocks: list[bytes]) -> None:
        """Gives all faces of a part one material."""
        import numpy as np

        if self.assets.has_textures(material) and all(row["kind"] != "uv" for row in part["attributes"]):
            raise ValueError(
                "material: it has a texture, and the mesh no texture coordinates to put it on, as Mesh(…, uv=) takes"
            )
        # Three indices of four bytes.
        n_faces = len(blocks[part["faces"]]) // 12
        painted = {"kind": "group", "of": "material", "domain": "face", "width": 1, "block": len(blocks)}
        blocks.append(np.full(n_faces, material + 1.0).tobytes())
        kept = [row for row in part["attributes"] if (row["kind"], row["of"]) != ("group", "material")]
        part["attributes"] = [*kept, painted]

    def mesh(self, roots: list[int], metres: float | None, up: str | None) -> Mesh:
        """The scene as a mesh."""
        frames = [added.frame for added in self._added.values()]
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
        upper_ends = [(node, own.at_most) for node, own in self._bounds.items() if own.at_most is not None]
        at_most = _chordal.composed_bound(source, upper_ends)
        if bound is not None:
            bound = replace(bound, at_most=None if bound.at_most is None else at_most)
        elif at_most:
            # Given triangles count as the true shape, but the transforms of their nodes are rounded.
            bound = Bound(0.0, at_most, "proved", "hausdorff", "input triangles")
        mesh = Mesh._of_source(_chordal.scene_of_parts(source, list(self._sources.values()), list(self._sources)), bound)
        mesh._is_given = bound is None
        return mesh

    def _one_origin(self) -> str | None:
        """The texture origin of all parts. If the files have different ones, v is flipped to count from below, as in
        `concatenate`.
        """
        import numpy as np

        origins = [part.pop("origin") for part in self._parts]
        textured = [any(row["kind"] == "uv" for row in part["attributes"]) for part in self._parts]
        distinct = {origin for origin, has_uv in zip(origins, textured, strict=True) if has_uv}
        if len(distinct) < 2:
            return next(iter(distinct), None)
        for part, origin in zip(self._parts, origins, strict=True):
            for attribute in part["attributes"] if origin == "upper-left" else ():
                if attribute["kind"] == "uv":
                    rows = np.frombuffer(self._blocks[attribute["block"]]).reshape(-1, 2)
                    self._blocks[attribute["block"]] = (np.array([0.0, 1.0]) + rows * np.array([1.0, -1.0])).tobytes()
        return "lower-left"


class _AddedMesh(NamedTuple):
    """A mesh that was added: its nodes, and the numbers of its parts. It keeps the mesh and the material alive, so that no
    other object gets their identities.
    """

    mesh: Mesh
    material: Any
    frame: dict[str, Any]
    nodes: list[dict[str, Any]]
    roots: list[int]
    parts: list[int]


def _shift(attribute: dict[str, Any], by: int, blocks: list[bytes]) -> None:
    """Shifts the group numbers of an attribute past those of earlier meshes. 0 stays, since it means no group."""
    import numpy as np

    values = np.frombuffer(blocks[attribute["block"]])
    attribute["block"] = len(blocks)
    blocks.append(np.where(values == 0, 0.0, values + by).tobytes())


def _one_unit(frames: list[dict[str, Any]], metres: float | None) -> float | None:
    units = {frame["metres_per_unit"] if frame["metres_per_unit"] is not None else metres for frame in frames}
    if len(units) > 1:
        names = ", ".join(sorted("none" if length is None else unit_of(length) or f"{length:g} m" for length in units))
        raise ValueError(
            f"things: they are in different units ({names}); to_unit makes them one, and unit= says that of those with none"
        )
    return units.pop()


def _one_up(frames: list[dict[str, Any]], up: str | None) -> str | None:
    axes = {frame["up"] for frame in frames if frame["up"] is not None} | ({up} - {None})
    if len(axes) > 1:
        raise ValueError('things: y is up in some and z in others; rotate("x", 90) brings y to z')
    return next(iter(axes), None)


def _matrices(at: Any) -> list[list[float]]:
    """The matrices of places, in column-major order."""
    import numpy as np

    if at is None:
        return [_IDENTITY]
    places = coordinates("at", at)
    # A 3 × 3 array is three vectors here, never a matrix.
    if places.shape[-1:] == (3,) and places.ndim in (1, 2):
        translations = np.tile(np.eye(4), (places.size // 3, 1, 1))
        translations[:, :3, 3] = places.reshape(-1, 3)
        places = translations
    elif places.ndim == 2:
        places = places[None]
    if places.ndim != 3 or places.shape[1:] not in ((3, 4), (4, 4)):
        raise ValueError(f"at: a vector, a matrix, or several of them: (3,), (4, 4), (n, 3) or (n, 4, 4), not {places.shape}")
    if places.shape[1] == 4 and not np.array_equal(places[:, 3], np.tile([0.0, 0.0, 0.0, 1.0], (len(places), 1))):
        raise ValueError("at: the last row of a matrix is 0, 0, 0, 1")
    for rows in places.tolist():
        if _volume_of(rows[:3]) == 0:
            raise ValueError("at: a matrix flattens; of a mesh without thickness nothing is the front")
    square = np.tile(np.eye(4), (len(places), 1, 1))
    square[:, :3] = places[:, :3]
    matrices: list[list[float]] = square.transpose(0, 2, 1).reshape(-1, 16).tolist()
    return matrices
