"""The verbs as functions, of shapes or files."""

from __future__ import annotations

import functools
import inspect as _inspect
import os
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, Concatenate, Literal, ParamSpec, TypeVar

from chordal._blockwise.volume import BlockVolume
from chordal._budget import Length, Share, Time
from chordal._cage import Cage
from chordal._combine import one_by_one
from chordal._curve import Curve
from chordal._foreign_meshes import mesh_of
from chordal._images import lattice_like
from chordal._load import File, load
from chordal._mesh import Mesh
from chordal._pieces import joined
from chordal._registry import registered
from chordal._shape import Progress, Shape

P = ParamSpec("P")
R = TypeVar("R")

if TYPE_CHECKING:
    #: A shape, a curve, a cage, a file, the bytes of one, or a mesh of another library (see `Mesh.from_`).
    _Shaped = Shape | File | Any


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


def _verb(
    method: Callable[Concatenate[Shape, P], R],
) -> Callable[[Callable[..., object]], Callable[Concatenate[_Shaped, P], R]]:
    """Decorates a function so that it calls a method of shapes. It keeps its name and docstring, and takes the signature of the
    method, also for type checkers.
    """

    def of_shape(title: Callable[..., object]) -> Callable[Concatenate[_Shaped, P], R]:
        @functools.wraps(title)
        def verb(shape: _Shaped, *args: P.args, **named: P.kwargs) -> R:
            # By its name, since a subclass may override the method.
            result: R = getattr(shaped("shape", shape), method.__name__)(*args, **named)
            return result

        method_signature = _inspect.signature(method)
        first = _inspect.Parameter("shape", _inspect.Parameter.POSITIONAL_ONLY)
        signature = method_signature.replace(parameters=[first, *list(method_signature.parameters.values())[1:]])
        verb.__signature__ = signature  # type: ignore[attr-defined]
        verb.__module__ = "chordal"
        if ">>>" not in (title.__doc__ or ""):
            # The examples are tested with the method itself.
            verb.__doc__ = f"{title.__doc__}\n\n{_without_examples(method)}"
        return verb  # type: ignore[return-value]

    return of_shape


def _without_examples(method: Callable[..., object]) -> str:
    return _inspect.cleandoc(method.__doc__ or "").split(">>>")[0].rstrip()


@_verb(Shape.mesh)
def mesh() -> None:
    """`Shape.mesh` of a shape, a file, or the bytes of one."""


@_verb(Shape.flatten)
def flatten() -> None:
    """`Shape.flatten` of a shape, a file, or the bytes of one."""


@_verb(Shape.lod)
def lod() -> None:
    """`Shape.lod` of a shape, a file, or the bytes of one."""


@_verb(Shape.inspect)
def inspect() -> None:
    """`Shape.inspect` of a shape, a file, or the bytes of one."""


@_verb(Shape.mend)
def mend() -> None:
    """`Shape.mend` of a shape, a file, or the bytes of one."""


@_verb(Shape.bake)
def bake() -> None:
    """`Shape.bake` of a shape, a file, or the bytes of one."""


@_verb(Shape.render)
def render() -> None:
    """`Shape.render` of a shape, a file, or the bytes of one."""


@_verb(Shape.deviation)
def deviation() -> None:
    """The distance between two shapes, in both directions: `Shape.deviation`, of shapes or files. Raises as that does.

    >>> import chordal
    >>> triangle = chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    >>> lifted = chordal.Mesh([(0, 0, 2), (1, 0, 2), (0, 1, 2)], [(0, 1, 2)])
    >>> chordal.deviation(triangle, lifted, max=3).verdict
    'within'
    """


@_verb(Shape.export)
def convert() -> None:
    """Write a shape, or a file, unchanged in the format that the extension of `path` names: `Shape.export`.

    Nothing is simplified, and the report lists data that the format cannot store. Shapes that are no meshes need a budget: `mesh`.

    Raises `WriteError` if the format cannot store the shape, `Refused` for shapes that have to be meshed first, and `OSError`
    for errors of the disk.

    >>> import chordal, tempfile, os
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     report = chordal.convert(b"v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n", os.path.join(folder, "one.stl"))
    >>> report["certificate"]["bound"]["at_most"]
    0.0
    """


