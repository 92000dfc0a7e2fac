"""Materials of trimesh as ours, and ours as trimesh's. Both have glTF's terms."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

from chordal._libraries import library
from chordal._material import Material

if TYPE_CHECKING:
    from chordal._mesh import Mesh

#: Our names of pictures, and those of glTF and trimesh.
_PICTURES = {
    "texture": "baseColorTexture",
    "metallic_roughness_texture": "metallicRoughnessTexture",
    "normal_texture": "normalTexture",
    "occlusion_texture": "occlusionTexture",
    "emissive_texture": "emissiveTexture",
}
#: The colour of a material of trimesh that says nothing: of those for .obj.
_UNSAID = [102, 102, 102, 255]


def with_material_of(thing: Any, mesh: Mesh) -> Mesh:
    """A mesh with the material that one of trimesh has, if that says anything."""
    visual = getattr(thing, "visual", None)
    theirs = getattr(visual, "material", None) if getattr(visual, "kind", None) == "texture" else None
    if theirs is None or not hasattr(theirs, "main_color") or _says_nothing(theirs):
        return mesh
    from chordal._assembly import Placed, scene

    return scene(Placed(mesh, name="triangles", material=material_of(theirs, has_uv=mesh.uv is not None)))


def _says_nothing(theirs: Any) -> bool:
    """Whether it is what trimesh puts where nothing was said: grey, with a tiny picture of one colour."""
    if hasattr(theirs, "baseColorFactor"):
        pictures = (getattr(theirs, name, None) for name in _PICTURES.values())
        numbers = (getattr(theirs, name, None) for name in ("baseColorFactor", "metallicFactor", "roughnessFactor", "emissiveFactor"))
        return all(value is None for value in (*pictures, *numbers))
    image = getattr(theirs, "image", None)
    is_blank = image is None or max(image.size) <= 2 and len(image.getcolors() or ()) == 1
    return is_blank and list(getattr(theirs, "diffuse", _UNSAID)) == _UNSAID


def material_to_trimesh(mesh: Mesh) -> Any:
    """The material of all faces of a mesh of one part, as trimesh has it, whose colours are bytes; None where there is no such
    one."""
    import numpy as np

    groups = [one for one in (mesh.attributes if len(mesh.parts) == 1 else ()) if (one.kind, one.of) == ("group", "material")]
    numbers = np.unique(groups[0].values) if groups else np.zeros(0)
    if len(numbers) != 1 or numbers[0] < 1 or numbers[0] > len(mesh.materials):
        return None
    said = mesh.materials[int(numbers[0]) - 1]
    pbr = said.get("pbrMetallicRoughness", {})
    pictures: dict[str, Any] = {}
    for own in _PICTURES.values():
        place = pbr.get(own, said.get(own))
        image = None if place is None else mesh.images[mesh.textures[place["index"]].get("source", 0)]
        pictures[own] = None if image is None else library("PIL.Image").open(io.BytesIO(image))
    return library("trimesh").visual.material.PBRMaterial(
        name=said.get("name") or None,
        baseColorFactor=pbr.get("baseColorFactor"),
        metallicFactor=pbr.get("metallicFactor"),
        roughnessFactor=pbr.get("roughnessFactor"),
        emissiveFactor=said.get("emissiveFactor"),
        doubleSided=said.get("doubleSided", False),
        alphaMode=said.get("alphaMode"),
        alphaCutoff=said.get("alphaCutoff"),
        **pictures,
    )


def material_of(theirs: Any, has_uv: bool) -> Material:
    """A material of trimesh, which has glTF's terms, or only colours."""
    pbr = theirs if hasattr(theirs, "baseColorFactor") else theirs.to_pbr()
    # Without coordinates no picture is seen.
    found = {own: _png(getattr(pbr, name, None)) for own, name in _PICTURES.items() if has_uv}

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
