"""The functions of shape scripts, by the same names: the text of a script also runs in Python.

The page on shape scripts describes each of them, and the quality of its value as a distance. Written from
the table in `crates/chordal-script/src/language` by
`CHORDAL_WRITE_LANGUAGE=1 cargo test -p chordal-script --test written`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, SupportsFloat, overload

from chordal._curve import Curve
from chordal._field import Field, Formula, called
from chordal._hints import keywords_hinted

__all__ = [
    "sphere",
    "box",
    "rounded_box",
    "cylinder",
    "cone",
    "capsule",
    "torus",
    "ellipsoid",
    "prism",
    "octahedron",
    "tetrahedron",
    "plane",
    "triangle",
    "hull",
    "sweep",
    "thread",
    "gyroid",
    "schwarz_p",
    "diamond",
    "circle",
    "rectangle",
    "rounded_rectangle",
    "segment",
    "polygon",
    "regular_polygon",
    "planar_hull",
    "union",
    "intersection",
    "difference",
    "complement",
    "smooth_union",
    "smooth_intersection",
    "smooth_difference",
    "move",
    "rotate_x",
    "rotate_y",
    "rotate_z",
    "rotate",
    "scale",
    "stretch",
    "mirror",
    "repeat",
    "linear",
    "polar",
    "symmetric",
    "offset",
    "minkowski",
    "shell",
    "redistance",
    "extrude",
    "section",
    "taper",
    "loft",
    "revolve",
    "twist",
    "bend",
    "displace",
    "color",
    "material",
    "sqrt",
    "exp",
    "log",
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "atan2",
    "floor",
    "ceil",
    "minimum",
    "maximum",
    "radians",
]

if TYPE_CHECKING:
    from typing import TypeAlias

    from numpy.typing import NDArray

    #: Three numbers, or two in the plane.
    _Vector: TypeAlias = Sequence[SupportsFloat] | NDArray[Any]
    #: Points, each of two or three numbers.
    _Points: TypeAlias = Sequence[Sequence[SupportsFloat]] | NDArray[Any]


def _parts(name: str, vector: Any, y: object, least: int) -> Sequence[Any]:
    """The components of a vector that is given in place of separate numbers."""
    parts = vector.tolist() if hasattr(vector, "tolist") else vector
    if y is not None or not isinstance(parts, (list, tuple)) or not least <= len(parts) <= 3:
        raise TypeError(f"{name}: x, y and z are three numbers, or one vector as in (1, 2, 3)")
    return parts


def sphere(radius: SupportsFloat) -> Field:
    """A ball centred on the origin.

    The value is: exact distance.
    """
    return called("sphere", radius)  # type: ignore[no-any-return]


@overload
def box(x: SupportsFloat, y: SupportsFloat, z: SupportsFloat) -> Field: ...
@overload
def box(x: _Vector, y: None = None, z: None = None) -> Field: ...
def box(x: SupportsFloat | _Vector, y: SupportsFloat | None = None, z: SupportsFloat | None = None) -> Field:
    """A box with the side lengths x, y and z, centred on the origin.

    The value is: exact distance.
    """
    if y is None or z is None:
        return called("box", *_parts("box", x, y, 3))  # type: ignore[no-any-return]
    return called("box", x, y, z)  # type: ignore[no-any-return]


def rounded_box(x: SupportsFloat, y: SupportsFloat, z: SupportsFloat, radius: SupportsFloat) -> Field:
    """A box with the side lengths x, y and z, centred on the origin, whose edges are rounded to this radius.

    The value is: exact distance.
    """
    return called("rounded_box", x, y, z, radius)  # type: ignore[no-any-return]


def cylinder(radius: SupportsFloat, height: SupportsFloat) -> Field:
    """A cylinder along the z axis, centred on the origin.

    The value is: exact distance.
    """
    return called("cylinder", radius, height)  # type: ignore[no-any-return]


def cone(bottom: SupportsFloat, top: SupportsFloat, height: SupportsFloat) -> Field:
    """A cone along the z axis, centred on the origin, with one radius at the bottom and one at the top; one of them may
    be 0.

    The value is: exact distance.
    """
    return called("cone", bottom, top, height)  # type: ignore[no-any-return]


def capsule(a: Sequence[SupportsFloat], b: Sequence[SupportsFloat], radius: SupportsFloat) -> Field:
    """All points closer than the radius to the segment from a to b.

    The value is: exact distance.
    """
    return called("capsule", a, b, radius)  # type: ignore[no-any-return]


def torus(major: SupportsFloat, minor: SupportsFloat) -> Field:
    """A torus around the z axis: major is the radius of its circle, minor that of its tube.

    The value is: exact distance; inside a lower bound if the tube intersects itself.
    """
    return called("torus", major, minor)  # type: ignore[no-any-return]


@overload
def ellipsoid(x: SupportsFloat, y: SupportsFloat, z: SupportsFloat) -> Field: ...
@overload
def ellipsoid(x: _Vector, y: None = None, z: None = None) -> Field: ...
def ellipsoid(x: SupportsFloat | _Vector, y: SupportsFloat | None = None, z: SupportsFloat | None = None) -> Field:
    """An ellipsoid with the semi-axes x, y and z, centred on the origin.

    The value is: lower bound.
    """
    if y is None or z is None:
        return called("ellipsoid", *_parts("ellipsoid", x, y, 3))  # type: ignore[no-any-return]
    return called("ellipsoid", x, y, z)  # type: ignore[no-any-return]


def prism(sides: SupportsFloat, radius: SupportsFloat, height: SupportsFloat) -> Field:
    """A regular prism along the z axis, centred on the origin. The radius is the distance of its corners from the axis;
    one of them is on the x axis.

    The value is: exact distance.
    """
    return called("prism", sides, radius, height)  # type: ignore[no-any-return]


def octahedron(radius: SupportsFloat) -> Field:
    """A regular octahedron whose corners are on the axes, at this radius from the origin.

    The value is: exact distance inside, lower bound outside.
    """
    return called("octahedron", radius)  # type: ignore[no-any-return]


def tetrahedron(radius: SupportsFloat) -> Field:
    """A regular tetrahedron whose corners are at this radius from the origin, one of them in the direction (1, 1, 1).

    The value is: exact distance inside, lower bound outside.
    """
    return called("tetrahedron", radius)  # type: ignore[no-any-return]


def plane(normal: Sequence[SupportsFloat], offset: SupportsFloat = 0) -> Field:
    """The half-space below a plane, which is at this offset from the origin along its normal.

    The value is: exact distance.
    """
    return called("plane", normal, offset)  # type: ignore[no-any-return]


def triangle(
    a: Sequence[SupportsFloat], b: Sequence[SupportsFloat], c: Sequence[SupportsFloat], thickness: SupportsFloat
) -> Field:
    """All points closer than half the thickness to a triangle in space.

    The value is: exact distance.
    """
    return called("triangle", a, b, c, thickness)  # type: ignore[no-any-return]


def hull(points: _Points | Field | Sequence[Field], radius: SupportsFloat = 0) -> Field:
    """The convex hull of points, or of balls of this radius around them. Also the hull of a list of shapes that are
    such hulls themselves: boxes, prisms, extruded polygons, balls, capsules.

    The value is: exact distance.
    """
    return called("hull", points, radius)  # type: ignore[no-any-return]


def sweep(path: Curve | _Points, profile: Field | SupportsFloat, tolerance: SupportsFloat | None = None) -> Field:
    """If the profile is a radius, a tube: all points closer than the radius to a path, or to the polyline through
    points. If it is a 2D shape, that shape swept along the path or polyline, with mitres at the corners. A path is
    replaced by a polyline within the tolerance, by default 1/4096 of the diagonal of its box. `Field.notes` has the
    distance that was reached.

    The value is: for a tube exact distance to the polyline outside, lower bound inside; for a swept shape lower bound.
    """
    return called("sweep", path, profile, tolerance)  # type: ignore[no-any-return]


def thread(name: str, height: SupportsFloat, clearance: SupportsFloat = 0) -> Field:
    """A metric thread along the z axis, named as in "M6" (coarse) or "M6x0.75". Its sides are moved inward by the
    clearance; use a negative one for the hole of a nut.

    The value is: sign only.
    """
    return called("thread", name, height, clearance)  # type: ignore[no-any-return]


def gyroid(period: SupportsFloat, level: SupportsFloat = 0) -> Field:
    """The infinite solid on one side of the gyroid; shell() turns it into a wall.

    The value is: lower bound.
    """
    return called("gyroid", period, level)  # type: ignore[no-any-return]


def schwarz_p(period: SupportsFloat, level: SupportsFloat = 0) -> Field:
    """The infinite solid on one side of the Schwarz P surface.

    The value is: lower bound.
    """
    return called("schwarz_p", period, level)  # type: ignore[no-any-return]


def diamond(period: SupportsFloat, level: SupportsFloat = 0) -> Field:
    """The infinite solid on one side of the Schwarz D surface.

    The value is: lower bound.
    """
    return called("diamond", period, level)  # type: ignore[no-any-return]


def circle(radius: SupportsFloat) -> Field:
    """A disc centred on the origin.

    The value is: exact distance.
    """
    return called("circle", radius)  # type: ignore[no-any-return]


def rectangle(x: SupportsFloat, y: SupportsFloat) -> Field:
    """A rectangle with the side lengths x and y, centred on the origin.

    The value is: exact distance.
    """
    return called("rectangle", x, y)  # type: ignore[no-any-return]


def rounded_rectangle(x: SupportsFloat, y: SupportsFloat, radius: SupportsFloat) -> Field:
    """A rectangle with the side lengths x and y, centred on the origin, whose corners are rounded to this radius.

    The value is: exact distance.
    """
    return called("rounded_rectangle", x, y, radius)  # type: ignore[no-any-return]


def segment(a: Sequence[SupportsFloat], b: Sequence[SupportsFloat], radius: SupportsFloat) -> Field:
    """All points closer than the radius to the segment from a to b.

    The value is: exact distance.
    """
    return called("segment", a, b, radius)  # type: ignore[no-any-return]


def polygon(points: Curve | _Points, tolerance: SupportsFloat | None = None) -> Field:
    """The polygon with these corners, each of two numbers. Or the area that a 2D path encloses; the path is replaced by
    a polygon within the tolerance, by default 1/4096 of the diagonal of its box. `Field.notes` has the distance that
    was reached.

    The value is: exact distance; lower bound if it crosses itself.
    """
    return called("polygon", points, tolerance)  # type: ignore[no-any-return]


def regular_polygon(sides: SupportsFloat, radius: SupportsFloat) -> Field:
    """A regular polygon centred on the origin. The radius is the distance of its corners from the origin; one of them
    is on the x axis.

    The value is: exact distance.
    """
    return called("regular_polygon", sides, radius)  # type: ignore[no-any-return]


def planar_hull(points: _Points) -> Field:
    """The convex hull of 2D points.

    The value is: exact distance.
    """
    return called("planar_hull", points)  # type: ignore[no-any-return]


def union(*shapes: Field | Sequence[Field], fillet: SupportsFloat = 0, chamfer: SupportsFloat = 0) -> Field:
    """All points in any of the shapes, like `a | b`; also takes a list of shapes. A fillet or chamfer fills the inner
    edges where the shapes meet.

    The value is: outside as for the weakest of the shapes, inside a lower bound; with a fillet or chamfer a lower bound.
    """
    return called("union", *shapes, fillet=fillet, chamfer=chamfer)  # type: ignore[no-any-return]


def intersection(*shapes: Field | Sequence[Field], fillet: SupportsFloat = 0, chamfer: SupportsFloat = 0) -> Field:
    """The points common to all of the shapes, like `a & b`. A fillet or chamfer rounds or cuts off the edges where the
    shapes meet.

    The value is: inside as for the weakest of the shapes, outside a lower bound; with a fillet or chamfer a lower bound.
    """
    return called("intersection", *shapes, fillet=fillet, chamfer=chamfer)  # type: ignore[no-any-return]


def difference(shape: Field, *others: Field | Sequence[Field], fillet: SupportsFloat = 0, chamfer: SupportsFloat = 0) -> Field:
    """The points of the first shape that are in none of the others, like `a - b`. A fillet or chamfer rounds or cuts
    off the edges of the cuts.

    The value is: lower bound.
    """
    return called("difference", shape, *others, fillet=fillet, chamfer=chamfer)  # type: ignore[no-any-return]


def complement(shape: Field) -> Field:
    """All points that are not in the shape.

    The value is: as for the given shape, with inside and outside exchanged.
    """
    return called("complement", shape)  # type: ignore[no-any-return]


def smooth_union(a: Field, b: Field, radius: SupportsFloat) -> Field:
    """The union, blended where the shapes are closer to each other than the radius. Faces and outer edges that both
    shapes share bulge; union(fillet=) leaves them unchanged.

    The value is: lower bound.
    """
    return called("smooth_union", a, b, radius)  # type: ignore[no-any-return]


def smooth_intersection(a: Field, b: Field, radius: SupportsFloat) -> Field:
    """The intersection with its edges rounded.

    The value is: lower bound.
    """
    return called("smooth_intersection", a, b, radius)  # type: ignore[no-any-return]


def smooth_difference(a: Field, b: Field, radius: SupportsFloat) -> Field:
    """The difference with its edges rounded.

    The value is: lower bound.
    """
    return called("smooth_difference", a, b, radius)  # type: ignore[no-any-return]


@overload
def move(shape: Field, x: SupportsFloat, y: SupportsFloat, z: SupportsFloat = ...) -> Field: ...
@overload
def move(shape: Field, x: _Vector, y: None = None, z: SupportsFloat = ...) -> Field: ...
def move(shape: Field, x: SupportsFloat | _Vector, y: SupportsFloat | None = None, z: SupportsFloat = 0) -> Field:
    """The shape moved by the vector (x, y, z).

    The value is: as for the given shape.
    """
    if y is None:
        return called("move", shape, *_parts("move", x, y, 2))  # type: ignore[no-any-return]
    return called("move", shape, x, y, z)  # type: ignore[no-any-return]


def rotate_x(shape: Field, degrees: SupportsFloat) -> Field:
    """The shape rotated around the x axis, counter-clockwise as seen from its positive end.

    The value is: as for the given shape.
    """
    return called("rotate_x", shape, degrees)  # type: ignore[no-any-return]


def rotate_y(shape: Field, degrees: SupportsFloat) -> Field:
    """The shape rotated around the y axis.

    The value is: as for the given shape.
    """
    return called("rotate_y", shape, degrees)  # type: ignore[no-any-return]


def rotate_z(shape: Field, degrees: SupportsFloat) -> Field:
    """The shape rotated around the z axis; also for 2D shapes.

    The value is: as for the given shape.
    """
    return called("rotate_z", shape, degrees)  # type: ignore[no-any-return]


def rotate(shape: Field, axis: Sequence[SupportsFloat], degrees: SupportsFloat) -> Field:
    """The shape rotated around an axis through the origin, given as a vector of three numbers.

    The value is: as for the given shape.
    """
    return called("rotate", shape, axis, degrees)  # type: ignore[no-any-return]


def scale(shape: Field, factor: SupportsFloat) -> Field:
    """The shape scaled about the origin.

    The value is: as for the given shape.
    """
    return called("scale", shape, factor)  # type: ignore[no-any-return]


@overload
def stretch(shape: Field, x: SupportsFloat, y: SupportsFloat, z: SupportsFloat = ...) -> Field: ...
@overload
def stretch(shape: Field, x: _Vector, y: None = None, z: SupportsFloat = ...) -> Field: ...
def stretch(shape: Field, x: SupportsFloat | _Vector, y: SupportsFloat | None = None, z: SupportsFloat = 1) -> Field:
    """The shape scaled by a separate factor along each axis.

    The value is: lower bound.
    """
    if y is None:
        return called("stretch", shape, *_parts("stretch", x, y, 2))  # type: ignore[no-any-return]
    return called("stretch", shape, x, y, z)  # type: ignore[no-any-return]


@overload
def mirror(shape: Field, x: SupportsFloat, y: SupportsFloat, z: SupportsFloat = ...) -> Field: ...
@overload
def mirror(shape: Field, x: _Vector, y: None = None, z: SupportsFloat = ...) -> Field: ...
def mirror(shape: Field, x: SupportsFloat | _Vector, y: SupportsFloat | None = None, z: SupportsFloat = 0) -> Field:
    """The mirror image of the shape in the plane through the origin with the normal (x, y, z).

    The value is: as for the given shape.
    """
    if y is None:
        return called("mirror", shape, *_parts("mirror", x, y, 2))  # type: ignore[no-any-return]
    return called("mirror", shape, x, y, z)  # type: ignore[no-any-return]


def repeat(
    shape: Field,
    x: SupportsFloat = 0,
    y: SupportsFloat = 0,
    z: SupportsFloat = 0,
    nx: SupportsFloat = 0,
    ny: SupportsFloat = 0,
    nz: SupportsFloat = 0,
) -> Field:
    """Copies of the shape: nx, ny and nz of them along the axes (0: infinitely many), at the spacings x, y and z (0: no
    copies along this axis).

    The value is: outside the exact distance if it was exact, else sign only; inside a lower bound.
    """
    return called("repeat", shape, x, y, z, nx, ny, nz)  # type: ignore[no-any-return]


def linear(shape: Field, count: SupportsFloat, x: SupportsFloat, y: SupportsFloat = 0, z: SupportsFloat = 0) -> Field:
    """The given number of copies of the shape in a row, each moved by the vector (x, y, z) from the one before.

    The value is: outside as for the given shape, inside a lower bound.
    """
    return called("linear", shape, count, x, y, z)  # type: ignore[no-any-return]


def polar(shape: Field, count: SupportsFloat, degrees: SupportsFloat = 360) -> Field:
    """The given number of copies of the shape around the z axis, spaced evenly over a full turn, or from the first to
    the last over another angle.

    The value is: outside as for the given shape, inside a lower bound.
    """
    return called("polar", shape, count, degrees)  # type: ignore[no-any-return]


def symmetric(shape: Field, x: SupportsFloat, y: SupportsFloat, z: SupportsFloat = 0) -> Field:
    """The shape and its mirror image in the plane through the origin with the normal (x, y, z).

    The value is: outside as for the given shape, inside a lower bound.
    """
    return called("symmetric", shape, x, y, z)  # type: ignore[no-any-return]


def offset(shape: Field, by: SupportsFloat) -> Field:
    """The shape grown by a distance, or shrunk by a negative one. Its value must be an exact distance or a lower bound
    on the side that the surface moves to.

    The value is: exact distance on the side that the surface moves to, if it was exact there; else a lower bound.
    """
    return called("offset", shape, by)  # type: ignore[no-any-return]


def minkowski(shape: Field, radius: SupportsFloat) -> Field:
    """The Minkowski sum with a ball: all points closer than the radius to the shape. Outside, the shape's value must be
    the exact distance.

    The value is: exact distance outside, lower bound inside.
    """
    return called("minkowski", shape, radius)  # type: ignore[no-any-return]


def shell(shape: Field, thickness: SupportsFloat) -> Field:
    """A wall along the surface, with half of its thickness on each side. The shape's value must be an exact distance or
    a lower bound on both sides.

    The value is: exact distance outside if it was exact on both sides; otherwise a lower bound.
    """
    return called("shell", shape, thickness)  # type: ignore[no-any-return]


def redistance(shape: Field, within: SupportsFloat) -> Field:
    """The shape with its value replaced by the exact distance to triangles, which approximate its surface within this
    length.

    The value is: exact distance to the triangles.
    """
    return called("redistance", shape, within)  # type: ignore[no-any-return]


def extrude(shape: Field, height: SupportsFloat, bevel: SupportsFloat = 0, rounded: SupportsFloat = 0) -> Field:
    """A 2D shape extruded to a solid of this height, half above and half below z = 0. A bevel cuts off the edges of
    both ends at 45 degrees, to this width and height; rounded replaces them by quarter circles of this radius. Both
    take the depth below the outline from the shape's value.

    The value is: as for the given shape; with a bevel or rounded edges a lower bound.
    """
    return called("extrude", shape, height, bevel, rounded)  # type: ignore[no-any-return]


def section(shape: Field, z: SupportsFloat = 0) -> Field:
    """The cross-section of a solid at the height z, as a 2D shape.

    The value is: lower bound.
    """
    return called("section", shape, z)  # type: ignore[no-any-return]


def taper(shape: Field, factor: SupportsFloat, height: SupportsFloat) -> Field:
    """A solid of this height, half above and half below z = 0, whose cross-section is the shape scaled from 1 at the
    bottom to the factor at the top.

    The value is: lower bound; sign only if the shape is unbounded or its value is only a sign.
    """
    return called("taper", shape, factor, height)  # type: ignore[no-any-return]


def loft(shapes: Sequence[Field], height: SupportsFloat) -> Field:
    """A solid of this height, half above and half below z = 0, which blends from the first of a list of 2D shapes to
    the last. The shapes in between attract it, as control points attract a Bézier curve.

    The value is: lower bound.
    """
    return called("loft", shapes, height)  # type: ignore[no-any-return]


def revolve(shape: Field) -> Field:
    """A 2D shape revolved around its y axis, which becomes the z axis.

    The value is: as for the given shape, if it does not touch the axis.
    """
    return called("revolve", shape)  # type: ignore[no-any-return]


def twist(shape: Field, degrees: SupportsFloat) -> Field:
    """The shape rotated around the z axis by this angle per unit of height.

    The value is: lower bound if the shape is bounded around the z axis, else sign only.
    """
    return called("twist", shape, degrees)  # type: ignore[no-any-return]


def bend(shape: Field, degrees: SupportsFloat) -> Field:
    """The shape rotated around the z axis by this angle per unit along x.

    The value is: lower bound if the shape is bounded around the z axis, else sign only.
    """
    return called("bend", shape, degrees)  # type: ignore[no-any-return]


def displace(shape: Field, by: Formula | float, amplitude: SupportsFloat) -> Field:
    """The shape with a formula added to its value; the amplitude is an upper bound of the formula's absolute value.

    The value is: sign only.
    """
    return called("displace", shape, by, amplitude)  # type: ignore[no-any-return]


def color(shape: Field, color: str | Sequence[SupportsFloat]) -> Field:
    """The shape in a colour: "#d33", "#dd3333", "red", or a list of three or four numbers from 0 to 1, the fourth of
    which is the opacity. A later colour replaces it.

    The value is: as for the given shape.
    """
    return called("color", shape, color)  # type: ignore[no-any-return]


def material(
    shape: Field,
    name: str,
    color: str | Sequence[SupportsFloat],
    metallic: SupportsFloat = 0,
    roughness: SupportsFloat = 0.5,
) -> Field:
    """The shape in a material with a name, a colour as for color(), and factors from 0 to 1 for how metallic and how
    rough it is.

    The value is: as for the given shape.
    """
    return called("material", shape, name, color, metallic, roughness)  # type: ignore[no-any-return]


@overload
def sqrt(value: SupportsFloat) -> float: ...
@overload
def sqrt(value: Formula | SupportsFloat) -> Formula | float: ...
def sqrt(value: Formula | SupportsFloat) -> Formula | float:
    """The square root."""
    return called("sqrt", value)  # type: ignore[no-any-return]


@overload
def exp(value: SupportsFloat) -> float: ...
@overload
def exp(value: Formula | SupportsFloat) -> Formula | float: ...
def exp(value: Formula | SupportsFloat) -> Formula | float:
    """The exponential function."""
    return called("exp", value)  # type: ignore[no-any-return]


@overload
def log(value: SupportsFloat) -> float: ...
@overload
def log(value: Formula | SupportsFloat) -> Formula | float: ...
def log(value: Formula | SupportsFloat) -> Formula | float:
    """The natural logarithm."""
    return called("log", value)  # type: ignore[no-any-return]


@overload
def sin(value: SupportsFloat) -> float: ...
@overload
def sin(value: Formula | SupportsFloat) -> Formula | float: ...
def sin(value: Formula | SupportsFloat) -> Formula | float:
    """The sine of an angle in radians."""
    return called("sin", value)  # type: ignore[no-any-return]


@overload
def cos(value: SupportsFloat) -> float: ...
@overload
def cos(value: Formula | SupportsFloat) -> Formula | float: ...
def cos(value: Formula | SupportsFloat) -> Formula | float:
    """The cosine of an angle in radians."""
    return called("cos", value)  # type: ignore[no-any-return]


@overload
def tan(value: SupportsFloat) -> float: ...
@overload
def tan(value: Formula | SupportsFloat) -> Formula | float: ...
def tan(value: Formula | SupportsFloat) -> Formula | float:
    """The tangent of an angle in radians."""
    return called("tan", value)  # type: ignore[no-any-return]


@overload
def asin(value: SupportsFloat) -> float: ...
@overload
def asin(value: Formula | SupportsFloat) -> Formula | float: ...
def asin(value: Formula | SupportsFloat) -> Formula | float:
    """The arcsine, in radians."""
    return called("asin", value)  # type: ignore[no-any-return]


@overload
def acos(value: SupportsFloat) -> float: ...
@overload
def acos(value: Formula | SupportsFloat) -> Formula | float: ...
def acos(value: Formula | SupportsFloat) -> Formula | float:
    """The arccosine, in radians."""
    return called("acos", value)  # type: ignore[no-any-return]


@overload
def atan(value: SupportsFloat) -> float: ...
@overload
def atan(value: Formula | SupportsFloat) -> Formula | float: ...
def atan(value: Formula | SupportsFloat) -> Formula | float:
    """The arctangent, in radians."""
    return called("atan", value)  # type: ignore[no-any-return]


@overload
def atan2(y: SupportsFloat, x: SupportsFloat) -> float: ...
@overload
def atan2(y: Formula | SupportsFloat, x: Formula | SupportsFloat) -> Formula | float: ...
def atan2(y: Formula | SupportsFloat, x: Formula | SupportsFloat) -> Formula | float:
    """The angle of the point (x, y) from the x axis, in radians."""
    return called("atan2", y, x)  # type: ignore[no-any-return]


@overload
def floor(value: SupportsFloat) -> float: ...
@overload
def floor(value: Formula | SupportsFloat) -> Formula | float: ...
def floor(value: Formula | SupportsFloat) -> Formula | float:
    """The largest integer that is not above the value."""
    return called("floor", value)  # type: ignore[no-any-return]


@overload
def ceil(value: SupportsFloat) -> float: ...
@overload
def ceil(value: Formula | SupportsFloat) -> Formula | float: ...
def ceil(value: Formula | SupportsFloat) -> Formula | float:
    """The smallest integer that is not below the value."""
    return called("ceil", value)  # type: ignore[no-any-return]


@overload
def minimum(a: SupportsFloat, b: SupportsFloat) -> float: ...
@overload
def minimum(a: Formula | SupportsFloat, b: Formula | SupportsFloat) -> Formula | float: ...
def minimum(a: Formula | SupportsFloat, b: Formula | SupportsFloat) -> Formula | float:
    """The smaller of two values."""
    return called("minimum", a, b)  # type: ignore[no-any-return]


@overload
def maximum(a: SupportsFloat, b: SupportsFloat) -> float: ...
@overload
def maximum(a: Formula | SupportsFloat, b: Formula | SupportsFloat) -> Formula | float: ...
def maximum(a: Formula | SupportsFloat, b: Formula | SupportsFloat) -> Formula | float:
    """The larger of two values."""
    return called("maximum", a, b)  # type: ignore[no-any-return]


@overload
def radians(value: SupportsFloat) -> float: ...
@overload
def radians(value: Formula | SupportsFloat) -> Formula | float: ...
def radians(value: Formula | SupportsFloat) -> Formula | float:
    """An angle in degrees, converted to radians."""
    return called("radians", value)  # type: ignore[no-any-return]


for _name in __all__:
    # Guessed keywords, as in sphere(r=1), get an error that names the right one.
    globals()[_name] = keywords_hinted(globals()[_name])
