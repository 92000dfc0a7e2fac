"""Scenes of trimesh as ours: meshes with their places and materials."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

from chordal._arguments import warn
from chordal._material import Material

if TYPE_CHECKING:
    from chordal._mesh import Mesh


def is_trimesh_scene(thing: Any) -> bool:
    """Whether it is a scene of trimesh; its class says it, as of meshes."""
    return all(hasattr(type(thing), name) for name in ("add_geometry", "to_mesh", "dump"))


def scene_of_trimesh(thing: Any, *, weld: bool, unit: str | None) -> Mesh:
    """All meshes of a scene, each a part that its nodes show. What is no mesh stays behind, with a warning."""
    import numpy as np

    from chordal._assembly import Placed, scene
    from chordal._interop import mesh_of

    meshes = {name: mesh_of(one, weld=weld) for name, one in thing.geometry.items()}
    others = sorted({type(thing.geometry[name]).__name__ for name, mesh in meshes.items() if mesh is None})
    if others:
        warn(f"{', '.join(others)}: these stay behind, for a scene is of triangles")
    materials: dict[int, Material | None] = {}
    placed = []
    for node in thing.graph.nodes_geometry:
        matrix, name = thing.graph[node]
        mesh = meshes.get(name)
        if mesh is None:
            continue
        visual = getattr(thing.geometry[name], "visual", None)
        own = getattr(visual, "material", None)
        if id(own) not in materials:
            materials[id(own)] = None if own is None else _material(own, has_uv=mesh.uv is not None)
        at = None if np.array_equal(matrix, np.eye(4)) else matrix
        placed.append(Placed(mesh, at, name=str(node), material=materials[id(own)]))
    if not placed:
        raise ValueError("thing: there is no mesh in this scene")
    return scene(placed, unit=unit)  # type: ignore[arg-type]


def _material(theirs: Any, has_uv: bool) -> Material:
    """A material of trimesh, which has glTF's terms, or only colours."""
    pbr = theirs if hasattr(theirs, "baseColorFactor") else theirs.to_pbr()
    pictures = {
        "texture": "baseColorTexture",
        "metallic_roughness_texture": "metallicRoughnessTexture",
        "normal_texture": "normalTexture",
        "occlusion_texture": "occlusionTexture",
        "emissive_texture": "emissiveTexture",
    }
    # Without coordinates no picture is seen.
    found = {own: _png(getattr(pbr, name, None)) for own, name in pictures.items() if has_uv}

    def said(name: str, otherwise: Any) -> Any:
        value = getattr(pbr, name, None)
        return otherwise if value is None else value

    color = [float(x) for x in said("baseColorFactor", (1.0, 1.0, 1.0, 1.0))]
    # Bytes of a factor, which is linear as in glTF.
    bytes_like = getattr(getattr(pbr, "baseColorFactor", None), "dtype", None)
    color = [x / 255 for x in color] if bytes_like is not None and bytes_like.kind in "iu" else color
    return Material(
        str(getattr(theirs, "name", None) or ""),
        color=color,
        metallic=float(said("metallicFactor", 1.0)),
        roughness=float(said("roughnessFactor", 1.0)),
        emissive=[float(x) for x in said("emissiveFactor", (0.0, 0.0, 0.0))],
        double_sided=bool(said("doubleSided", False)),
        alpha=str(said("alphaMode", "OPAQUE")).lower(),  # type: ignore[arg-type]
        cutoff=float(said("alphaCutoff", 0.5)),
        **found,
    )


def _png(image: Any) -> bytes | None:
    """A picture of Pillow as a file."""
    if image is None:
        return None
    content = io.BytesIO()
    image.save(content, "PNG")
    return content.getvalue()
