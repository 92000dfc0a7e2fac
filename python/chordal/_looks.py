"""The colours of a mesh in a notebook: those of its vertices, of its materials, or one for each part."""

from __future__ import annotations

import colorsys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from chordal._mesh import Mesh

#: The colour of triangles without a material.
PLAIN: Final = "#9fb4cf"
#: The step between hues. Defined: the golden section, which keeps any number of hues apart on their circle.
_STEP: Final = 0.6180339887498949
#: The end of sRGB's linear segment. Defined by IEC 61966-2-1.
_LINEAR_TO: Final = 0.0031308


@dataclass(frozen=True)
class Looks:
    """Colours of vertices, or a group for each triangle and the colour of each group; all None or empty for a plain mesh."""

    colors: NDArray[Any] | None = None
    groups: NDArray[Any] | None = None
    paints: tuple[str, ...] = ()


def looks_of(mesh: Mesh) -> Looks:
    """The colours of a mesh."""
    import numpy as np

    parts, order = mesh.parts, _parts_in_order(mesh)
    if order is None:
        return Looks()
    by_material = [_materials_of(parts[k]) for k in order]
    if mesh.materials and any(np.any(rows) for rows in by_material):
        return Looks(groups=np.concatenate(by_material), paints=(PLAIN, *map(_paint, mesh.materials)))
    colors = mesh._vertex_rows("color")
    if colors is not None:
        return Looks(colors=colors[:, :3])
    # Without colours of their own, several parts are told apart by hues.
    if len(parts) < 2:
        return Looks()
    paints = tuple(_hex(colorsys.hls_to_rgb(k * _STEP % 1, 0.62, 0.5)) for k in range(len(parts)))
    return Looks(groups=np.concatenate([np.full(len(parts[k].faces), k) for k in order]), paints=paints)


def _parts_in_order(mesh: Mesh) -> list[int] | None:
    """The parts of nodes, in the order of the mesh's triangles; None if the numbers of triangles do not match."""
    nodes, order, stack = mesh.nodes, list[int](), list(reversed(mesh.roots))
    while stack:
        node = nodes[stack.pop()]
        if node.part is not None:
            order.append(node.part)
        stack += reversed(node.children)
    counts = [facts["faces"] for facts in mesh._scene["parts"]]
    return order if sum(counts[k] for k in order) == len(mesh.faces) else None


def _materials_of(part: Any) -> NDArray[Any]:
    """The number of each triangle's material, counted from 1; 0 if it has none."""
    import numpy as np

    materials = part.attribute("group", "material")
    if materials is None or materials.domain != "face":
        return np.zeros(len(part.faces), dtype=np.int64)
    return np.asarray(materials.values).reshape(-1).astype(np.int64)


def _paint(material: dict[str, Any]) -> str:
    """The colour of a material in sRGB; white if it has none."""
    linear = material.get("pbrMetallicRoughness", {}).get("baseColorFactor", (1, 1, 1, 1))[:3]
    return _hex([12.92 * x if x <= _LINEAR_TO else 1.055 * x ** (1 / 2.4) - 0.055 for x in linear])


def _hex(color: Any) -> str:
    return "#" + "".join(f"{round(255 * min(max(x, 0.0), 1.0)):02x}" for x in color)
