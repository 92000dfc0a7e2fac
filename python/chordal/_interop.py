"""Meshes of other libraries as ours, and ours as theirs. Nothing of these libraries is imported before it is asked for: an
object is known by what it says of itself.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from chordal import _chordal
from chordal._arguments import warn
from chordal._libraries import library
from chordal._scene import first_of
from chordal._trimesh_materials import material_to_trimesh, with_material_of
from chordal._trimesh_to_scene import is_trimesh_scene, scene_of_trimesh
from chordal._units import TRIMESH_NAMES

if TYPE_CHECKING:
    from chordal._mesh import Mesh
    from chordal._scene import _Kind


def mesh_of(thing: Any, *, weld: bool = False, is_bare: bool = False) -> Mesh | None:
    """The mesh of an object of another library, with its normals, texture coordinates, colours, and its unit where that has a
    name here, and its material unless it is to be bare; None where it is none."""
    from chordal._mesh import Mesh

    if is_trimesh_scene(thing):
        return scene_of_trimesh(thing, weld=weld, unit=_unit_of(thing))
    _refuse_cells(thing)
    for is_one, arrays in _KNOWN:
        if is_one(thing):
            made = Mesh(**arrays(thing), weld=weld, unit=_unit_of(thing))
            return made if is_bare else with_material_of(thing, made)
    return None


def _unit_of(thing: Any) -> str | None:
    said = getattr(thing, "units", None)
    if not isinstance(said, str):
        return None
    return next((unit for unit, names in TRIMESH_NAMES.items() if said.lower() in names), None)


def mesh_like(thing: Any) -> bool:
    """Whether it is a mesh of another library."""
    return is_trimesh_scene(thing) or any(is_one(thing) for is_one, _ in _KNOWN)


def _has(thing: Any, *names: str) -> bool:
    """Whether its class has these. To ask the object itself would compute them: the triangles of trimesh, say."""
    return all(hasattr(type(thing), name) for name in names)


def _is_open3d(thing: Any) -> bool:
    return _has(thing, "has_vertex_normals", "triangles")


def _of_open3d(thing: Any) -> dict[str, Any]:
    import numpy as np

    found: dict[str, Any] = {"vertices": np.asarray(thing.vertices), "faces": np.asarray(thing.triangles)}
    if thing.has_vertex_normals():
        found["normals"] = np.asarray(thing.vertex_normals)
    if thing.has_vertex_colors():
        found["colors"] = np.asarray(thing.vertex_colors)
    if thing.has_triangle_uvs():
        _take_uv(np.asarray(thing.triangle_uvs), found)
    if thing.has_textures():
        warn("textures: these stay behind; a file keeps them, as chordal.load(\"a.glb\") does")
    return found


def _take_uv(rows: Any, found: dict[str, Any]) -> None:
    """Takes texture coordinates of corners as those of vertices, unless two corners at a vertex differ."""
    import numpy as np

    corners = found["faces"].ravel()
    uv = np.zeros((len(found["vertices"]), 2))
    if len(rows) == len(corners):
        uv[corners] = rows
    if len(rows) == len(corners) and np.array_equal(uv[corners], rows):
        found["uv"] = uv
    else:
        warn("texture coordinates of corners: these stay behind, for two at one vertex differ")


def _is_open3d_tensor(thing: Any) -> bool:
    return _has(thing, "vertex", "triangle", "to_legacy")


def _of_open3d_tensor(thing: Any) -> dict[str, Any]:
    vertex = thing.vertex
    found: dict[str, Any] = {"vertices": vertex.positions.cpu().numpy(), "faces": thing.triangle.indices.cpu().numpy()}
    for name in ("normals", "colors"):
        if name in vertex:
            found[name] = vertex[name].cpu().numpy()
    if "texture_uvs" in thing.triangle:
        _take_uv(thing.triangle.texture_uvs.cpu().numpy().reshape(-1, 2), found)
    tables = {"vertices": dict(vertex.items()), "triangles": dict(thing.triangle.items())}
    _warn_of_data(tables, ("positions", "indices", "normals", "colors", "texture_uvs"))
    return found


def _refuse_cells(thing: Any) -> None:
    """Raises `TypeError` for grids of PyVista, whose faces are those of their surface, and for several of its meshes."""
    is_several = _has(thing, "extract_surface", "combine")
    is_other = _has(thing, "regular_faces") or _has(thing, "spacing")
    if is_several or not is_other and _has(thing, "extract_surface", "points", "cell_data"):
        made = "thing.combine()" if is_several else "thing"
        call = f"chordal.Mesh.from_({made}.extract_surface())"
        raise TypeError(f"thing: {type(thing).__name__} has cells: {call} takes its surface")


def _is_pyvista(thing: Any) -> bool:
    return _has(thing, "regular_faces", "points")


def _of_pyvista(thing: Any) -> dict[str, Any]:
    import numpy as np

    mesh = thing if thing.is_all_triangles and not thing.n_strips else thing.triangulate()
    if thing.n_lines and not len(mesh.regular_faces):
        raise ValueError("thing: there are lines and no faces in it; thing.tube(radius=…) makes faces around them")
    if thing.n_points and not len(mesh.regular_faces):
        raise ValueError("thing: there are points and no faces in it; arrays of numpy are points")
    found: dict[str, Any] = {"vertices": np.asarray(mesh.points), "faces": np.asarray(mesh.regular_faces)}
    if mesh.active_texture_coordinates is not None:
        found["uv"] = np.asarray(mesh.active_texture_coordinates)
    if "Normals" in mesh.point_data:
        found["normals"] = np.asarray(mesh.point_data["Normals"])
    for name in ("colors", "RGB", "RGBA", "rgb", "rgba"):
        if name in mesh.point_data and np.ndim(mesh.point_data[name]) == 2 and mesh.point_data[name].shape[1] in (3, 4):
            found["colors"] = np.asarray(mesh.point_data[name])
            break
    # With these PyVista's own bodies come: names of texture coordinates, and the numbers of a cube's sides.
    taken = ("Normals", "colors", "RGB", "RGBA", "rgb", "rgba", "TextureCoordinates", "TCoords", "FaceIndex")
    uv_name = thing.point_data.active_texture_coordinates_name
    _warn_of_data({"points": thing.point_data, "cells": thing.cell_data}, (*taken, uv_name))
    return found


def _is_manifold(thing: Any) -> bool:
    return _has(thing, "to_mesh", "genus")


def _of_manifold(thing: Any) -> dict[str, Any]:
    import numpy as np

    # Double precision where this version has it.
    mesh = thing.to_mesh64() if hasattr(thing, "to_mesh64") else thing.to_mesh()
    return {"vertices": np.asarray(mesh.vert_properties)[:, :3], "faces": np.asarray(mesh.tri_verts).astype(np.int64)}


def _is_meshio(thing: Any) -> bool:
    return _has(thing, "cells_dict") and hasattr(thing, "points") and hasattr(thing, "point_data")


def _of_meshio(thing: Any) -> dict[str, Any]:
    import numpy as np

    cells = thing.cells_dict
    others = sorted(kind for kind in cells if kind not in ("triangle", "quad", "vertex", "line"))
    if others or not ("triangle" in cells or "quad" in cells):
        raise ValueError(f"a mesh of triangles and quads, not of {', '.join(others) or 'no faces'}")
    rows = [np.asarray(cells["triangle"])] if "triangle" in cells else []
    for quads in (np.asarray(cells["quad"]),) if "quad" in cells else ():
        rows += [quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]
    points = np.asarray(thing.points)
    flat = np.zeros((len(points), 3 - points.shape[1]))
    found: dict[str, Any] = {"vertices": np.hstack([points, flat]), "faces": np.concatenate(rows)}
    for name, width in (("normals", (3,)), ("uv", (2,)), ("colors", (3, 4))):
        values = np.asarray(thing.point_data.get(name, ()))
        if values.ndim == 2 and values.shape[1] in width:
            found[name] = values
    _warn_of_data({"points": thing.point_data, "cells": thing.cell_data}, ("normals", "uv", "colors"))
    if "line" in cells:
        warn("lines: these stay behind, for a mesh is of triangles")
    return found


def _is_trimesh(thing: Any) -> bool:
    return hasattr(thing, "vertices") and hasattr(thing, "faces") and not isinstance(thing, _chordal.Source)


def _warn_of_data(tables: dict[str, Any], taken: tuple[str | None, ...]) -> None:
    """Says which arrays of another library's mesh it does not bring along."""
    lost = [
        f"{name} of {owner}"
        for owner, table in tables.items()
        for name in ([] if table is None else table.keys())
        # What VTK writes for itself begins with its name.
        if name not in taken and not str(name).startswith(("vtk", "_"))
    ]
    if lost:
        warn(f"{', '.join(lost)}: these stay behind; of data a mesh has normals, texture coordinates and colours")