def union(
    first: _Shaped,
    /,
    *others: _Shaped,
    tol: Length | None = None,
    rel: Share | None = None,
    within: Time | None = None,
    progress: Progress | None = None,
) -> Mesh:
    """The union of solids, given one by one or as a list, as one closed mesh: `Shape.combine`.

    Shapes that are not closed triangles need `tol` or `rel`. Raises as `Shape.combine`.

    >>> import chordal
    >>> corners = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    >>> quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    >>> cube = chordal.Mesh(corners, [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))])
    >>> moved = chordal.Mesh(cube.vertices + 0.5, cube.faces)
    >>> chordal.union(cube, moved).volume
    1.875
    """
    return _combined("union", first, others, tol=tol, rel=rel, within=within, progress=progress)


def difference(
    first: _Shaped,
    /,
    *others: _Shaped,
    tol: Length | None = None,
    rel: Share | None = None,
    within: Time | None = None,
    progress: Progress | None = None,
) -> Mesh:
    """The difference of a solid and others, as one closed mesh: `Shape.combine`.

    Shapes that are not closed triangles need `tol` or `rel`. Raises as `Shape.combine`.

    >>> import chordal
    >>> corners = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    >>> quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    >>> cube = chordal.Mesh(corners, [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))])
    >>> moved = chordal.Mesh(cube.vertices + 0.5, cube.faces)
    >>> chordal.difference(cube, moved).volume
    0.875
    """
    return _combined("difference", first, others, tol=tol, rel=rel, within=within, progress=progress)


def intersection(
    first: _Shaped,
    /,
    *others: _Shaped,
    tol: Length | None = None,
    rel: Share | None = None,
    within: Time | None = None,
    progress: Progress | None = None,
) -> Mesh:
    """The intersection of solids, as one closed mesh: `Shape.combine`.

    Shapes that are not closed triangles need `tol` or `rel`. Raises as `Shape.combine`.

    >>> import chordal
    >>> corners = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    >>> quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    >>> cube = chordal.Mesh(corners, [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))])
    >>> moved = chordal.Mesh(cube.vertices + 0.5, cube.faces)
    >>> chordal.intersection(cube, moved).volume
    0.125
    """
    return _combined("intersection", first, others, tol=tol, rel=rel, within=within, progress=progress)


def concatenate(meshes: Iterable[Shape | Any] | Shape, /, *more: Shape | Any) -> Mesh:
    """The triangles of meshes, files or meshes of other libraries as one part. The meshes are given as a list or one by one.
    Nothing is cut or merged: `union` combines solids to one closed mesh.

    Normals, texture coordinates and colours are kept if every mesh has them for its vertices. Materials are dropped with a
    `UserWarning`; `scene` keeps them. The bound is the largest of all. Raises `ValueError` if units differ, or if there is no
    mesh.

    >>> import chordal
    >>> one = chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    >>> both = chordal.concatenate([one, one.translate(0, 0, 1)])
    >>> both.faces.tolist(), len(both.split())
    ([[0, 1, 2], [3, 4, 5]], 2)
    """
    things = [meshes, *more] if more or isinstance(meshes, Shape) else meshes
    shapes = [shaped("meshes", thing) for thing in things]
    given = [shape for shape in shapes if isinstance(shape, Mesh)]
    if len(given) < len(shapes):
        other = next(shape for shape in shapes if not isinstance(shape, Mesh))
        raise TypeError(f"meshes: triangles, not {other._source.kinds}: mesh them first")
    return joined(given)


def _combined(
    operation: Literal["union", "difference", "intersection"],
    first: _Shaped,
    others: tuple[_Shaped, ...],
    *,
    tol: Length | None,
    rel: Share | None,
    within: Time | None,
    progress: Progress | None,
) -> Mesh:
    first_shape, *more = one_by_one((first, *others))
    steps = [(operation, shaped("others", other)) for other in more]
    return shaped("first", first_shape).combine(*steps, tol=tol, rel=rel, within=within, progress=progress)
