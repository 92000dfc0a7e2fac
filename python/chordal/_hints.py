"""Hints for guessed names and keywords: equivalents of names of other libraries."""

from __future__ import annotations

import difflib
import functools
import inspect
import types
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from chordal._guessed_names import NOUNS
from chordal._registry import registered

P = ParamSpec("P")
R = TypeVar("R")

#: Keywords of other libraries, by their equivalents here.
_KEYWORDS: dict[str, tuple[str, ...]] = {
    "triangles=": ("faces", "n_faces", "face_count", "target_count", "target_number_of_triangles", "max_triangles")
    + ("max_faces", "count", "n_triangles", "num_faces"),
    "tol=": ("tolerance", "error", "max_error", "target_error", "deflection", "linear_deflection", "epsilon", "eps")
    + ("precision", "absolute", "max_deviation"),
    "rel=": ("relative", "relative_error"),
    "angle=": ("angular_deflection", "angular_tolerance", "feature_angle"),
    "iso=": ("level", "isovalue", "threshold", "isosurface", "isosurfaces", "value", "iso_value", "isolevel"),
    "cells=": ("resolution", "grid", "n_cells", "divisions"),
    "spacing=": ("voxel_size", "voxelsize", "pitch", "resolution", "voxel_spacing", "scale"),
    "format=": ("file_type", "filetype", "ext", "extension", "file_format"),
    "unit=": ("units",),
    "radius": ("r",),
    "height": ("h", "length"),
    "size=": ("width", "window_size", "image_size", "resolution"),
    "view=": ("camera", "camera_position", "cpos"),
    "weld=": ("merge", "merge_vertices", "process"),
    "fill_holes=": ("fillholes", "holes", "hole_size"),
    "drop_duplicates=": ("remove_duplicates",),
    "drop_unused=": ("remove_unreferenced",),
    "labels=": ("label", "segments"),
    "smooth=": ("smooth_sigma", "sigma", "smoothing"),
    "bounds=": ("bbox", "box", "extent", "region", "domain"),
    "gradient=": ("grad", "derivative"),
    "colors=": ("color", "vertex_colors", "rgb"),
    "normals=": ("vertex_normals", "normal"),
    "faces": ("triangles",),
    "compress=": ("draco", "compression"),
    "at=": ("translation", "matrix", "transform", "position"),
    "metallic=": ("metalness", "metallicFactor"),
    "roughness=": ("roughnessFactor",),
    "color=": ("baseColorFactor", "diffuse", "base_color"),
    "absolute=": ("tol", "tolerance", "error"),
    "within=": ("timeout", "time_limit", "max_time", "max_seconds", "deadline"),
    "distances=": ("lod_distances", "switch_distances"),
}


#: Keywords of other libraries without a single equivalent: keywords, an argument that the function must have, and the hint.
_ANSWERS: tuple[tuple[tuple[str, ...], str, str], ...] = (
    (
        ("ratio", "percent", "fraction", "target_reduction", "keep", "reduction"),
        "triangles",
        "say how many, as in triangles=len(mesh.faces) // 10",
    ),
    (
        ("levels", "ratios", "lods", "n_levels", "count", "triangles", "faces"),
        "tile_triangles",
        "levels are those that a screen can tell apart; for your own, [shape.mesh(triangles=n) for n in counts]",
    ),
    (
        ("tol", "rel", "triangles", "pixels", "view", "iso", "angle", "normals", "quantize", "cells", "spacing", "size")
        + ("weld", "orient", "fill_holes", "format", "tolerance", "error", "resolution", "unit", "px"),
        "options",
        'what the verb is told stands in options, as in options={"tol": 0.1}',
    ),
    (
        ("resolution", "step", "cell_size", "element_size", "pitch", "voxel_size"),
        "triangles",
        "say how far it may be off, as in tol=0.01, or how many there are, as in triangles=5000",
    ),
    (("opacity", "transparency"), "cutoff", 'the fourth number of color, with alpha="blend"'),
    (("ascii", "binary"), "quantize", "STL and PLY are written in binary"),
    (("background", "azimuth", "elevation"), "view", 'view= says from where, as in view="640x480 fov=30 eye=3,2,2"'),
    (("names",), "only", "labels are called by their numbers; only= takes some of them"),
    (("labels",), "executor", "volume.labels() has a mesh for each"),
    (("angle", "theta"), "degrees", "here it is degrees="),
)


def found_hint(owner: str, name: str) -> str | None:
    """The equivalent here of a name of another library; None if there is none."""
    tables = NOUNS.get(owner, ())
    hint = next((table[name] for table in tables if name in table), None)
    if hint is None and owner == "Field":
        # Operations of scripts are functions of `chordal.shapes`, not methods.
        hint = f"chordal.shapes.{name}(…)" if name in registered.words else None
    return hint


def no_attribute(owner: str, title: str, name: str, thing: object) -> AttributeError:
    """The error for a missing attribute, with a hint if there is one."""
    sentence = f"{title} has no attribute {name!r}"
    if not name.startswith("_"):
        hint = found_hint(owner, name)
        if hint is None:
            # Only names with the same beginning are compared: `hasattr` discards the message, and should not wait for it.
            owned = thing if isinstance(thing, (type, types.ModuleType)) else type(thing)
            near = difflib.get_close_matches(name, [other for other in _names_in(owned) if other[:3] == name[:3]], 1)
            hint = f"is {near[0]} meant?" if near else None
        sentence += "" if hint is None else f": {hint}"
    return AttributeError(sentence)


