"""The options of the command by keyword, each with the form of its values. Written from the tables in
`crates/chordal-verbs/src/options` by `CHORDAL_WRITE_OPTIONS=1 cargo test -p chordal-verbs --test all options`."""

from __future__ import annotations

from typing import Final

READING: Final[dict[str, tuple[str, str]]] = {
    "format": ("from", "text"),
    "unit": ("unit", "text"),
    "up": ("up", "text"),
    "index": ("index", "count"),
    "text": ("text", "text"),
    "em": ("em", "number"),
    "axes": ("axis", "text"),
    "surface": ("surface", "word"),
    "strict": ("strict", "flag"),
    "lenient": ("lenient", "flag"),
    "drop_nonfinite": ("drop-nonfinite", "flag"),
}

OUTPUT: Final[dict[str, tuple[str, str]]] = {
    "compress": ("compress", "word"),
    "quantize": ("quantize", "flag"),
    "no_source": ("no-source", "flag"),
}

REPAIRS: Final[dict[str, tuple[str, str]]] = {
    "all": ("all", "flag"),
    "weld": ("weld", "length"),
    "drop_duplicates": ("drop-duplicates", "word"),
    "drop_degenerate": ("drop-degenerate", "flag"),
    "resolve_t_junctions": ("resolve-t-junctions", "length"),
    "split_nonmanifold": ("split-nonmanifold", "flag"),
    "orient": ("orient", "flag"),
    "nested": ("nested", "word"),
    "fill_holes": ("fill-holes", "count"),
    "drop_unused": ("drop-unused", "flag"),
}

MESH: Final[dict[str, tuple[str, str]]] = {
    "tol": ("tol", "length"),
    "pixels": ("px", "number"),
    "view": ("view", "text"),
    "angle": ("angle", "number"),
    "uv_error": ("uv-error", "number"),
    "normal_error": ("normal-error", "number"),
    "triangles": ("triangles", "count"),
    "segments": ("segments", "count"),
    "require": ("require", "word"),
    "spacing": ("spacing", "word"),
    "effort": ("effort", "word"),
    "within": ("within", "time"),
    "extrude": ("extrude", "length"),
    "bevel": ("bevel", "length"),
}

LOD: Final[dict[str, tuple[str, str]]] = {
    "pixels": ("px", "number"),
    "view": ("view", "text"),
    "nearest": ("nearest", "number"),
    "tol": ("tol", "length"),
    "uv_error": ("uv-error", "number"),
    "normal_error": ("normal-error", "number"),
    "distances": ("distances", "text"),
    "errors": ("errors", "word"),
    "tile_triangles": ("tile-triangles", "count"),
    "merge": ("merge", "flag"),
    "at": ("at", "text"),
    "normals": ("normals", "text"),
}

SURFACE: Final[dict[str, tuple[str, str]]] = {
    "iso": ("iso", "number"),
    "inside": ("inside", "word"),
    "labels": ("labels", "text"),
    "smooth": ("smooth", "text"),
    "border": ("open", "flag"),
}

BAKE: Final[dict[str, tuple[str, str]]] = {
    "cells": ("cells", "count"),
    "tol": ("tol", "length"),
    "band": ("band", "number"),
    "bound": ("bound", "flag"),
}

DEVIATION: Final[dict[str, tuple[str, str]]] = {
    "max": ("max", "length"),
    "relative": ("relative", "number"),
    "absolute": ("absolute", "length"),
}

PICTURE: Final[dict[str, tuple[str, str]]] = {
    "show": ("show", "word"),
    "darkest": ("darkest", "length"),
    "cull": ("cull", "word"),
    "size": ("size", "text"),
    "view": ("view", "text"),
    "tol": ("tol", "length"),
    "pixels": ("px", "number"),
}
