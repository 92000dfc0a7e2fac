"""You bring a budget, you leave with a bound.

Chordal turns shapes into triangles, and curves into straight lines. You say how much error may be seen, in units or
in pixels; what comes back says how large the error is and how that is known. How many triangles that takes is an
answer and not a question.

>>> import chordal
>>> triangle = b"v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n"
>>> mesh = chordal.load(triangle, format="obj").mesh(tol=0.01)
>>> mesh.vertices.shape, mesh.faces.shape
((3, 3), (1, 3))
>>> mesh.bound.at_most <= 0.01
True

The words of shape scripts (`box`, `sphere`, `union`, `spline`, `x`, …) are in `chordal.shapes`.
"""

from typing import TYPE_CHECKING

from chordal import shapes
from chordal._array_to_volume import labels, volume
from chordal._assembly import Placed, scene
from chordal._batch import batch
from chordal._blockwise.level_files import MeshLevel
from chordal._blockwise.tasks import Block
from chordal._blockwise.tree import Tileset
from chordal._blockwise.volume import BlockVolume, block_volume
from chordal._bound import Bound
from chordal._cage import Cage
from chordal._chordal import VERSION as __version__
from chordal._curve import Curve
from chordal._deviation import Deviation, OneSided
from chordal._errors import (
    BudgetError,
    BudgetUnmet,
    Error,
    InternalError,
    ReadError,
    Refused,
    WriteError,
)
from chordal._field import Field, Formula, field, script
from chordal._levels import Level, Levels
from chordal._load import load
from chordal._material import Material
from chordal._mesh import Mesh
from chordal._picture import Picture
from chordal._plots import ErrorCurve, plot_error
from chordal._polylines import Polyline, Polylines
from chordal._report import Report
from chordal._scene import Attribute, Node, Part
from chordal._shape import Shape
from chordal._verbs import (
    bake,
    concatenate,
    convert,
    deviation,
    difference,
    flatten,
    inspect,
    intersection,
    lod,
    mend,
    mesh,
    render,
    union,
)
from chordal._verify import verify
from chordal._view import View
from chordal._volume import Volume

__all__ = [
    "Attribute",
    "Block",
    "BlockVolume",
    "Bound",
    "BudgetError",
    "BudgetUnmet",
    "Cage",
    "Curve",
    "Deviation",
    "Error",
    "ErrorCurve",
    "Field",
    "Formula",
    "InternalError",
    "Level",
    "Levels",
    "Material",
    "Mesh",
    "MeshLevel",
    "Node",
    "OneSided",
    "Part",
    "Picture",
    "Placed",
    "Polyline",
    "Polylines",
    "ReadError",
    "Refused",
    "Report",
    "Shape",
    "Tileset",
    "View",
    "Volume",
    "WriteError",
    "__version__",
    "bake",
    "batch",
    "block_volume",
    "concatenate",
    "convert",
    "deviation",
    "difference",
    "field",
    "flatten",
    "inspect",
    "intersection",
    "labels",
    "load",
    "lod",
    "mend",
    "mesh",
    "plot_error",
    "render",
    "scene",
    "script",
    "shapes",
    "union",
    "verify",
    "volume",
]

if not TYPE_CHECKING:

    def __dir__():
        return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})

    def __getattr__(name):
        import sys

        from chordal._hints import module_hint

        raise module_hint(__name__, name, sys.modules[__name__])
