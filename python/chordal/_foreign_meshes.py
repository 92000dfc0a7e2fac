"""Meshes of objects of other libraries, which are recognized by their attributes, so that no library is imported."""

from __future__ import annotations

from typing import Any

from chordal import _chordal
from chordal._arguments import warn
from chordal._assembly import Placed, scene
from chordal._mesh import Mesh
from chordal._registry import registered
from chordal._trimesh_materials import is_default, material_of
from chordal._units import TRIMESH_NAMES


def mesh_of(thing: Any, *, weld: bool = False, is_bare: bool = False) -> Mesh | None:
    """The mesh of an object of another library, with its normals, texture coordinates, colours, its unit if it has a name here,
    and its material unless `is_bare`; None if the object is no mesh."""
    if _is_trimesh_scene(thing):
        return _scene_of_trimesh(thing, weld=weld, unit=_unit_of(thing))
    _refuse_cells(thing)
    for is_of_library, arrays in _KNOWN:
        if is_of_library(thing):
            mesh = Mesh(**arrays(thing), weld=weld, unit=_unit_of(thing))
            return mesh if is_bare else _with_material_of(thing, mesh)
    return None


def _unit_of(thing: Any) -> str | None:
    name = getattr(thing, "units", None)
    if not isinstance(name, str):
        return None
    return next((unit for unit, names in TRIMESH_NAMES.items() if name.lower() in names), None)


def mesh_like(thing: Any) -> bool:
    """Whether an object is a mesh of another library."""
    return _is_trimesh_scene(thing) or any(is_of_library(thing) for is_of_library, _ in _KNOWN)


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
    # The other two are set by its constructor, so that its class does not have them.
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
    # Points of the plane get z = 0.
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
    # trimesh keeps assigned normals in its cache. `in` empties the cache first if the vertices or faces have changed.
    cache: Any = getattr(thing, "_cache", None)
    if hasattr(cache, "cache") and "vertex_normals" in cache and not _has_computed_normals(thing):
        arrays["normals"] = np.asarray(thing.vertex_normals)
    return arrays


def _has_computed_normals(thing: Any) -> bool:
    """Whether trimesh computed the vertex normals in its cache, where it keeps assigned ones as well."""
    import numpy as np

    # To compute normals it first stores the angles of the faces. Since others ask for these too, the values decide.
    names = list(thing._cache.cache)
    compute = getattr(getattr(type(thing).vertex_normals, "fget", None), "__wrapped__", None)
    if compute is None or "face_angles" not in names[: names.index("vertex_normals")]:
        return False
    return np.array_equal(compute(thing), thing.vertex_normals)


# Tried in this order: the last one accepts anything with vertices and faces.
_KNOWN = (
    (_is_open3d, _of_open3d),
    (_is_open3d_tensor, _of_open3d_tensor),
    (_is_pyvista, _of_pyvista),
    (_is_manifold, _of_manifold),
    (_is_meshio, _of_meshio),
    (_is_trimesh, _of_trimesh),
)


def _with_material_of(thing: Any, mesh: Mesh) -> Mesh:
    """A mesh with the material of an object of trimesh, unless that is trimesh's default."""
    visual = getattr(thing, "visual", None)
    material = getattr(visual, "material", None) if getattr(visual, "kind", None) == "texture" else None
    if material is None or not hasattr(material, "main_color") or is_default(material):
        return mesh
    return scene(Placed(mesh, name="triangles", material=material_of(material, has_uv=mesh.uv is not None)))


def _is_trimesh_scene(thing: Any) -> bool:
    """Whether an object is a scene of trimesh, by the attributes of its class."""
    return all(hasattr(type(thing), name) for name in ("add_geometry", "to_mesh", "dump"))


def _scene_of_trimesh(thing: Any, *, weld: bool, unit: str | None) -> Mesh:
    """All meshes of a scene, each as a part with its nodes. Other geometry is dropped with a warning."""
    import numpy as np

    meshes = {name: mesh_of(geometry, weld=weld, is_bare=True) for name, geometry in thing.geometry.items()}
    others = sorted({type(thing.geometry[name]).__name__ for name, mesh in meshes.items() if mesh is None})
    if others:
        warn(f"{', '.join(others)}: these stay behind, for a scene is of triangles")
    materials: dict[int, Any] = {}
    placed = []
    for node in thing.graph.nodes_geometry:
        matrix, name = thing.graph[node]
        mesh = meshes.get(name)
        if mesh is None:
            continue
        visual = getattr(thing.geometry[name], "visual", None)
        material = getattr(visual, "material", None)
        if id(material) not in materials:
            materials[id(material)] = None if material is None else material_of(material, has_uv=mesh.uv is not None)
        at = None if np.array_equal(matrix, np.eye(4)) else matrix
        placed.append(Placed(mesh, at, name=str(node), material=materials[id(material)]))
    if not placed:
        raise ValueError("thing: there is no mesh in this scene")
    return scene(placed, unit=unit)  # type: ignore[arg-type]


registered.mesh_of = mesh_of
