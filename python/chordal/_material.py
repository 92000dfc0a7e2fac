"""`Material`: the appearance of a surface."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, Literal, SupportsFloat

from chordal import _files
from chordal._arguments import number
from chordal._hints import hint_keywords_of
from chordal._picture import Picture

#: A PNG or JPEG file, by its path or its bytes, or a `Picture`.
Image = str | os.PathLike[str] | bytes | Picture
if TYPE_CHECKING:
    from typing import TypeAlias

    from numpy.typing import NDArray

    #: Red, green and blue, and perhaps alpha, from 0 to 1, or a text as in "#d33" or "#dd3333".
    _Color: TypeAlias = str | Sequence[SupportsFloat] | NDArray[Any]

#: The first bytes of image files that glTF can store, and their media types.
_IMAGES = ((b"\x89PNG\r\n\x1a\n", "image/png"), (b"\xff\xd8\xff", "image/jpeg"))


@dataclass(frozen=True)
class Material:
    """The appearance of a surface, in the terms of glTF. `Placed` assigns one to a mesh.

    >>> import chordal
    >>> red = chordal.Material("red", color="#d33", roughness=0.4)
    >>> one = chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    >>> chordal.scene(chordal.Placed(one, material=red)).materials[0]["name"]
    'red'
    """

    #: Its name.
    name: str = ""
    #: The colour: three or four linear numbers from 0 to 1, as in glTF; or a text as in "#d33" or "#dd3333", in sRGB, as in
    #: CSS. It is multiplied with the texture.
    color: _Color = (1.0, 1.0, 1.0)
    #: The metallic factor, from 0 to 1.
    metallic: float = 0.0
    #: The roughness, from 0 (a mirror) to 1.
    roughness: float = 1.0
    #: The emitted light, as `color`.
    emissive: _Color = (0.0, 0.0, 0.0)
    #: An image of the colour, placed by the texture coordinates of the mesh.
    texture: Image | None = None
    #: An image of `roughness` in green and `metallic` in blue.
    metallic_roughness_texture: Image | None = None
    #: A normal map.
    normal_texture: Image | None = None
    #: An image of the ambient light that reaches the surface, in red.
    occlusion_texture: Image | None = None
    #: An image of `emissive`.
    emissive_texture: Image | None = None
    #: Whether the back is drawn, too.
    double_sided: bool = False
    #: The use of alpha: "opaque" ignores it, "mask" leaves out pixels below `cutoff`, "blend" mixes with the background.
    alpha: Literal["opaque", "mask", "blend"] = "opaque"
    #: The least alpha that is drawn, for "mask".
    cutoff: float = 0.5

    def __post_init__(self) -> None:
        if not isinstance(self.name, str):
            raise TypeError(f"name: a text, not {type(self.name).__name__}")
        values: dict[str, Any] = {"color": _color("color", self.color, 4), "emissive": _color("emissive", self.emissive, 3)}
        for name in ("metallic", "roughness", "cutoff"):
            values[name] = _share(name, getattr(self, name))
        if self.alpha not in ("opaque", "mask", "blend"):
            raise ValueError(f"alpha: opaque, mask or blend, not {self.alpha!r}")
        # The class is frozen.
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        arguments = [repr(self.name)] if self.name else []
        for field in fields(self)[1:]:
            value = getattr(self, field.name)
            if isinstance(value, tuple):
                # An alpha of 1 is left out.
                value = value[:3] if value[3:] == (1.0,) else value
            if value != field.default:
                arguments.append(f"{field.name}={f'<{len(value):,} bytes>' if isinstance(value, bytes) else repr(value)}")
        return f"Material({', '.join(arguments)})"


hint_keywords_of(Material)


def image_of(name: str, image: object) -> tuple[bytes, str]:
    """The content of an image file, and its media type."""
    if isinstance(image, Picture):
        content = image.to_bytes("png")
    elif isinstance(image, (bytes, bytearray, memoryview)):
        content = bytes(image)
    elif isinstance(image, (str, os.PathLike)):
        content = _files.read(image)
    else:
        raise TypeError(f"{name}: a path, the bytes of a file or a Picture, not {type(image).__name__}")
    kind = next((kind for mark, kind in _IMAGES if content.startswith(mark)), None)
    if kind is None:
        raise ValueError(f"{name}: a file of PNG or JPEG, as glTF holds it; this one begins with {content[:4]!r}")
    return content, kind


def gltf_of(material: Material, texture: Any) -> dict[str, Any]:
    """A material as glTF describes it. `texture` returns the number of an image, from its name and itself."""
    color, emissive = list(material.color), list(material.emissive)
    surface: dict[str, Any] = {"metallicFactor": material.metallic, "roughnessFactor": material.roughness}
    surface |= {} if color == [1.0] * 4 else {"baseColorFactor": color}
    gltf: dict[str, Any] = {"name": material.name} if material.name else {}
    gltf["pbrMetallicRoughness"] = surface
    slots = (
        ("texture", surface, "baseColorTexture"),
        ("metallic_roughness_texture", surface, "metallicRoughnessTexture"),
        ("normal_texture", gltf, "normalTexture"),
        ("occlusion_texture", gltf, "occlusionTexture"),
        ("emissive_texture", gltf, "emissiveTexture"),
    )
    for name, holder, key in slots:
        image = getattr(material, name)
        if image is not None:
            holder[key] = {"index": texture(name, image)}
    gltf |= {} if emissive == [0.0] * 3 else {"emissiveFactor": emissive}
    gltf |= {"doubleSided": True} if material.double_sided else {}
    if material.alpha != "opaque":
        gltf["alphaMode"] = material.alpha.upper()
    if material.alpha == "mask":
        gltf["alphaCutoff"] = material.cutoff
    return gltf


def _share(name: str, value: object) -> float:
    share = number(name, value)
    if not 0 <= share <= 1:
        raise ValueError(f"{name}: from 0 to 1, not {share:g}")
    return share


def _color(name: str, color: object, width: int) -> tuple[float, ...]:
    if isinstance(color, str):
        # "#rgb" and "#rrggbb" have no alpha.
        return (*_of_text(name, color), 1.0)[:width] if len(color) in (4, 7) else _of_text(name, color)[:width]
    parts = color.tolist() if hasattr(color, "tolist") else color
    if not isinstance(parts, (list, tuple)) or len(parts) not in (3, width):
        form = "three or four numbers" if width == 4 else "three numbers"
        raise ValueError(f'{name}: {form} from 0 to 1, or a text as in "#d33", not {color!r}')
    shares = tuple(_share(name, part) for part in parts)
    return (*shares, 1.0)[:width]


def _of_text(name: str, text: str) -> tuple[float, ...]:
    """The numbers of "#rgb", "#rrggbb" or "#rrggbbaa", converted from sRGB to linear light."""
    digits = text.removeprefix("#")
    digits = "".join(2 * digit for digit in digits) if len(digits) == 3 else digits
    if (
        not text.startswith("#")
        or len(digits) not in (6, 8)
        or any(digit not in "0123456789abcdefABCDEF" for digit in digits)
    ):
        raise ValueError(f'{name}: a text as in "#d33" or "#dd3333", not {text!r}')
    shares = [int(digits[k : k + 2], 16) / 255 for k in range(0, len(digits), 2)]
    # The transfer function of sRGB (IEC 61966-2-1:1999), rounded to six digits so that it is the same on every machine.
    light = [share / 12.92 if share <= 0.04045 else ((share + 0.055) / 1.055) ** 2.4 for share in shares[:3]]
    return (*(round(share, 6) for share in light), *shares[3:])
