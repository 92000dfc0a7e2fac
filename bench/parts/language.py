"""The functions of shape scripts that everyday parts use, of Manifold's solids and cross-sections; and running a script of them.

What is made of planes is exact. A curve has so many segments that it is within the tolerance where it is made.
"""

import ast
import math
from dataclasses import dataclass
from importlib.metadata import version

from manifold3d import CrossSection, FillRule, JoinType, Manifold, OpType

#: The triangles of Manifold's sphere are off it by up to so many times the sagitta of its great circles.
SPHERE = 2.7
VERSION = version("manifold3d")
#: The variable that the value of the last expression is put into.
VALUE = "the value"


@dataclass
class HalfSpace:
    """What is below a plane, which Manifold has no solid for: it can trim one."""

    normal: list
    offset: float = 0


def common(a, b):
    """The operator `&`."""
    if isinstance(b, HalfSpace):
        return a.trim_by_plane([-part for part in b.normal], -b.offset)
    return a ^ b


for kind in (Manifold, CrossSection):
    kind.__or__, kind.__and__ = kind.__add__, common


def vector(x, y, z):
    """Three numbers, or one list of them."""
    return (x, y, z) if y is not None else (*x, z)[:3]


def union(*shapes):
    """Of shapes, or of lists of them."""
    every = [shape for some in shapes for shape in (some if isinstance(some, list) else [some])]
    return type(every[0]).batch_boolean(every, OpType.Add)


def placed(name):
    """A function that places or stretches a shape by a vector, by Manifold's method of a name."""
    def function(shape, x, y=None, z=1 if name == "scale" else 0):
        by = vector(x, y, z)
        return getattr(shape, name)(by[:2] if isinstance(shape, CrossSection) else by)

    return function


#: Curves keep the segments that they had before they are stretched.
move, stretch, mirror = placed("translate"), placed("scale"), placed("mirror")


def rotate_z(shape, degrees):
    return shape.rotate(degrees if isinstance(shape, CrossSection) else (0, 0, degrees))


def taper(shape, factor, height):
    return shape.extrude(height, 0, 0, (factor, factor)).translate((0, 0, -height / 2))


def linear(shape, count, x, y=0, z=0):
    return union([move(shape, k * x, k * y, k * z) for k in range(count)])


def polar(shape, count, degrees=360):
    step = degrees / (count if degrees == 360 else count - 1)
    return union([rotate_z(shape, k * step) for k in range(count)])


def repeat(shape, x=0, y=0, z=0, nx=0, ny=0, nz=0):
    """So many copies, not those without end."""
    return linear(linear(linear(shape, nx or 1, x), ny or 1, 0, y), nz or 1, 0, 0, z)


EXACT = {
    "box": lambda x, y=None, z=0: Manifold.cube(vector(x, y, z), True),
    "prism": lambda sides, radius, height: Manifold.cylinder(height, radius, radius, sides, True),
    "rectangle": lambda x, y: CrossSection.square((x, y), True),
    "polygon": lambda points: CrossSection([points], FillRule.NonZero),
    "plane": HalfSpace,
    "extrude": lambda shape, height: taper(shape, 1, height),
    "taper": taper,
    "union": union, "move": move, "stretch": stretch, "mirror": mirror,
    "scale": lambda shape, factor: stretch(shape, factor, factor, factor),
    "rotate_x": lambda shape, degrees: shape.rotate((degrees, 0, 0)),
    "rotate_y": lambda shape, degrees: shape.rotate((0, degrees, 0)),
    "rotate_z": rotate_z,
    "linear": linear, "polar": polar, "repeat": repeat,
    "symmetric": lambda shape, x, y=None, z=0: shape + mirror(shape, x, y, z),
    "param": lambda name, value: value,
    **{name: getattr(math, name) for name in "sqrt exp log sin cos tan asin acos atan atan2 floor ceil radians pi".split()},
}


