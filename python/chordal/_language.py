"""The functions of shape scripts, by the same names: the text of a script also runs after `from chordal.shapes import *`.

The page on shape scripts describes each of them, and the quality of its value as a distance.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, SupportsFloat, overload

from chordal._curve import Curve
from chordal._field import Field, Formula, called
from chordal._hints import keywords_hinted

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
    """A ball around the origin.

    The value is worth: exact.
    """
    return called("sphere", radius)  # type: ignore[no-any-return]


@overload
def box(x: SupportsFloat, y: SupportsFloat, z: SupportsFloat) -> Field: ...
@overload
def box(x: _Vector, y: None = None, z: None = None) -> Field: ...
def box(x: SupportsFloat | _Vector, y: SupportsFloat | None = None, z: SupportsFloat | None = None) -> Field:
    """A box of these full sizes around the origin.

    The value is worth: exact.
    """
    if y is None or z is None:
        return called("box", *_parts("box", x, y, 3))  # type: ignore[no-any-return]
    return called("box", x, y, z)  # type: ignore[no-any-return]


def rounded_box(x: SupportsFloat, y: SupportsFloat, z: SupportsFloat, radius: SupportsFloat) -> Field:
    """A box of these full sizes whose edges are rounded to a radius.

    The value is worth: exact.
    """
    return called("rounded_box", x, y, z, radius)  # type: ignore[no-any-return]


def cylinder(radius: SupportsFloat, height: SupportsFloat) -> Field:
    """A cylinder along z, around the origin.

    The value is worth: exact.
    """
    return called("cylinder", radius, height)  # type: ignore[no-any-return]


def cone(bottom: SupportsFloat, top: SupportsFloat, height: SupportsFloat) -> Field:
    """A cone along z with a radius at its bottom and one at its top, either of them 0 if you like.

    The value is worth: exact.
    """
    return called("cone", bottom, top, height)  # type: ignore[no-any-return]


def capsule(a: Sequence[SupportsFloat], b: Sequence[SupportsFloat], radius: SupportsFloat) -> Field:
    """All points nearer than a radius to the segment between two points.

    The value is worth: exact.
    """
    return called("capsule", a, b, radius)  # type: ignore[no-any-return]


def torus(major: SupportsFloat, minor: SupportsFloat) -> Field:
    """A ring around z: the radius of its circle, and that of its tube.

    The value is worth: exact; lower bound inside where the ring meets itself.
    """
    return called("torus", major, minor)  # type: ignore[no-any-return]


@overload
def ellipsoid(x: SupportsFloat, y: SupportsFloat, z: SupportsFloat) -> Field: ...
@overload
def ellipsoid(x: _Vector, y: None = None, z: None = None) -> Field: ...
def ellipsoid(x: SupportsFloat | _Vector, y: SupportsFloat | None = None, z: SupportsFloat | None = None) -> Field:
    """An ellipsoid of these three radii.

    The value is worth: a lower bound.
    """
    if y is None or z is None:
        return called("ellipsoid", *_parts("ellipsoid", x, y, 3))  # type: ignore[no-any-return]
    return called("ellipsoid", x, y, z)  # type: ignore[no-any-return]


def prism(sides: SupportsFloat, radius: SupportsFloat, height: SupportsFloat) -> Field:
    """A regular prism along z; the radius is that of its corners, one of which is on the x axis.

    The value is worth: exact.
    """
    return called("prism", sides, radius, height)  # type: ignore[no-any-return]


def octahedron(radius: SupportsFloat) -> Field:
    """A regular octahedron with its corners on the axes.

    The value is worth: exact inside, lower bound outside.
    """
    return called("octahedron", radius)  # type: ignore[no-any-return]


def tetrahedron(radius: SupportsFloat) -> Field:
    """A regular tetrahedron; the radius is that of its corners, one of them towards (1, 1, 1).

    The value is worth: exact inside, lower bound outside.
    """
    return called("tetrahedron", radius)  # type: ignore[no-any-return]


def plane(normal: Sequence[SupportsFloat], offset: SupportsFloat = 0) -> Field:
    """All points below a plane, which is that far from the origin along its normal.

    The value is worth: exact.
    """
    return called("plane", normal, offset)  # type: ignore[no-any-return]


def triangle(
    a: Sequence[SupportsFloat], b: Sequence[SupportsFloat], c: Sequence[SupportsFloat], thickness: SupportsFloat
) -> Field:
    """All points nearer than half of a thickness to a triangle in space.

    The value is worth: exact.
    """
    return called("triangle", a, b, c, thickness)  # type: ignore[no-any-return]


def hull(points: _Points | Field | Sequence[Field], radius: SupportsFloat = 0) -> Field:
    """The convex hull of points, or of balls of one radius around them. Or of a list of shapes that are such hulls:
    boxes, prisms, extruded polygons, balls, capsules.

    The value is worth: exact.
    """
    return called("hull", points, radius)  # type: ignore[no-any-return]


def sweep(path: Curve | _Points, profile: Field | SupportsFloat, tolerance: SupportsFloat | None = None) -> Field:
    """A tube, where the profile is a radius: all points nearer than that to a path, or to the straight lines through
    points. Or a shape of the plane swept along them, with mitres where lines meet. A path becomes straight lines within
    the tolerance: a 4096th of its box's diagonal unless said. `Field.notes` has the distance.

    The value is worth: of these lines outside exact, inside a lower bound; a lower bound for a shape.
    """
    return called("sweep", path, profile, tolerance)  # type: ignore[no-any-return]


def thread(name: str, height: SupportsFloat, clearance: SupportsFloat = 0) -> Field:
    """A metric thread along z, as "M6" (coarse) or "M6x0.75", all of its sides moved inward by a clearance; a negative
    one is for the hole of a nut.

    The value is worth: a sign.
    """
    return called("thread", name, height, clearance)  # type: ignore[no-any-return]


def gyroid(period: SupportsFloat, level: SupportsFloat = 0) -> Field:
    """One side of the gyroid, without end; with shell() it is a wall.

    The value is worth: a lower bound.
    """
    return called("gyroid", period, level)  # type: ignore[no-any-return]


def schwarz_p(period: SupportsFloat, level: SupportsFloat = 0) -> Field:
    """One side of Schwarz' surface P, without end.

    The value is worth: a lower bound.
    """
    return called("schwarz_p", period, level)  # type: ignore[no-any-return]


def diamond(period: SupportsFloat, level: SupportsFloat = 0) -> Field:
    """One side of Schwarz' surface D, without end.

    The value is worth: a lower bound.
    """
    return called("diamond", period, level)  # type: ignore[no-any-return]


def circle(radius: SupportsFloat) -> Field:
    """A disc around the origin.

    The value is worth: exact.
    """
    return called("circle", radius)  # type: ignore[no-any-return]


def rectangle(x: SupportsFloat, y: SupportsFloat) -> Field:
    """A rectangle of these full sizes around the origin.

    The value is worth: exact.
    """
    return called("rectangle", x, y)  # type: ignore[no-any-return]


def rounded_rectangle(x: SupportsFloat, y: SupportsFloat, radius: SupportsFloat) -> Field:
    """A rectangle of these full sizes whose corners are rounded to a radius.

    The value is worth: exact.
    """
    return called("rounded_rectangle", x, y, radius)  # type: ignore[no-any-return]


def segment(a: Sequence[SupportsFloat], b: Sequence[SupportsFloat], radius: SupportsFloat) -> Field:
    """All points nearer than a radius to the segment between two points.

    The value is worth: exact.
    """
    return called("segment", a, b, radius)  # type: ignore[no-any-return]


def polygon(points: Curve | _Points, tolerance: SupportsFloat | None = None) -> Field:
    """The polygon with these corners, each of two numbers. Or what a path of the plane encloses: its polygon within the
    tolerance, a 4096th of its box's diagonal unless said. `Field.notes` has the distance.

    The value is worth: exact; lower bound where it crosses itself.
    """
    return called("polygon", points, tolerance)  # type: ignore[no-any-return]


def regular_polygon(sides: SupportsFloat, radius: SupportsFloat) -> Field:
    """A regular polygon; the radius is that of its corners, one of which is on the x axis.

    The value is worth: exact.
    """
    return called("regular_polygon", sides, radius)  # type: ignore[no-any-return]


def planar_hull(points: _Points) -> Field:
    """The convex hull of points of the plane.

    The value is worth: exact.
    """
    return called("planar_hull", points)  # type: ignore[no-any-return]


def union(*shapes: Field | Sequence[Field], fillet: SupportsFloat = 0, chamfer: SupportsFloat = 0) -> Field:
    """All points of any of the shapes, as `a | b` has them; a list of shapes does as well. With a fillet or chamfer
    the edges are filled in which they meet.

    The value is worth: outside as good as all of them, inside a lower bound; with a fillet or chamfer a lower bound.
    """
    return called("union", *shapes, fillet=fillet, chamfer=chamfer)  # type: ignore[no-any-return]


def intersection(*shapes: Field | Sequence[Field], fillet: SupportsFloat = 0, chamfer: SupportsFloat = 0) -> Field:
    """The points that all of the shapes have, as `a & b` has them. With a fillet or chamfer the edges are rounded or
    cut off in which they meet.

    The value is worth: inside as good as all of them, outside a lower bound; with a fillet or chamfer a lower bound.
    """
    return called("intersection", *shapes, fillet=fillet, chamfer=chamfer)  # type: ignore[no-any-return]


def difference(shape: Field, *others: Field | Sequence[Field], fillet: SupportsFloat = 0, chamfer: SupportsFloat = 0) -> Field:
    """The points of the first shape that none of the others has, as `a - b` has them. With a fillet or chamfer the
    edges of the cuts are rounded or cut off.

    The value is worth: a lower bound.
    """
    return called("difference", shape, *others, fillet=fillet, chamfer=chamfer)  # type: ignore[no-any-return]


def complement(shape: Field) -> Field:
    """All other points.

    The value is worth: as it was, inside and outside exchanged.
    """
    return called("complement", shape)  # type: ignore[no-any-return]


def smooth_union(a: Field, b: Field, radius: SupportsFloat) -> Field:
    """The union with its seam filled, where both are nearer to each other than a radius. Faces and outer edges that
    both share swell; union(fillet=) leaves them.

    The value is worth: a lower bound.
    """
    return called("smooth_union", a, b, radius)  # type: ignore[no-any-return]


def smooth_intersection(a: Field, b: Field, radius: SupportsFloat) -> Field:
    """The intersection with its edge rounded off.

    The value is worth: a lower bound.
    """
    return called("smooth_intersection", a, b, radius)  # type: ignore[no-any-return]


def smooth_difference(a: Field, b: Field, radius: SupportsFloat) -> Field:
    """The difference with its edge rounded off.

    The value is worth: a lower bound.
    """
    return called("smooth_difference", a, b, radius)  # type: ignore[no-any-return]


@overload
def move(shape: Field, x: SupportsFloat, y: SupportsFloat, z: SupportsFloat = ...) -> Field: ...
@overload
def move(shape: Field, x: _Vector, y: None = None, z: SupportsFloat = ...) -> Field: ...
def move(shape: Field, x: SupportsFloat | _Vector, y: SupportsFloat | None = None, z: SupportsFloat = 0) -> Field:
    """The shape moved by these lengths.

    The value is worth: as it was.
    """
    if y is None:
        return called("move", shape, *_parts("move", x, y, 2))  # type: ignore[no-any-return]
    return called("move", shape, x, y, z)  # type: ignore[no-any-return]


def rotate_x(shape: Field, degrees: SupportsFloat) -> Field:
    """The shape turned around the x axis, counter-clockwise as seen from its tip.

    The value is worth: as it was.
    """
    return called("rotate_x", shape, degrees)  # type: ignore[no-any-return]


def rotate_y(shape: Field, degrees: SupportsFloat) -> Field:
    """The shape turned around the y axis.

    The value is worth: as it was.
    """
    return called("rotate_y", shape, degrees)  # type: ignore[no-any-return]


def rotate_z(shape: Field, degrees: SupportsFloat) -> Field:
    """The shape turned around the z axis; so are shapes of the plane.

    The value is worth: as it was.
    """
    return called("rotate_z", shape, degrees)  # type: ignore[no-any-return]


def rotate(shape: Field, axis: Sequence[SupportsFloat], degrees: SupportsFloat) -> Field:
    """The shape turned around an axis of three numbers through the origin.

    The value is worth: as it was.
    """
    return called("rotate", shape, axis, degrees)  # type: ignore[no-any-return]


def scale(shape: Field, factor: SupportsFloat) -> Field:
    """The shape made larger or smaller, about the origin.

    The value is worth: as it was.
    """
    return called("scale", shape, factor)  # type: ignore[no-any-return]


@overload
def stretch(shape: Field, x: SupportsFloat, y: SupportsFloat, z: SupportsFloat = ...) -> Field: ...
@overload
def stretch(shape: Field, x: _Vector, y: None = None, z: SupportsFloat = ...) -> Field: ...
def stretch(shape: Field, x: SupportsFloat | _Vector, y: SupportsFloat | None = None, z: SupportsFloat = 1) -> Field:
    """The shape with its own factor along each axis.

    The value is worth: a lower bound.
    """
    if y is None:
        return called("stretch", shape, *_parts("stretch", x, y, 2))  # type: ignore[no-any-return]
    return called("stretch", shape, x, y, z)  # type: ignore[no-any-return]


@overload
def mirror(shape: Field, x: SupportsFloat, y: SupportsFloat, z: SupportsFloat = ...) -> Field: ...
@overload
def mirror(shape: Field, x: _Vector, y: None = None, z: SupportsFloat = ...) -> Field: ...
def mirror(shape: Field, x: SupportsFloat | _Vector, y: SupportsFloat | None = None, z: SupportsFloat = 0) -> Field:
    """The mirror image in the plane through the origin with this normal.

    The value is worth: as it was.
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
    """Copies of the shape, so far apart along each axis (0: no copies) and so many (0: without end).

    The value is worth: outside exact if it was, else a sign; inside a lower bound.
    """
    return called("repeat", shape, x, y, z, nx, ny, nz)  # type: ignore[no-any-return]


