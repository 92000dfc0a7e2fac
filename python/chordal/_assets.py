"""`Assets`: the materials of a scene that is made, with what they need."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

from chordal._material import Material, gltf_of, image_of

#: The extension of glTF by which materials name others that stand for them far away.
_LEVELS = "MSFT_lod"


class Assets:
    """Materials, textures, samplers and images, as glTF has them: each list names others by their numbers."""

    def __init__(self) -> None:
        self.materials: list[dict[str, Any]] = []
        self._textures: list[dict[str, Any]] = []
        self._samplers: list[Any] = []
        self._images: list[tuple[dict[str, Any], bytes | None]] = []
        self._required: list[str] = []
        self._keeps_bare_faces = False
        #: The numbers of materials and pictures that were given; what has a number is kept, so that no other is taken for it.
        self._given: dict[int, tuple[object, int]] = {}
        self._pictures: dict[bytes, int] = {}

    def add(self, facts: dict[str, Any], blocks: list[bytes], names: list[str]) -> int:
        """Adds those of a file after those that are there, and says how many materials these were. `names` are those of the
        groups of its faces: of an OBJ without its library there is nothing else.
        """
        n_materials, n_textures = len(self.materials), len(self._textures)
        n_samplers, n_images = len(self._samplers), len(self._images)
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
        """The number of a material that was given; a new one is added."""
        if id(material) not in self._given:
            if isinstance(material, Material):
                found = gltf_of(material, self._picture)
            elif isinstance(material, Mapping):
                found = json.loads(json.dumps(dict(material)))
                if any(_textures_in(found)):
                    raise ValueError(
                        "material: textures of a dictionary are those of another file; a Material takes pictures"
                    )
            else:
                raise TypeError(f"material: a Material, or a dictionary as of glTF, not {type(material).__name__}")
            self._given[id(material)] = material, len(self.materials)
            self.materials.append(found)
        return self._given[id(material)][1]

    def has_textures(self, number: int) -> bool:
        """Whether a material has pictures."""
        return any(_textures_in(self.materials[number]))

    def facts(self, blocks: list[bytes]) -> dict[str, Any]:
        """All of it as the state of a scene has it; the images are put behind the blocks."""
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
        """The texture of a picture."""
        content, kind = image_of(name, image)
        if content not in self._pictures:
            self._pictures[content] = len(self._textures)
            self._textures.append({"source": len(self._images)})
            self._images.append(({"properties": {"mimeType": kind}}, content))
        return self._pictures[content]


def _textures_in(facts: Any) -> Iterator[dict[str, Any]]:
    """Where a material names textures: below keys as "normalTexture", also those of extensions."""
    for name, value in facts.items() if isinstance(facts, dict) else ():
        if name.endswith("Texture") and isinstance(value, dict) and "index" in value:
            yield value
        else:
            yield from _textures_in(value)