class Curved:
    """The functions whose shapes are curved, within a tolerance."""

    def __init__(self, tolerance):
        self._tolerance = tolerance

    def _segments(self, radius, share=1.0):
        """How many segments of a circle have a sagitta of at most a share of the tolerance."""
        allowed = share * self._tolerance
        return max(3, math.ceil(math.pi / math.acos(1 - min(allowed / radius, 1)))) if radius > 0 else 3

    def cylinder(self, radius, height):
        return Manifold.cylinder(height, radius, radius, self._segments(radius), True)

    def cone(self, bottom, top, height):
        return Manifold.cylinder(height, bottom, top, self._segments(max(bottom, top)), True)

    def sphere(self, radius):
        return Manifold.sphere(radius, self._segments(radius, 1 / SPHERE))

    def ellipsoid(self, x, y, z):
        return Manifold.sphere(1, self._segments(max(x, y, z), 1 / SPHERE)).scale((x, y, z))

    def torus(self, major, minor):
        """Half of the tolerance for either circle."""
        tube = CrossSection.circle(minor, self._segments(minor, 0.5)).translate((major, 0))
        return tube.revolve(self._segments(major + minor, 0.5))

    def capsule(self, a, b, radius):
        """Half of the tolerance for either circle: its profile is turned, and laid from one point to the other."""
        along = [q - p for p, q in zip(a, b, strict=True)]
        length = math.hypot(*along)
        count = self._segments(radius, 0.5)
        quarter = math.ceil(count / 4)
        steps = [math.pi / 2 * k / quarter for k in range(quarter + 1)]
        upper = [(radius * math.sin(math.pi / 2 - t), length + radius * math.sin(t)) for t in steps]
        lower = [(r, length - height) for r, height in reversed(upper)]
        turn = (0, math.degrees(math.acos(along[2] / length)), math.degrees(math.atan2(along[1], along[0])))
        return CrossSection([lower + upper]).revolve(count).rotate(turn).translate(a)

    def sweep(self, path, radius):
        """A tube along the straight lines through points."""
        return union([self.capsule(a, b, radius) for a, b in zip(path, path[1:])])

    def hull(self, points, radius=0):
        """Of points, or of balls around them."""
        if not radius:
            return Manifold.hull_points(points)
        ball = self.sphere(radius)
        return Manifold.batch_hull([ball.translate(point) for point in points])

    def rounded_box(self, x, y, z, radius):
        halves = [(-size / 2 + radius, size / 2 - radius) for size in (x, y, z)]
        return self.hull([[a, b, c] for a in halves[0] for b in halves[1] for c in halves[2]], radius)

    def minkowski(self, shape, radius):
        return shape.minkowski_sum(self.sphere(radius))

    def circle(self, radius):
        return CrossSection.circle(radius, self._segments(radius))

    def segment(self, a, b, radius):
        end = self.circle(radius)
        return CrossSection.batch_hull([end.translate(a), end.translate(b)])

    def offset(self, shape, by):
        return shape.offset(by, JoinType.Round, 2, self._segments(abs(by)))

    def rounded_rectangle(self, x, y, radius):
        return self.offset(CrossSection.square((x - 2 * radius, y - 2 * radius), True), radius)

    def revolve(self, shape):
        """Of straight lines: their own error would be added."""
        return shape.revolve(self._segments(shape.bounds()[2]))


def compiled(text):
    """A script as Python, which keeps the value of its last expression."""
    tree = ast.parse(text)
    last = tree.body[-1]
    target = ast.Name(VALUE, ast.Store())
    tree.body[-1] = ast.copy_location(ast.Assign([target], last.value), last)
    return compile(ast.fix_missing_locations(tree), "script", "exec")


def names(tolerance):
    """What a script finds around it."""
    curved = Curved(tolerance)
    return EXACT | {name: getattr(curved, name) for name in vars(Curved) if not name.startswith("_")}


def made(code, around):
    """The solids that a script makes."""
    exec(code, around)
    value = around[VALUE]
    return list(value.values()) if isinstance(value, dict) else value if isinstance(value, list) else [value]