def linear(shape: Field, count: SupportsFloat, x: SupportsFloat, y: SupportsFloat = 0, z: SupportsFloat = 0) -> Field:
    """So many copies of the shape in a row, each moved by these lengths from the one before.

    The value is worth: outside as good as it was, inside a lower bound.
    """
    return called("linear", shape, count, x, y, z)  # type: ignore[no-any-return]


def polar(shape: Field, count: SupportsFloat, degrees: SupportsFloat = 360) -> Field:
    """So many copies of the shape around the z axis, evenly over an angle: a full turn, or from the first to the last.

    The value is worth: outside as good as it was, inside a lower bound.
    """
    return called("polar", shape, count, degrees)  # type: ignore[no-any-return]


def symmetric(shape: Field, x: SupportsFloat, y: SupportsFloat, z: SupportsFloat = 0) -> Field:
    """The shape and its mirror image in the plane through the origin with this normal.

    The value is worth: outside as good as it was, inside a lower bound.
    """
    return called("symmetric", shape, x, y, z)  # type: ignore[no-any-return]


def offset(shape: Field, by: SupportsFloat) -> Field:
    """The shape grown by a distance, or shrunk by a negative one; needs a distance on that side.

    The value is worth: exact on the side that the surface moved to, if it was exact there; else a lower bound.
    """
    return called("offset", shape, by)  # type: ignore[no-any-return]


