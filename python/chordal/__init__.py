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
"""

from chordal._bound import Bound
from chordal._chordal import VERSION as __version__
from chordal._curve import Curve, bezier
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
from chordal._mesh import Mesh
from chordal._polylines import Polyline, Polylines
from chordal._shape import Shape, load, triangles
from chordal._view import View

__all__ = [
    "Bound",
    "BudgetError",
    "BudgetUnmet",
    "Curve",
    "Deviation",
    "Error",
    "InternalError",
    "Mesh",
    "OneSided",
    "Polyline",
    "Polylines",
    "ReadError",
    "Refused",
    "Shape",
    "View",
    "WriteError",
    "__version__",
    "bezier",
    "load",
    "triangles",
]