def _of_trimesh(thing: Any) -> dict[str, Any]:
    import numpy as np

    found: dict[str, Any] = {"vertices": np.asarray(thing.vertices), "faces": np.asarray(thing.faces)}
    visual = getattr(thing, "visual", None)
    uv = getattr(visual, "uv", None)
    if uv is not None and len(uv) == len(found["vertices"]):
        found["uv"] = np.asarray(uv)
    if visual is not None and getattr(visual, "kind", None) == "vertex":
        found["colors"] = np.asarray(visual.vertex_colors)
    elif visual is not None and getattr(visual, "kind", None) == "face":
        warn("colours of faces: these stay behind, for a mesh has colours of vertices")
    _warn_of_data({"vertices": getattr(thing, "vertex_attributes", None), "faces": getattr(thing, "face_attributes", None)}, ())
    # Normals that were only computed are not part of the mesh.
    cache = getattr(thing, "_cache", None)
    if cache is not None and "vertex_normals" in getattr(cache, "cache", {}):
        found["normals"] = np.asarray(thing.vertex_normals)
    return found


# Asked in this order: the last takes whatever has vertices and faces.
_KNOWN = (
    (_is_open3d, _of_open3d),
    (_is_open3d_tensor, _of_open3d_tensor),
    (_is_pyvista, _of_pyvista),
    (_is_manifold, _of_manifold),
    (_is_meshio, _of_meshio),
    (_is_trimesh, _of_trimesh),
)


