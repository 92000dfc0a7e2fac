"""What modules use of modules above them, as `Shape.mesh` uses the class `Mesh`: each entry is made where its value is defined."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from chordal._cage import Cage
    from chordal._field import Field
    from chordal._mesh import Mesh
    from chordal._shape import Shape
    from chordal._volume import Volume


class Registry:
    """The entries, all of them there once the package is imported.

    A `Mesh` is a `Shape`, and `Shape.mesh` returns a `Mesh`: whichever of their modules is below the other cannot import it.
    """

    #: The class `Mesh`.
    mesh: type[Mesh]
    #: The class `Field`.
    field: type[Field]
    #: The class `Volume`.
    volume: type[Volume]
    #: The class `Cage`.
    cage: type[Cage]
    #: The signed distance to the triangles of a mesh.
    field_of_mesh: Callable[[Mesh], Field]
    #: The mesh of an object of another library; None if the object is no mesh.
    mesh_of: Callable[..., Mesh | None]
    #: The shape that an argument, given by its name and value, is or can be read or converted to.
    shaped: Callable[[str, Any], Shape]
    #: The names in `chordal.shapes`.
    words: frozenset[str]


#: The only registry.
registered: Final = Registry()
