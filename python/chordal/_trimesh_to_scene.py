"""Conversion of scenes from trimesh: meshes with their transforms and materials."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from chordal._arguments import warn
from chordal._trimesh_materials import material_of

if TYPE_CHECKING:
    from chordal._mesh import Mesh


def is_trimesh_scene(thing: Any) -> bool:
    """Whether an object is a scene of trimesh, by the attributes of its class."""
    return all(hasattr(type(thing), name) for name in ("add_geometry", "to_mesh", "dump"))


def scene_of_trimesh(thing: Any, *, weld: bool, unit: str | None) -> Mesh:
    """All meshes of a scene, each as a part with its nodes. Other geometry is dropped with a warning."""
    import numpy as np

    from chordal._assembly import Placed, scene
    from chordal._interop import mesh_of

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