class Interoperable:
    """A mesh as one of another library."""

    __slots__ = ()
    vertices: Any
    faces: Any
    normals: Any
    uv: Any
    colors: Any
    parts: Any
    attributes: Any
    materials: Any
    unit: Any

    @classmethod
    def from_(cls, thing: Any, *, weld: bool = False) -> Mesh:
        """The mesh of an object of trimesh, PyVista, Open3D, manifold3d or meshio, or of anything that has `vertices` and
        `faces`: positions, faces, and normals, texture coordinates and colours of vertices; the unit and the material of
        trimesh, and of its scenes the nodes. What of theirs stays behind is told by a `UserWarning`; the bound does, too. `weld`
        is as for `Mesh`.

        >>> import chordal, types
        >>> other = types.SimpleNamespace(vertices=[(0, 0, 0), (1, 0, 0), (0, 1, 0)], faces=[(0, 1, 2)])
        >>> chordal.Mesh.from_(other)
        <Mesh: 1 triangle, 3 vertices, from arrays>
        """
        found = mesh_of(thing, weld=weld)
        if found is None:
            raise TypeError(f"thing: a mesh of another library, not {type(thing).__name__}")
        return found

    def _vertex_rows(self, kind: _Kind) -> Any:
        """An attribute of the only part with one row for each vertex; None where there is no such one."""
        if len(self.parts) != 1:
            return None
        found = first_of(self.attributes, kind)
        fits = found is not None and found.domain == "vertex" and len(found.values) == len(self.vertices)
        return found.values if found is not None and fits else None

    def to_trimesh(self) -> Any:
        """A `trimesh.Trimesh` with the same vertices and faces, unmerged, and what these have of normals, texture
        coordinates and colours; the material where all faces have one. The bound is in its `metadata["chordal"]`. What stays behind
        is told by a `UserWarning`.
        """
        import numpy as np
        trimesh = library("trimesh")

        colors, uv, normals = (self._vertex_rows(kind) for kind in ("color", "uv", "normal"))
        visual = None
        material = material_to_trimesh(self)  # type: ignore[arg-type]
        if uv is not None or material is not None:
            rows = np.zeros((len(self.vertices), 2)) if uv is None else np.array(uv)
            visual = trimesh.visual.TextureVisuals(uv=rows, material=material)
        made = trimesh.Trimesh(
            vertices=np.array(self.vertices),
            faces=self.faces.astype(np.int64),
            vertex_normals=None if normals is None else np.array(normals),
            vertex_colors=None if colors is None or visual is not None else np.rint(np.array(colors) * 255).astype(np.uint8),
            visual=visual,
            process=False,
            metadata={"chordal": self._about()},
        )
        if self.unit is not None:
            made.units = TRIMESH_NAMES[self.unit][0]
        lost = [] if colors is None or visual is None else ["colours beside texture coordinates or a material"]
        self._warn_of_loss(lost, keeps_materials=material is not None)
        return made

    def to_pyvista(self) -> Any:
        """A `pyvista.PolyData` with the same vertices and faces, and what these have of normals, texture coordinates and
        colours. The bound is in its field data "chordal".
        """
        import numpy as np
        pyvista = library("pyvista")

        made = pyvista.PolyData.from_regular_faces(np.array(self.vertices), self.faces.astype(np.int64))
        colors, uv, normals = (self._vertex_rows(kind) for kind in ("color", "uv", "normal"))
        if normals is not None:
            made.point_data["Normals"] = np.array(normals)
        if uv is not None:
            made.active_texture_coordinates = np.array(uv)
        if colors is not None:
            made.point_data["colors"] = np.array(colors)
        made.add_field_data([str(self._about())], "chordal")
        self._warn_of_loss([])
        return made

    def to_open3d(self) -> Any:
        """An `open3d.geometry.TriangleMesh` with the same vertices and faces, and normals and colours of vertices."""
        import numpy as np
        open3d = library("open3d")

        made = open3d.geometry.TriangleMesh(
            open3d.utility.Vector3dVector(np.array(self.vertices)), open3d.utility.Vector3iVector(np.array(self.faces))
        )
        colors, uv, normals = (self._vertex_rows(kind) for kind in ("color", "uv", "normal"))
        if normals is not None:
            made.vertex_normals = open3d.utility.Vector3dVector(np.array(normals))
        if colors is not None:
            made.vertex_colors = open3d.utility.Vector3dVector(np.array(colors[:, :3]))
        if uv is not None:
            made.triangle_uvs = open3d.utility.Vector2dVector(np.array(uv)[self.faces.ravel()])
        self._warn_of_loss(["alpha of colours"] if colors is not None and colors.shape[1] == 4 and np.any(colors[:, 3] != 1) else [])
        return made

    def to_manifold3d(self) -> Any:
        """A `manifold3d.Manifold` of closed triangles. Raises `ValueError` where it takes them for none."""
        manifold3d = library("manifold3d")
        import numpy as np

        mesh = manifold3d.Mesh64(np.array(self.vertices), self.faces.astype(np.uint64))
        made = manifold3d.Manifold(mesh)
        status = made.status()
        if status != manifold3d.Error.NoError:
            raise ValueError(f"manifold3d takes this for no solid: {status.name}")
        return made

    def to_meshio(self) -> Any:
        """A `meshio.Mesh` with the same vertices and faces, and what these have of normals, texture coordinates, colours."""
        meshio = library("meshio")
        import numpy as np

        names: tuple[tuple[_Kind, str], ...] = (("normal", "normals"), ("uv", "uv"), ("color", "colors"))
        rows = {name: self._vertex_rows(kind) for kind, name in names}
        data = {name: np.array(values) for name, values in rows.items() if values is not None}
        self._warn_of_loss([])
        return meshio.Mesh(np.array(self.vertices), [("triangle", np.array(self.faces))], point_data=data)

    def _warn_of_loss(self, lost: list[str], keeps_materials: bool = False) -> None:
        """Says what of a mesh the other library does not get."""
        lost = [*lost, *(["materials"] if self.materials and not keeps_materials else [])]
        names = {"normal": "normals", "uv": "texture coordinates", "color": "colours"}
        if len(self.parts) > 1:
            kinds = {one.kind for part in self.parts for one in part.attributes} & names.keys()
            lost = [*lost, *(f"{names[kind]} of several parts" for kind in sorted(kinds))]
        else:
            there: tuple[_Kind, ...] = ("normal", "uv", "color")
            missing = (k for k in there if first_of(self.attributes, k) is not None and self._vertex_rows(k) is None)
            lost = [*lost, *(f"{names[kind]} of faces or corners" for kind in missing)]
        own = (one for part in self.parts for one in part.attributes if one.kind in ("custom", "blended"))
        lost = [*lost, *dict.fromkeys(str(one.of) for one in own)]
        if lost:
            warn(f"{', '.join(lost)}: these stay behind; a file keeps them, as mesh.export(\"a.glb\") does")

    def _about(self) -> dict[str, Any]:
        bound = self.bound  # type: ignore[attr-defined]
        return {"at_least": bound.at_least, "at_most": bound.at_most, "evidence": bound.evidence}