def minkowski(shape: Field, radius: SupportsFloat) -> Field:
    """The Minkowski sum with a ball: all points nearer than a radius to the shape, whose value must be an exact distance
    outside.

    The value is worth: outside exact, inside a lower bound.
    """
    return called("minkowski", shape, radius)  # type: ignore[no-any-return]


def shell(shape: Field, thickness: SupportsFloat) -> Field:
    """A wall along the surface, half of its thickness to each side; needs a distance on both.

    The value is worth: outside exact if it was, inside a lower bound.
    """
    return called("shell", shape, thickness)  # type: ignore[no-any-return]


def redistance(shape: Field, within: SupportsFloat) -> Field:
    """The shape with a value that is a distance again, to triangles within a length of its surface.

    The value is worth: exact, of the triangles.
    """
    return called("redistance", shape, within)  # type: ignore[no-any-return]


def extrude(shape: Field, height: SupportsFloat, bevel: SupportsFloat = 0, rounded: SupportsFloat = 0) -> Field:
    """A shape of the plane made a solid of that height, half above and half below. A bevel cuts the edges of both ends
    off at 45 degrees, so wide and high; rounded, they are a quarter of a circle of that radius. Both go by the depths that
    the shape's value says.

    The value is worth: as it was; with a bevel or rounded edges a lower bound.
    """
    return called("extrude", shape, height, bevel, rounded)  # type: ignore[no-any-return]


