"""`load`: reads a shape from a file, an open file or bytes."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal, SupportsFloat, SupportsIndex, TypeVar, overload

from chordal import _chordal, _files
from chordal._arguments import number, warn
from chordal._errors import ReadError
from chordal._field import Field
from chordal._foreign_meshes import mesh_like
from chordal._hints import keywords_hinted
from chordal._images import lattice_like
from chordal._mesh import Mesh
from chordal._option_tables import READING
from chordal._options import options
from chordal._shape import Shape
from chordal._volume import Volume

#: A file, open or by its path, or the bytes of one.
File = str | os.PathLike[str] | bytes | bytearray | memoryview | _files.Readable

if TYPE_CHECKING:
    # The names of formats by the class that `load` returns for them.
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
    """Read a shape from a file, an open file, or bytes: triangles as a `Mesh`, samples as a `Volume`, a script as a `Field`,
    anything else as a `Shape`. Type checkers cannot know the class from a path; `kind` states it, as in
    `kind=chordal.Volume`, and a shape of another class is then a `ReadError`.

    A folder with the slices of a DICOM series is read as one `Volume`.

    `format` is an extension, as in "bpt" or "glb"; without it, the file's own extension counts, then its content.
    `unit` is the unit of the coordinates: um, mm, cm, m, km, in or ft. `up` is the axis that is up: "y" or "z".

    `strict` refuses a glTF file for any error of Khronos' validator, even if viewers accept it, and an .obj whose faces refer
    to missing normals or texture coordinates. `lenient` only warns of errors that do not affect the geometry. They exclude
    each other. `drop_nonfinite` drops vertices with numbers that are not finite, and their faces, and counts them.

    `surface` is the surface that the polygons of an .obj define; without it, they are a Catmull–Clark cage if the file has
    subdivision tags, else triangles. For a font, `text` is the text to set, as a drawing; `em` is the length of its em, by
    default 1, and `axes` has the coordinates of a variable font's axes, as in `{"wght": 700}`. `index` selects the volume,
    array or font of a file that holds several, counted from 0.

    Raises `ReadError` with the place of the error in the file, and `OSError` if the file cannot be read.

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
        strict=strict,
        lenient=lenient,
        drop_nonfinite=drop_nonfinite,
        surface=surface,
        text=text,
        em=em,
        index=index,
    )
    given += [("axis", "axes", f"{tag}={number(f'axes, {tag}', value)!r}") for tag, value in (axes or {}).items()]
    reading: _chordal.Reading = {"name": name, "options": given, "align": 0.0}
    shape = read(content, reading)
    if kind is not None and not isinstance(shape, kind):
        raise ReadError("other-kind", None, _other_kind(shape, kind), name)
    return shape


def _other_kind(shape: Shape, kind: type[Shape]) -> str:
    """The message for a shape of another class than the caller expects."""
    hint = ": mesh it, as in chordal.load(path).mesh(tol=0.01)" if kind is Mesh else ""
    return f"this holds {shape._source.kinds}, which are a {type(shape).__name__} and not a {kind.__name__}{hint}"


def _warn_of_points(source: _chordal.Source) -> None:
    """Warns of a file that has points and no triangles."""
    parts = json.loads(_chordal.scene_facts(source))["parts"]
    n_points = sum(part["vertices"] for part in parts)
    if n_points and not any(part["faces"] for part in parts):
        warn(
            f"source: {n_points:,} points and no triangles: there is no surface in this file, so that nothing of it is shown or "
            "measured; mesh.parts[0].vertices has the points"
        )


#: Files that mark a folder as samples of Zarr (versions 3 and 2) or of Neuroglancer.
_ARRAY_MARKS = ("zarr.json", ".zarray", ".zgroup", "info")


def _who_takes(source: object) -> str:
    """A hint at the function that takes a source which `load` does not."""
    if mesh_like(source):
        return ": chordal.Mesh.from_ takes meshes of other libraries"
    if lattice_like(source) or hasattr(source, "__array_interface__"):
        return ": chordal.volume takes arrays, and images of other libraries"
    if isinstance(source, (list, tuple)):
        return ": of slices of DICOM load takes their folder"
    return ""


def read(content: bytes, reading: _chordal.Reading) -> Shape:
    """The shape in some bytes, as an instance of its class."""
    source = _chordal.Source(content, reading)
    # Triangles and samples are pickled by their arrays. Other shapes are pickled by the bytes of their files, which are small.
    if source.kind == "triangles":
        _warn_of_points(source)
        return Mesh._of_source(source)
    if source.kind == "volume":
        return Volume(source)
    value = _chordal.field_of(source)
    recipe = (read, (content, reading), dict[str, Any]())
    return Shape(source, recipe) if value is None else Field(value, source, recipe)
