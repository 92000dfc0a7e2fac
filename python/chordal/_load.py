"""`load`: what a file holds; and whatever else functions take for a shape."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal, SupportsFloat, SupportsIndex, TypeVar, overload

from chordal import _chordal, _files
from chordal._arguments import number, warn
from chordal._errors import ReadError
from chordal._field import Field
from chordal._hints import keywords_hinted
from chordal._images import lattice_like
from chordal._interop import mesh_like
from chordal._mesh import Mesh
from chordal._option_tables import READING
from chordal._options import options
from chordal._shape import Shape
from chordal._volume import Volume

#: A file, open or by its path, or the bytes of one.
File = str | os.PathLike[str] | bytes | bytearray | memoryview | _files.Readable

if TYPE_CHECKING:
    # The names of formats by what `load` makes of them.
    _TriangleFormat = Literal[
        "stl", "ply", "off", "glb", "gltf", "3mf", "amf", "dae", "usdz", "usdc", "vtp", "vtu", "gii", "drc", "b3dm", "i3dm",
        "cmpt", "tileset"
    ]
    _VolumeFormat = Literal["nrrd", "npy", "npz", "nii", "hdr", "mha", "mhd", "vti", "slc"]
    _FieldFormat = Literal["star", "vm"]

Kind = TypeVar("Kind", bound=Shape)


@overload
def load(
    source: File,
    *,
    kind: type[Kind],
    format: str | None = None,
    unit: str | None = None,
    up: str | None = None,
    strict: bool = False,
    lenient: bool = False,
    drop_nonfinite: bool = False,
    surface: Literal["catmull-clark", "loop", "bilinear", "faceted"] | None = None,
    text: str | None = None,
    em: SupportsFloat | None = None,
    axes: Mapping[str, SupportsFloat] | None = None,
    index: SupportsIndex | None = None,
) -> Kind: ...
@overload
def load(
    source: File,
    *,
    kind: None = None,
    format: _VolumeFormat,
    unit: str | None = None,
    up: str | None = None,
    strict: bool = False,
    lenient: bool = False,
    index: SupportsIndex | None = None,
) -> Volume: ...
@overload
def load(
    source: File,
    *,
    kind: None = None,
    format: _FieldFormat,
    unit: str | None = None,
    up: str | None = None,
    strict: bool = False,
    lenient: bool = False,
) -> Field: ...
@overload
def load(
    source: File,
    *,
    kind: None = None,
    format: _TriangleFormat,
    unit: str | None = None,
    up: str | None = None,
    strict: bool = False,
    lenient: bool = False,
    drop_nonfinite: bool = False,
    surface: None = None,
) -> Mesh: ...
@overload
def load(
    source: File,
    *,
    kind: None = None,
    format: str | None = None,
    unit: str | None = None,
    up: str | None = None,
    strict: bool = False,
    lenient: bool = False,
    drop_nonfinite: bool = False,
    surface: Literal["catmull-clark", "loop", "bilinear", "faceted"] | None = None,
    text: str | None = None,
    em: SupportsFloat | None = None,
    axes: Mapping[str, SupportsFloat] | None = None,
    index: SupportsIndex | None = None,
) -> Shape: ...
@keywords_hinted
def load(
    source: File,
    *,
    kind: type[Kind] | None = None,
    format: str | None = None,
    unit: str | None = None,
    up: str | None = None,
    strict: bool = False,
    lenient: bool = False,
    drop_nonfinite: bool = False,
    surface: Literal["catmull-clark", "loop", "bilinear", "faceted"] | None = None,
    text: str | None = None,
    em: SupportsFloat | None = None,
    axes: Mapping[str, SupportsFloat] | None = None,
    index: SupportsIndex | None = None,
) -> Shape:
    """Read a shape from a file, from an open one, or from the bytes of one: triangles as a `Mesh`, samples as a `Volume`, a script as a
    `Field`, anything else as a `Shape`. Which of them it is no type checker knows of a path; `kind` says it, as in
    `kind=chordal.Volume`, and what is of another class is a `ReadError` then.

    A folder is read where it holds the slices of a series of DICOM: as one `Volume`.

    `format` is an extension, as in "bpt" or "glb"; without it the file's own extension counts, then its content.
    `unit` is the unit of the coordinates: um, mm, cm, m, km, in or ft. `up` is the axis that is up: "y" or "z".
    `strict` refuses a glTF file for anything that Khronos' validator calls an error, also for what viewers accept,
    and an .obj whose faces name normals or texture coordinates that it does not have; `lenient` only warns of what is
    wrong without touching its geometry; not both. `drop_nonfinite` drops vertices that are not finite numbers, with
    their faces, and counts them. `surface` is what the polygons of an .obj stand for; without it they are a
    Catmull–Clark cage where the file has subdivision tags, else triangles. `text` is what a font sets, as a drawing;
    `em` is the length of its em, 1 unless said, and `axes` says where axes of a variable font are, as in
    `{"wght": 700}`. `index` is the volume, array or font to read of a file that holds several, counted from 0.

    Raises `ReadError` with the place where the bytes are wrong, and `OSError` where there are none to read.

    >>> import chordal
    >>> chordal.load(b"v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n", format="obj", kind=chordal.Mesh)
    <Mesh: 1 triangle, 3 vertices, from obj>
    """
    if strict and lenient:
        raise ValueError("strict and lenient: one of them")
    if kind is not None and not isinstance(kind, type):
        raise TypeError(f"kind: a class, as in kind=chordal.Mesh, not {kind!r}")
    name = None
    if isinstance(source, (bytes, bytearray, memoryview)):
        content = bytes(source)
    elif isinstance(source, (str, os.PathLike)):
        if os.path.isdir(source) and any(os.path.exists(os.path.join(source, mark)) for mark in _ARRAY_MARKS):
            raise TypeError(f"source: {_files.shown(source)} is a volume on disk: chordal.block_volume reads it block by block")
        listed = os.path.join(source, "tileset.json")
        if os.path.isdir(source) and os.path.isfile(listed):
            name, content = _files.shown(listed), _files.read(listed)
        elif os.path.isdir(source):
            name, content = _files.slices_of(source)
            format = format or "dicom"
        else:
            name, content = _files.shown(source), _files.read(source)
    elif hasattr(source, "read"):
        name, content = _files.read_open(source)
    else:
        raise TypeError(f"source: a path, an open file or bytes, not {type(source).__name__}{_who_takes(source)}")
    if text is None and (em is not None or axes is not None):
        raise ValueError("em, axes: they are for the text that a font sets; add text=")
    given = options(
        READING,
        format=format,
        unit=unit,
        up=up,
        strict=bool(strict),
        lenient=bool(lenient),
        drop_nonfinite=bool(drop_nonfinite),
        surface=surface,
        text=text,
        em=em,
        index=index,
    )
    given += [("axis", "axes", f"{tag}={number(f'axes, {tag}', value)!r}") for tag, value in (axes or {}).items()]
    reading: _chordal.Reading = {"name": name, "options": given, "align": 0.0}
    found = read(content, reading)
    if kind is not None and not isinstance(found, kind):
        raise ReadError("other-kind", None, _other_kind(found, kind), name)
    return found


def _other_kind(found: Shape, kind: type[Shape]) -> str:
    """What is said of a shape that is of another class than was asked for."""
    way = ": mesh it, as in chordal.load(path).mesh(tol=0.01)" if kind is Mesh else ""
    return f"this holds {found._source.kinds}, which are a {type(found).__name__} and not a {kind.__name__}{way}"


def _warn_of_points(source: _chordal.Source) -> None:
    """Says it where a file holds points and nothing between them."""
    parts = json.loads(_chordal.scene_facts(source))["parts"]
    n_points = sum(part["vertices"] for part in parts)
    if n_points and not any(part["faces"] for part in parts):
        warn(
            f"source: {n_points:,} points and no triangles: there is no surface in this file, so that nothing of it is shown or "
            "measured; mesh.parts[0].vertices has the points"
        )


#: Files by which a folder is known as samples of Zarr (versions 3 and 2) or of Neuroglancer.
_ARRAY_MARKS = ("zarr.json", ".zarray", ".zgroup", "info")


def _who_takes(source: object) -> str:
    """Which function takes what `load` does not."""
    if mesh_like(source):
        return ": chordal.Mesh.from_ takes meshes of other libraries"
    if lattice_like(source) or hasattr(source, "__array_interface__"):
        return ": chordal.volume takes arrays, and images of other libraries"
    if isinstance(source, (list, tuple)):
        return ": of slices of DICOM load takes their folder"
    return ""


def read(content: bytes, reading: _chordal.Reading) -> Shape:
    """The shape of some bytes, of the class for what it is."""
    source = _chordal.Source(content, reading)
    # Triangles and samples are pickled as they are; what else there is is small, and its bytes are kept for that.
    if source.kind == "triangles":
        _warn_of_points(source)
        return Mesh._of_source(source)
    if source.kind == "volume":
        return Volume(source)
    value = _chordal.field_of(source)
    recipe = (read, (content, reading), dict[str, Any]())
    return Shape(source, recipe) if value is None else Field(value, source, recipe)