def section(shape: Field, z: SupportsFloat = 0) -> Field:
    """The section of a solid with the plane at a height, as a shape of the plane.

    The value is worth: a lower bound.
    """
    return called("section", shape, z)  # type: ignore[no-any-return]


def taper(shape: Field, factor: SupportsFloat, height: SupportsFloat) -> Field:
    """A solid of that height, half above and half below, whose cross-section is the shape, scaled from 1 at the bottom to
    the factor at the top.

    The value is worth: a lower bound; a sign if the shape has only a sign or no end.
    """
    return called("taper", shape, factor, height)  # type: ignore[no-any-return]


def loft(shapes: Sequence[Field], height: SupportsFloat) -> Field:
    """A solid of that height, half above and half below, from the first of some shapes of the plane to the last. Those
    between draw it towards themselves, as control points draw a Bézier curve.

    The value is worth: a lower bound.
    """
    return called("loft", shapes, height)  # type: ignore[no-any-return]


def revolve(shape: Field) -> Field:
    """A shape of the plane turned about its y axis, which then stands along z.

    The value is worth: as it was, where the shape keeps off the axis.
    """
    return called("revolve", shape)  # type: ignore[no-any-return]


def twist(shape: Field, degrees: SupportsFloat) -> Field:
    """The shape turned about z by so much more with each unit of height.

    The value is worth: a lower bound, if it is bounded around the axis; else a sign.
    """
    return called("twist", shape, degrees)  # type: ignore[no-any-return]


