"""Conversion of meshes from and to other libraries. Libraries are imported only for conversions to them: their objects are
recognized by their attributes.
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
    """The mesh of an object of another library, with its normals, texture coordinates, colours, its unit if it has a name here,
    and its material unless `is_bare`; None if the object is no mesh."""
    from chordal._mesh import Mesh

    if is_trimesh_scene(thing):
        return scene_of_trimesh(thing, weld=weld, unit=_unit_of(thing))
    _refuse_cells(thing)
    for is_of_library, arrays in _KNOWN:
        if is_of_library(thing):
            mesh = Mesh(**arrays(thing), weld=weld, unit=_unit_of(thing))
            return mesh if is_bare else with_material_of(thing, mesh)
    return None


def _unit_of(thing: Any) -> str | None:
    name = getattr(thing, "units", None)
    if not isinstance(name, str):
        return None
    return next((unit for unit, names in TRIMESH_NAMES.items() if name.lower() in names), None)


def mesh_like(thing: Any) -> bool:
    """Whether an object is a mesh of another library."""
    return is_trimesh_scene(thing) or any(is_of_library(thing) for is_of_library, _ in _KNOWN)


def _has(thing: Any, *names: str) -> bool:
    """Whether the class of an object has these attributes. Looking at the object itself could compute them, as trimesh does."""
    return all(hasattr(type(thing), name) for name in names)


def _is_open3d(thing: Any) -> bool:
    return _has(thing, "has_vertex_normals", "triangles")


def _of_open3d(thing: Any) -> dict[str, Any]:
    import numpy as np

    arrays: dict[str, Any] = {"vertices": np.asarray(thing.vertices), "faces": np.asarray(thing.triangles)}
    if thing.has_vertex_normals():
        arrays["normals"] = np.asarray(thing.vertex_normals)
    if thing.has_vertex_colors():
        arrays["colors"] = np.asarray(thing.vertex_colors)
    if thing.has_triangle_uvs():
        _take_uv(np.asarray(thing.triangle_uvs), arrays)
    if thing.has_textures():
        warn("textures: these stay behind; a file keeps them, as chordal.load(\"a.glb\") does")
    return arrays


def _take_uv(rows: Any, arrays: dict[str, Any]) -> None:
    """Converts texture coordinates of corners to vertices, unless two corners at a vertex differ."""
    import numpy as np

    corners = arrays["faces"].ravel()
    uv = np.zeros((len(arrays["vertices"]), 2))
    if len(rows) == len(corners):
        uv[corners] = rows
    # If the vertices give back all rows, no corner overwrote another one with a different value.
    if len(rows) == len(corners) and np.array_equal(uv[corners], rows):
        arrays["uv"] = uv
    else:
        warn("texture coordinates of corners: these stay behind, for two at one vertex differ")


def _is_open3d_tensor(thing: Any) -> bool:
    return _has(thing, "vertex", "triangle", "to_legacy")


def _of_open3d_tensor(thing: Any) -> dict[str, Any]:
    vertex = thing.vertex
    arrays: dict[str, Any] = {"vertices": vertex.positions.cpu().numpy(), "faces": thing.triangle.indices.cpu().numpy()}
    for name in ("normals", "colors"):
        if name in vertex:
            arrays[name] = vertex[name].cpu().numpy()
    if "texture_uvs" in thing.triangle:
        _take_uv(thing.triangle.texture_uvs.cpu().numpy().reshape(-1, 2), arrays)
    tables = {"vertices": dict(vertex.items()), "triangles": dict(thing.triangle.items())}
    _warn_of_data(tables, ("positions", "indices", "normals", "colors", "texture_uvs"))
    return arrays


def _refuse_cells(thing: Any) -> None:
    """Raises `TypeError` for grids of PyVista, whose surface has to be extracted first, and for its collections of meshes."""
    is_collection = _has(thing, "extract_surface", "combine")
    is_other = _has(thing, "regular_faces") or _has(thing, "spacing")
    if is_collection or not is_other and _has(thing, "extract_surface", "points", "cell_data"):
        grid = "thing.combine()" if is_collection else "thing"
        call = f"chordal.Mesh.from_({grid}.extract_surface())"
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
    arrays: dict[str, Any] = {"vertices": np.asarray(mesh.points), "faces": np.asarray(mesh.regular_faces)}
    if mesh.active_texture_coordinates is not None:
        arrays["uv"] = np.asarray(mesh.active_texture_coordinates)
    if "Normals" in mesh.point_data:
        arrays["normals"] = np.asarray(mesh.point_data["Normals"])
    for name in ("colors", "RGB", "RGBA", "rgb", "rgba"):
        if name in mesh.point_data and np.ndim(mesh.point_data[name]) == 2 and mesh.point_data[name].shape[1] in (3, 4):
            arrays["colors"] = np.asarray(mesh.point_data[name])
            break
    # The last three are arrays of PyVista's own primitives: texture coordinates, and the numbers of a cube's sides.
    taken = ("Normals", "colors", "RGB", "RGBA", "rgb", "rgba", "TextureCoordinates", "TCoords", "FaceIndex")
    uv_name = thing.point_data.active_texture_coordinates_name
    _warn_of_data({"points": thing.point_data, "cells": thing.cell_data}, (*taken, uv_name))
    return arrays


def _is_manifold(thing: Any) -> bool:
    return _has(thing, "to_mesh", "genus")


def _of_manifold(thing: Any) -> dict[str, Any]:
    import numpy as np

    # In double precision, if this version of the library has it.
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
    arrays: dict[str, Any] = {"vertices": np.hstack([points, flat]), "faces": np.concatenate(rows)}
    for name, width in (("normals", (3,)), ("uv", (2,)), ("colors", (3, 4))):
        values = np.asarray(thing.point_data.get(name, ()))
        if values.ndim == 2 and values.shape[1] in width:
            arrays[name] = values
    _warn_of_data({"points": thing.point_data, "cells": thing.cell_data}, ("normals", "uv", "colors"))
    if "line" in cells:
        warn("lines: these stay behind, for a mesh is of triangles")
    return arrays


def _is_trimesh(thing: Any) -> bool:
    return hasattr(thing, "vertices") and hasattr(thing, "faces") and not isinstance(thing, _chordal.Source)


def _warn_of_data(tables: dict[str, Any], taken: tuple[str | None, ...]) -> None:
    """Warns of the arrays of another library's mesh that are dropped."""
    lost = [
        f"{name} of {owner}"
        for owner, table in tables.items()
        for name in ([] if table is None else table.keys())
        # Arrays that VTK writes for its own use begin with its name.
        if name not in taken and not str(name).startswith(("vtk", "_"))
    ]
    if lost:
        warn(f"{', '.join(lost)}: these stay behind; of data a mesh has normals, texture coordinates and colours")