#: The names in classes and modules, by identity, computed once.
_OWN_NAMES: dict[int, list[str]] = {}


def _names_in(owner: object) -> list[str]:
    # Classes and modules are never freed, so their identities stay valid.
    if id(owner) not in _OWN_NAMES:
        _OWN_NAMES[id(owner)] = dir(owner)
    return _OWN_NAMES[id(owner)]


def owner_of(kind: type) -> str:
    """The name of the first class in the inheritance order that has a table of hints."""
    return next((base.__name__ for base in kind.__mro__ if base.__name__ in NOUNS), "")


class Guessed:
    """A base of classes whose errors for missing attributes have hints. Type checkers do not see the method, and so still refuse
    such names.
    """

    __slots__ = ()

    if not TYPE_CHECKING:

        def __getattr__(self, name):
            kind = type(self)
            if any(name in base.__dict__ for base in kind.__mro__):
                # The attribute exists, and its property raised an AttributeError: raise that one again.
                return object.__getattribute__(self, name)
            raise no_attribute(owner_of(kind), kind.__name__, name, self)


class GuessedType(type):
    """The same for attributes of a class itself, as in `Mesh.from_trimesh`."""

    if not TYPE_CHECKING:

        def __getattr__(cls, name):
            raise no_attribute(owner_of(cls), f"type object {cls.__name__}", name, cls)


def keywords_hinted(function: Callable[P, R]) -> Callable[P, R]:
    """Wraps a function so that its errors for unknown keywords have hints."""
    parameters = inspect.signature(function).parameters.values()
    by_kind = {kind: [p.name for p in parameters if p.kind is kind] for kind in inspect._ParameterKind}
    kinds = inspect.Parameter
    if by_kind[kinds.VAR_KEYWORD]:
        return function
    positional, named_only = by_kind[kinds.POSITIONAL_OR_KEYWORD], by_kind[kinds.KEYWORD_ONLY]
    known = frozenset(positional + named_only) - {"self"}
    most = len(positional) + len(by_kind[kinds.POSITIONAL_ONLY])
    needed = [p.name for p in parameters if p.name in positional and p.default is p.empty]
    is_counted = bool(named_only) and not by_kind[kinds.VAR_POSITIONAL]

    @functools.wraps(function)
    def hinted(*args: P.args, **named: P.kwargs) -> R:
        if not named.keys() <= known:
            unknown = next(name for name in named if name not in known)
            raise TypeError(f"{_title(function)}() has no argument {unknown!r}: {meant_keyword(unknown, known)}")
        if is_counted and len(args) > most:
            raise TypeError(f"{_title(function)}() takes these by name: " + ", ".join(f"{name}=" for name in named_only))
        title = _title(function)
        if len(args) < len(needed) and title in _MAKERS and not named.keys() >= set(needed[len(args) :]):
            raise TypeError(f"{title}() needs {' and '.join(needed[1:])}: {_MAKERS[title]}")
        return function(*args, **named)

    return hinted


def _title(function: Callable[..., Any]) -> str:
    return function.__qualname__.removesuffix(".__init__").rpartition(".")[2]


#: The functions that create instances, for callers of a class.
_MAKERS: dict[str, str] = {
    "Mesh": "Mesh(vertices, faces) takes arrays; chordal.load reads files, chordal.Mesh.from_ takes meshes of other libraries",
    "Volume": "chordal.volume(array, spacing=…) makes it, chordal.load of a file, and .bake of another shape",
    "Field": "chordal.field(function, bounds=…) makes it, chordal.script of a text, and the words of chordal.shapes",
    "Curve": "the functions of chordal.shapes make it: bezier, spline, nurbs, arc, fit",
    "Formula": "chordal.shapes.x, y and z are formulas, and what is computed of them",
    "Shape": "chordal.load(path) makes it",
}


def refuse_own(made: object, given: object, wanted: type) -> None:
    """Raises `TypeError` if a user calls a class whose instances come from functions, and names these functions."""
    if not isinstance(given, wanted):
        title = type(made).__name__
        raise TypeError(f"{title} is not made of {type(given).__name__}: {_MAKERS.get(title, _MAKERS['Shape'])}")


def hint_keywords_of(kind: type) -> None:
    """The same for the keywords of a dataclass."""
    kind.__init__ = keywords_hinted(kind.__init__)  # type: ignore[misc]


def meant_keyword(wrong: str, known: Iterable[str]) -> str:
    """A hint for an unknown keyword, among the `known` ones of a function."""
    names = sorted(known)
    for words, needed, answer in _ANSWERS:
        if wrong in words and needed in known:
            return answer
    for keyword, others in _KEYWORDS.items():
        if wrong in others and keyword.rstrip("=") in names:
            return f"here it is {keyword}"
    near = difflib.get_close_matches(wrong, names, 1)
    return f"is {near[0]}= meant?" if near else "it has " + ", ".join(f"{name}=" for name in names)


def module_hint(module: str, name: str, thing: object) -> AttributeError:
    """The error for a missing name of a module, with a hint if there is one."""
    if module == "chordal" and name in registered.words:
        return AttributeError(f"{module} has no attribute {name!r}: chordal.shapes.{name}")
    return no_attribute(module, module, name, thing)
