"""Arguments as shapes: files are read, and meshes of other libraries converted."""

from __future__ import annotations

import os
from typing import Any

from chordal._blockwise.volume import BlockVolume
from chordal._cage import Cage
from chordal._curve import Curve
from chordal._foreign_meshes import mesh_of
from chordal._images import lattice_like
from chordal._load import load
from chordal._registry import registered
from chordal._shape import Shape


def shaped(name: str, thing: Any) -> Shape:
    """The shape that a thing is, or that it can be read or converted to."""
    if isinstance(thing, Shape):
        return thing
    if isinstance(thing, (Curve, Cage)):
        return thing.shape()
    if isinstance(thing, (str, os.PathLike, bytes, bytearray, memoryview)) or hasattr(thing, "read"):
        return load(thing)
    converted = mesh_of(thing)
    if converted is None:
        hint = ""
        if isinstance(thing, BlockVolume):
            hint = ": mesh it first, as in volume.mesh(iso=…)"
        elif lattice_like(thing) or hasattr(thing, "__array_interface__"):
            hint = ": chordal.volume makes one of arrays and images"
        elif callable(thing):
            hint = ": chordal.field makes one of functions"
        raise TypeError(f"{name}: a shape, a path, bytes, or a mesh of another library, not {type(thing).__name__}{hint}")
    return converted


registered.shaped = shaped
