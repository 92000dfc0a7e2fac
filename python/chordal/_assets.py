"""`Assets`: the materials of a scene, with their textures, samplers and images."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

from chordal._material import Material, gltf_of, image_of

#: The extension of glTF by which a material refers to its coarser levels of detail.
_LEVELS = "MSFT_lod"


class Assets:
    """Materials, textures, samplers and images, as in glTF: the entries of a list refer to those of others by their numbers."""

    def __init__(self) -> None:
        self.materials: list[dict[str, Any]] = []
        self._textures: list[dict[str, Any]] = []
        self._samplers: list[Any] = []
        self._images: list[tuple[dict[str, Any], bytes | None]] = []
        self._required: list[str] = []
        self._keeps_bare_faces = False
        #: The numbers of given materials, by identity. The materials are kept, so that their identities are not reused.
        self._given: dict[int, tuple[object, int]] = {}
        #: The numbers of textures, by the contents of their images.
        self._pictures: dict[bytes, int] = {}

    def add(self, facts: dict[str, Any], blocks: list[bytes], names: list[str]) -> int:
        """Appends the assets of a file, and returns the number of materials before it. `names` are the names of its face groups,
        the only ones that an OBJ without its material library has.
        """
        n_materials, n_textures = len(self.materials), len(self._textures)
        n_samplers, n_images = len(self._samplers), len(self._images)
        # The first name is that of no group. Groups beyond the file's materials have names only, so each gets a material
        # without looks.
        added = facts["materials"] + [{"name": name} for name in names[1 + len(facts["materials"]) :]]
        for material in added:
            for texture in _textures_in(material):
                texture["index"] += n_textures
            levels = material.get("extensions", {}).get(_LEVELS, {})
            if "ids" in levels:
                levels["ids"] = [number + n_materials for number in levels["ids"]]
        for texture in facts["textures"]:
            for holder in (texture, *texture.get("extensions", {}).values()):
                if isinstance(holder, dict) and "source" in holder:
                    holder["source"] += n_images
            if "sampler" in texture:
                texture["sampler"] += n_samplers
        for image in facts["images"]:
            content = None if "block" not in image else blocks[image["block"]]
            self._images.append((image, content))
        self.materials += added
        self._textures += facts["textures"]
        self._samplers += facts["samplers"]
        self._required += [name for name in facts["required_extensions"] if name not in self._required]
        self._keeps_bare_faces |= facts["keeps_bare_faces"]
        return n_materials

    def number_of(self, material: object) -> int:
        """The number of a given material, which is added if it is new."""
        if id(material) not in self._given:
            if isinstance(material, Material):
                gltf = gltf_of(material, self._picture)
            elif isinstance(material, Mapping):
                gltf = json.loads(json.dumps(dict(material)))
                if any(_textures_in(gltf)):
                    raise ValueError(
                        "material: textures of a dictionary are those of another file; a Material takes pictures"
                    )
            else:
                raise TypeError(f"material: a Material, or a dictionary as of glTF, not {type(material).__name__}")
            # The material is kept with its number, since the id of an object that is gone may be given to another one.
            self._given[id(material)] = material, len(self.materials)
            self.materials.append(gltf)
        return self._given[id(material)][1]

    def has_textures(self, number: int) -> bool:
        """Whether a material has textures."""
        return any(_textures_in(self.materials[number]))

    def facts(self, blocks: list[bytes]) -> dict[str, Any]:
        """All assets in the form of a scene's state; the contents of images are appended to the blocks."""
        images = []
        for image, content in self._images:
            images.append(image if content is None else {**image, "block": len(blocks)})
            blocks += [] if content is None else [content]
        return {
            "materials": self.materials,
            "textures": self._textures,
            "samplers": self._samplers,
            "images": images,
            "required_extensions": self._required,
            "keeps_bare_faces": self._keeps_bare_faces,
        }

    def _picture(self, name: str, image: object) -> int:
        """The number of the texture of an image, which is added if it is new."""
        content, kind = image_of(name, image)
        if content not in self._pictures:
            self._pictures[content] = len(self._textures)
            self._textures.append({"source": len(self._images)})
            self._images.append(({"properties": {"mimeType": kind}}, content))
        return self._pictures[content]


def _textures_in(facts: Any) -> Iterator[dict[str, Any]]:
    """The texture references of a material: the values of keys as "normalTexture", also within extensions."""
    for name, value in facts.items() if isinstance(facts, dict) else ():
        if name.endswith("Texture") and isinstance(value, dict) and "index" in value:
            yield value
        else:
            yield from _textures_in(value)