def _of_trimesh(thing: Any) -> dict[str, Any]:
    import numpy as np

    arrays: dict[str, Any] = {"vertices": np.asarray(thing.vertices), "faces": np.asarray(thing.faces)}
    visual = getattr(thing, "visual", None)
    uv = getattr(visual, "uv", None)
    if uv is not None and len(uv) == len(arrays["vertices"]):
        arrays["uv"] = np.asarray(uv)
    if visual is not None and getattr(visual, "kind", None) == "vertex":
        arrays["colors"] = np.asarray(visual.vertex_colors)
    elif visual is not None and getattr(visual, "kind", None) == "face":
        warn("colours of faces: these stay behind, for a mesh has colours of vertices")
    _warn_of_data({"vertices": getattr(thing, "vertex_attributes", None), "faces": getattr(thing, "face_attributes", None)}, ())
    # Only normals in trimesh's cache, where assigned ones are kept: others would be computed here.
    cache = getattr(thing, "_cache", None)
    if cache is not None and "vertex_normals" in getattr(cache, "cache", {}):
        arrays["normals"] = np.asarray(thing.vertex_normals)
    return arrays


# Tried in this order: the last one accepts anything with vertices and faces.
_KNOWN = (
    (_is_open3d, _of_open3d),
    (_is_open3d_tensor, _of_open3d_tensor),
    (_is_pyvista, _of_pyvista),
    (_is_manifold, _of_manifold),
    (_is_meshio, _of_meshio),
    (_is_trimesh, _of_trimesh),
)