def bend(shape: Field, degrees: SupportsFloat) -> Field:
    """The shape turned about z by so much more with each unit along x.

    The value is worth: a lower bound, if it is bounded around the axis; else a sign.
    """
    return called("bend", shape, degrees)  # type: ignore[no-any-return]


def displace(shape: Field, by: Formula | float, amplitude: SupportsFloat) -> Field:
    """The shape whose value has a formula added, which nowhere exceeds the amplitude in size.

    The value is worth: a sign.
    """
    return called("displace", shape, by, amplitude)  # type: ignore[no-any-return]


def color(shape: Field, color: str | Sequence[SupportsFloat]) -> Field:
    """The shape in a colour: a text as "#d33", "#dd3333" or "red", or a list of three or four numbers from 0 to 1. One
    given later replaces it.

    The value is worth: as it was.
    """
    return called("color", shape, color)  # type: ignore[no-any-return]


def material(
    shape: Field,
    name: str,
    color: str | Sequence[SupportsFloat],
    metallic: SupportsFloat = 0,
    roughness: SupportsFloat = 0.5,
) -> Field:
    """The shape of a material with a name, a colour as for color(), and how much it is a metal and how rough it is, from
    0 to 1.

    The value is worth: as it was.
    """
    return called("material", shape, name, color, metallic, roughness)  # type: ignore[no-any-return]


for _name, _function in list(globals().items()):
    # Guessed keywords, as in sphere(r=1), get an error that names the right one.
    if getattr(_function, "__module__", None) == __name__ and not _name.startswith("_"):
        globals()[_name] = keywords_hinted(_function)
