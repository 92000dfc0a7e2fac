"""Conversion of materials from and to trimesh. Both use the terms of glTF."""

from __future__ import annotations

import importlib
import io
from typing import TYPE_CHECKING, Any

from chordal._material import Material

if TYPE_CHECKING:
    from chordal._mesh import Mesh

#: Our names of textures, and those of glTF and trimesh.
_PICTURES = {
    "texture": "baseColorTexture",
    "metallic_roughness_texture": "metallicRoughnessTexture",
    "normal_texture": "normalTexture",
    "occlusion_texture": "occlusionTexture",
    "emissive_texture": "emissiveTexture",
}
#: The default colour of trimesh's materials for .obj.
_DEFAULT_COLOR = [102, 102, 102, 255]


def is_default(material: Any) -> bool:
    """Whether it is trimesh's default for meshes without a material: grey, with a tiny image of one colour."""
    if hasattr(material, "baseColorFactor"):
        pictures = (getattr(material, name, None) for name in _PICTURES.values())
        factors = ("baseColorFactor", "metallicFactor", "roughnessFactor", "emissiveFactor")
        numbers = (getattr(material, name, None) for name in factors)
        return all(value is None for value in (*pictures, *numbers))
    image = getattr(material, "image", None)
    is_blank = image is None or max(image.size) <= 2 and len(image.getcolors() or ()) == 1
    return is_blank and list(getattr(material, "diffuse", _DEFAULT_COLOR)) == _DEFAULT_COLOR


def material_to_trimesh(mesh: Mesh) -> Any:
    """The material of all faces of a mesh of one part, as a material of trimesh, whose colours are bytes; None if there is no
    such material."""
    import numpy as np

    groups = [row for row in (mesh.attributes if len(mesh.parts) == 1 else ()) if (row.kind, row.of) == ("group", "material")]
    numbers = np.unique(groups[0].values) if groups else np.zeros(0)
    if len(numbers) != 1 or numbers[0] < 1 or numbers[0] > len(mesh.materials):
        return None
    gltf = mesh.materials[int(numbers[0]) - 1]
    pbr = gltf.get("pbrMetallicRoughness", {})
    pictures: dict[str, Any] = {}
    for name in _PICTURES.values():
        reference = pbr.get(name, gltf.get(name))
        image = None if reference is None else mesh.images[mesh.textures[reference["index"]].get("source", 0)]
        pictures[name] = None if image is None else importlib.import_module("PIL.Image").open(io.BytesIO(image))
    return importlib.import_module("trimesh").visual.material.PBRMaterial(
        name=gltf.get("name") or None,
        baseColorFactor=pbr.get("baseColorFactor"),
        metallicFactor=pbr.get("metallicFactor"),
        roughnessFactor=pbr.get("roughnessFactor"),
        emissiveFactor=gltf.get("emissiveFactor"),
        doubleSided=gltf.get("doubleSided", False),
        alphaMode=gltf.get("alphaMode"),
        alphaCutoff=gltf.get("alphaCutoff"),
        **pictures,
    )


def material_of(theirs: Any, has_uv: bool) -> Material:
    """Converts a material of trimesh, which has the terms of glTF or only colours."""
    pbr = theirs if hasattr(theirs, "baseColorFactor") else theirs.to_pbr()
    # Without texture coordinates, no texture is visible.
    textures = {own_name: _png(getattr(pbr, name, None)) for own_name, name in _PICTURES.items() if has_uv}

    def value_of(name: str, default: Any) -> Any:
        value = getattr(pbr, name, None)
        return default if value is None else value

    color = [float(x) for x in value_of("baseColorFactor", (1.0, 1.0, 1.0, 1.0))]
    # Factors in bytes are linear, as in glTF.
    bytes_like = getattr(getattr(pbr, "baseColorFactor", None), "dtype", None)
    color = [x / 255 for x in color] if bytes_like is not None and bytes_like.kind in "iu" else color
    return Material(
        str(getattr(theirs, "name", None) or ""),
        color=color,
        metallic=float(value_of("metallicFactor", 1.0)),
        roughness=float(value_of("roughnessFactor", 1.0)),
        emissive=[float(x) for x in value_of("emissiveFactor", (0.0, 0.0, 0.0))],
        double_sided=bool(value_of("doubleSided", False)),
        alpha=str(value_of("alphaMode", "OPAQUE")).lower(),  # type: ignore[arg-type]
        cutoff=float(value_of("alphaCutoff", 0.5)),
        **textures,
    )


def _png(image: Any) -> bytes | None:
    """An image of Pillow as a PNG file."""
    if image is None:
        return None
    content = io.BytesIO()
    image.save(content, "PNG")
    return content.getvalue()