class Interoperable:
    """Conversions of a mesh from and to other libraries."""

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
        """The mesh of an object of trimesh, PyVista, Open3D, manifold3d or meshio, or of any object with `vertices` and
        `faces`: positions, faces, and normals, texture coordinates and colours of vertices; for trimesh also the unit, the
        material, and the nodes of a scene. Other data is dropped with a `UserWarning`; a bound is not taken over, either.
        `weld` is as for `Mesh`.

        >>> import chordal, types
        >>> other = types.SimpleNamespace(vertices=[(0, 0, 0), (1, 0, 0), (0, 1, 0)], faces=[(0, 1, 2)])
        >>> chordal.Mesh.from_(other)
        <Mesh: 1 triangle, 3 vertices, from arrays>
        """
        mesh = mesh_of(thing, weld=weld)
        if mesh is None:
            raise TypeError(f"thing: a mesh of another library, not {type(thing).__name__}")
        return mesh

    def _vertex_rows(self, kind: _Kind) -> Any:
        """The rows of an attribute of the only part with one row for each vertex; None if there is no such attribute."""
        if len(self.parts) != 1:
            return None
        attribute = first_of(self.attributes, kind)
        fits = attribute is not None and attribute.domain == "vertex" and len(attribute.values) == len(self.vertices)
        return attribute.values if attribute is not None and fits else None

    def to_trimesh(self) -> Any:
        """A `trimesh.Trimesh` with the same vertices and faces, unmerged, with normals, texture coordinates and colours of
        vertices, and with the material if all faces have the same. The bound is in its `metadata["chordal"]`. Other data is
        dropped with a `UserWarning`.
        """
        import numpy as np
        trimesh = library("trimesh")

        colors, uv, normals = (self._vertex_rows(kind) for kind in ("color", "uv", "normal"))
        visual = None
        material = material_to_trimesh(self)  # type: ignore[arg-type]
        if uv is not None or material is not None:
            rows = np.zeros((len(self.vertices), 2)) if uv is None else np.array(uv)
            visual = trimesh.visual.TextureVisuals(uv=rows, material=material)
        result = trimesh.Trimesh(
            vertices=np.array(self.vertices),
            faces=self.faces.astype(np.int64),
            vertex_normals=None if normals is None else np.array(normals),
            vertex_colors=None if colors is None or visual is not None else np.rint(np.array(colors) * 255).astype(np.uint8),
            visual=visual,
            process=False,
            metadata={"chordal": self._about()},
        )
        if self.unit is not None:
            result.units = TRIMESH_NAMES[self.unit][0]
        lost = [] if colors is None or visual is None else ["colours beside texture coordinates or a material"]
        self._warn_of_loss(lost, keeps_materials=material is not None)
        return result

    def to_pyvista(self) -> Any:
        """A `pyvista.PolyData` with the same vertices and faces, and with normals, texture coordinates and colours of
        vertices. The bound is in its field data "chordal".
        """
        import numpy as np
        pyvista = library("pyvista")

        poly_data = pyvista.PolyData.from_regular_faces(np.array(self.vertices), self.faces.astype(np.int64))
        colors, uv, normals = (self._vertex_rows(kind) for kind in ("color", "uv", "normal"))
        if normals is not None:
            poly_data.point_data["Normals"] = np.array(normals)
        if uv is not None:
            poly_data.active_texture_coordinates = np.array(uv)
        if colors is not None:
            poly_data.point_data["colors"] = np.array(colors)
        poly_data.add_field_data([str(self._about())], "chordal")
        self._warn_of_loss([])
        return poly_data

    def to_open3d(self) -> Any:
        """An `open3d.geometry.TriangleMesh` with the same vertices and faces, and normals and colours of vertices."""
        import numpy as np
        open3d = library("open3d")

        result = open3d.geometry.TriangleMesh(
            open3d.utility.Vector3dVector(np.array(self.vertices)), open3d.utility.Vector3iVector(np.array(self.faces))
        )
        colors, uv, normals = (self._vertex_rows(kind) for kind in ("color", "uv", "normal"))
        if normals is not None:
            result.vertex_normals = open3d.utility.Vector3dVector(np.array(normals))
        if colors is not None:
            result.vertex_colors = open3d.utility.Vector3dVector(np.array(colors[:, :3]))
        if uv is not None:
            result.triangle_uvs = open3d.utility.Vector2dVector(np.array(uv)[self.faces.ravel()])
        self._warn_of_loss(["alpha of colours"] if colors is not None and colors.shape[1] == 4 and np.any(colors[:, 3] != 1) else [])
        return result

    def to_manifold3d(self) -> Any:
        """A `manifold3d.Manifold` of closed triangles. Raises `ValueError` if manifold3d does not accept them as a solid."""
        manifold3d = library("manifold3d")
        import numpy as np

        mesh = manifold3d.Mesh64(np.array(self.vertices), self.faces.astype(np.uint64))
        manifold = manifold3d.Manifold(mesh)
        status = manifold.status()
        if status != manifold3d.Error.NoError:
            raise ValueError(f"manifold3d takes this for no solid: {status.name}")
        return manifold

    def to_meshio(self) -> Any:
        """A `meshio.Mesh` with the same vertices and faces, and with normals, texture coordinates and colours of vertices."""
        meshio = library("meshio")
        import numpy as np

        names: tuple[tuple[_Kind, str], ...] = (("normal", "normals"), ("uv", "uv"), ("color", "colors"))
        rows = {name: self._vertex_rows(kind) for kind, name in names}
        data = {name: np.array(values) for name, values in rows.items() if values is not None}
        self._warn_of_loss([])
        return meshio.Mesh(np.array(self.vertices), [("triangle", np.array(self.faces))], point_data=data)

    def _warn_of_loss(self, lost: list[str], keeps_materials: bool = False) -> None:
        """Warns of data that the conversion to another library drops."""
        lost = [*lost, *(["materials"] if self.materials and not keeps_materials else [])]
        names = {"normal": "normals", "uv": "texture coordinates", "color": "colours"}
        if len(self.parts) > 1:
            kinds = {attribute.kind for part in self.parts for attribute in part.attributes} & names.keys()
            lost = [*lost, *(f"{names[kind]} of several parts" for kind in sorted(kinds))]
        else:
            vertex_kinds: tuple[_Kind, ...] = ("normal", "uv", "color")
            missing = (k for k in vertex_kinds if first_of(self.attributes, k) is not None and self._vertex_rows(k) is None)
            lost = [*lost, *(f"{names[kind]} of faces or corners" for kind in missing)]
        others = (row for part in self.parts for row in part.attributes if row.kind in ("custom", "blended"))
        lost = [*lost, *dict.fromkeys(str(attribute.of) for attribute in others)]
        if lost:
            warn(f"{', '.join(lost)}: these stay behind; a file keeps them, as mesh.export(\"a.glb\") does")

    def _about(self) -> dict[str, Any]:
        bound = self.bound  # type: ignore[attr-defined]
        return {"at_least": bound.at_least, "at_most": bound.at_most, "evidence": bound.evidence}
