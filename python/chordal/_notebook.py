"""Interactive views of meshes in notebooks: an HTML page in a frame, which needs no network and no other package."""

from __future__ import annotations

import base64
import html
import json
import os
from typing import TYPE_CHECKING, Any, Final

from chordal._deviation_samples import SampledDeviation, sampled_deviation
from chordal._html import columns, table
from chordal._looks import looks_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from chordal._mesh import Mesh

#: The most triangles of an interactive view; a larger mesh is a picture, since notebooks would open slowly. Chosen: about 10 MB
#: in the file.
MOST_FACES: Final = 250_000

#: The viewer's script, once it was read.
_VIEWER: Final[list[str]] = []

_PAGE = """<!doctype html><html lang="en"><meta charset="utf-8"><title>Mesh</title><style>
html,body{{margin:0;height:100%;font:13px system-ui,sans-serif;color:#24313f;background:#fff}}
#view{{position:absolute;inset:0 0 34px 0;outline-offset:-2px;touch-action:pan-y;cursor:grab}}
#view canvas{{display:block;width:100%;height:100%}}
footer{{position:absolute;inset:auto 0 0 0;height:34px;display:flex;gap:14px;align-items:center;padding:0 10px;
white-space:nowrap;overflow:hidden}} #scale{{flex:none;width:120px;height:10px;border-radius:3px}}
#hint{{opacity:.7;overflow:hidden;text-overflow:ellipsis}} label{{display:flex;gap:4px}}
@media (prefers-color-scheme:dark){{html,body{{color:#dde5ee;background:#161b21}}}}
</style><div id="view" tabindex="0" role="application" aria-label="{name}"></div>
<footer><label><input type="checkbox" id="wire"> edges</label>{scale}<span id="hint">drag to turn, with Shift to shift; + and − for nearer and farther</span></footer>
<script type="application/json" id="mesh">{data}</script><script>{script}</script></html>"""  # noqa: E501 (a page)


class Shown:
    """The view of a mesh in a notebook. `Mesh.show` returns it."""

    __slots__ = ("_html", "_mesh")

    def __init__(self, mesh: Mesh, page: str) -> None:
        self._mesh: Final = mesh
        self._html: Final = page

    def _repr_html_(self) -> str:
        return self._html

    def __repr__(self) -> str:
        return repr(self._mesh)


def _viewer() -> str | None:
    """The viewer's script; None if the package was built without it."""
    if _VIEWER:
        return _VIEWER[0]
    path = os.path.join(os.path.dirname(__file__), "viewer.js")
    try:
        with open(path, encoding="utf-8") as file:
            _VIEWER.append(file.read())
    except FileNotFoundError:
        return None
    return _VIEWER[0]


def _base64(array: NDArray[Any], kind: str) -> str:
    import numpy as np

    return base64.b64encode(np.ascontiguousarray(array, dtype=kind).tobytes()).decode()


def page_of(mesh: Mesh, *, wire: bool, deviation: SampledDeviation | None) -> str | None:
    """The page of a mesh, for a frame or a file, with the distances from another shape if there is one; None without the viewer."""
    script = _viewer()
    if script is None:
        return None
    # Relative to the middle, since single precision loses the details of a mesh far from the origin.
    middle = mesh.bounds.mean(axis=0)
    geometry = {"positions": _base64(mesh.vertices - middle, "<f4"), "faces": _base64(mesh.faces, "<u4")}
    facts: dict[str, Any] = {"wire": wire, "values": None, "range": [0.0, 1.0], "what": "", "edges": None}
    facts |= {"colors": None, "groups": None, "paints": []}
    scale = ""
    if deviation is None:
        normals, looks = mesh._vertex_rows("normal"), looks_of(mesh)
        facts |= geometry
        facts["colors"] = None if looks.colors is None else _base64(looks.colors, "<f4")
        facts["groups"] = None if looks.groups is None else _base64(looks.groups, "<u4")
        facts["paints"] = list(looks.paints)
    else:
        normals, high, caption = deviation.normals, float(deviation.values.max()) or 1.0, "off, at samples"
        facts |= {"positions": _base64(deviation.vertices - middle, "<f4"), "faces": _base64(deviation.faces, "<u4")}
        facts |= {"values": _base64(deviation.values, "<f4"), "range": [0.0, high], "what": caption, "edges": geometry}
        scale = f'<span>0</span><span id="scale"></span><span>{high:.3g} {html.escape(caption)}</span>'
    facts["normals"] = None if normals is None else _base64(normals, "<f4")
    # Escaped, so that no text in it can end the script element.
    data = json.dumps(facts).replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")
    name = html.escape(mesh._size(), quote=True)
    return _PAGE.format(name=name, scale=scale, data=data, script=script)


#: The most parts that are listed; further ones are counted. Chosen so that the table fits on a screen.
_MOST_PARTS: Final = 8


def _table(mesh: Mesh) -> str:
    rows = [("size", mesh._size()), ("bound", mesh.bound.sentence())]
    if mesh.materials:
        names = [str(material.get("name") or k) for k, material in enumerate(mesh.materials[:_MOST_PARTS])]
        rows.append(("materials", ", ".join(names)))
    mesh_table, parts = table("Mesh", rows), mesh.parts
    if len(parts) < 2:
        return mesh_table
    listed = [
        (part.name or str(k), f"{len(part.faces):,}", f"{len(part.vertices):,}") for k, part in enumerate(parts[:_MOST_PARTS])
    ]
    if len(parts) > _MOST_PARTS:
        listed.append((f"and {len(parts) - _MOST_PARTS:,} more", "", ""))
    return mesh_table + columns(f"{len(parts):,} parts", ("part", "triangles", "vertices"), listed)


def html_of(mesh: Mesh, *, wire: bool = False, against: Any = None, height: int = 380) -> str:
    """The HTML of a mesh in a notebook: an interactive frame, or a picture if there are too many triangles or no viewer."""
    summary = _table(mesh)
    if len(mesh.faces) == 0:
        return summary
    page = None
    if len(mesh.faces) <= MOST_FACES and _viewer() is not None:
        deviation = None if against is None else sampled_deviation(mesh, mesh._distances_to(against, None))
        page = page_of(mesh, wire=wire, deviation=deviation)
    if page is None:
        show: Any = {"show": "deviation", "against": against} if against is not None else {"show": "wire" if wire else "shaded"}
        picture = base64.b64encode(mesh.render(size=(640, height), **show).to_bytes("png")).decode()
        return f'<img alt="{html.escape(mesh._size(), quote=True)}" src="data:image/png;base64,{picture}">{summary}'
    frame = html.escape(page, quote=True)
    style = f"width:100%;max-width:720px;height:{height}px;border:1px solid #8884;border-radius:4px"
    title = html.escape(mesh._size(), quote=True)
    return f'<iframe sandbox="allow-scripts" title="{title}" style="{style}" srcdoc="{frame}"></iframe>{summary}'
