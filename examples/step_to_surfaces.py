"""Writes the faces of a CAD file (STEP, IGES or BREP) as NURBS surfaces in JSON, which `chordal mesh` reads.

    pip install cadquery-ocp
    python step_to_surfaces.py part.step part.json
    chordal mesh part.json --tol 0.01 -o part.glb

Every face becomes one surface over its rectangle of parameters, with its front outside. A face is *trimmed* where its
edges do not run along the sides of that rectangle: a plane with a hole, the round lid of a cylinder. The JSON has no
loops for that (docs/schema/surfaces.schema.json), so trimmed faces are listed and left out, and the status is 1; with
--whole they are written as their whole rectangles, which reach beyond the face.
"""

import argparse
import json
import sys
from pathlib import Path

try:
    from OCP.BRep import BRep_Builder, BRep_Tool
    from OCP.BRepAdaptor import BRepAdaptor_Curve2d, BRepAdaptor_Surface
    from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert
    from OCP.BRepGProp import BRepGProp
    from OCP.BRepTools import BRepTools
    from OCP.GProp import GProp_GProps
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.IGESControl import IGESControl_Reader
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_REVERSED, TopAbs_WIRE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS, TopoDS_Shape
except ImportError as error:
    sys.exit(f"cadquery-ocp is needed, which reads CAD files: pip install cadquery-ocp ({error})")


def static(owner, name):
    """A function of a class, which bindings before version 8 spell with `_s` at the end."""
    return getattr(owner, name + "_s", None) or getattr(owner, name)


# Parameters of an edge at which it is compared with the rectangle. Chosen: a curve that bends away from a straight
# side and back eight times over is no side of anything.
STEPS = 16
# A share of the rectangle's sides. Chosen: far above rounding, far below what is seen.
NEAR = 1e-7


def read(path):
    """The shape of a file, in millimetres."""
    kind = path.suffix.lower()
    if kind == ".brep":
        shape = TopoDS_Shape()
        if not static(BRepTools, "Read")(shape, str(path), BRep_Builder()):
            sys.exit(f"{path}: this is no BREP that can be read")
        return shape
    reader = IGESControl_Reader() if kind in (".igs", ".iges") else STEPControl_Reader()
    if reader.ReadFile(str(path)) != IFSelect_RetDone:
        sys.exit(f"{path}: this is no STEP or IGES file that can be read")
    reader.TransferRoots()
    return reader.OneShape()


def parts(shape, kind, cast):
    """The faces of a shape, or the wires or edges of a face."""
    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        yield cast(explorer.Current())
        explorer.Next()


def is_whole(face, rectangle):
    """Whether all edges of a face run along the sides of its rectangle of parameters."""
    u0, u1, v0, v1 = rectangle
    near_u, near_v = NEAR * (u1 - u0), NEAR * (v1 - v0)
    for edge in parts(face, TopAbs_EDGE, static(TopoDS, "Edge")):
        curve = BRepAdaptor_Curve2d(edge, face)
        first, last = curve.FirstParameter(), curve.LastParameter()
        points = [curve.Value(first + (last - first) * k / STEPS) for k in range(STEPS + 1)]
        sides = [
            all(abs(point.X() - u0) <= near_u for point in points),
            all(abs(point.X() - u1) <= near_u for point in points),
            all(abs(point.Y() - v0) <= near_v for point in points),
            all(abs(point.Y() - v1) <= near_v for point in points),
        ]
        if not any(sides):
            return False
    return True


def spline(face, rectangle):
    """The surface of a face over its rectangle, as a B-spline whose front is the face's."""
    found = static(BRep_Tool, "Surface")(face).Copy()
    around = found.Bounds()
    parts_of_it = []
    for side, release in ((0, found.SetUNotPeriodic), (2, found.SetVNotPeriodic)):
        (first, last), (low, high) = around[side : side + 2], rectangle[side : side + 2]
        near = NEAR * (last - first)
        if high - low >= last - first - near:
            # All of it, wherever a closed one is said to begin.
            release()
            low, high = first, last
        parts_of_it += [first if abs(low - first) <= near else low, last if abs(high - last) <= near else high]
    if parts_of_it != list(around):
        found.Segment(*parts_of_it)
        found.SetUNotPeriodic()
        found.SetVNotPeriodic()
    if face.Orientation() == TopAbs_REVERSED:
        found.UReverse()
    return found


def as_json(surface):
    """A B-spline as the schema has it: rows of control points, u along a row."""
    n_u, n_v = surface.NbUPoles(), surface.NbVPoles()

    def rows(value):
        return [[value(u, v) for u in range(1, n_u + 1)] for v in range(1, n_v + 1)]

    def knots(n, knot, multiplicity):
        return [knot(k) for k in range(1, n + 1) for _ in range(multiplicity(k))]

    def point(u, v):
        pole = surface.Pole(u, v)
        return [pole.X(), pole.Y(), pole.Z()]

    found = {
        "degree": [surface.UDegree(), surface.VDegree()],
        "knots": [
            knots(surface.NbUKnots(), surface.UKnot, surface.UMultiplicity),
            knots(surface.NbVKnots(), surface.VKnot, surface.VMultiplicity),
        ],
        "control": rows(point),
    }
    if surface.IsURational() or surface.IsVRational():
        found["weights"] = rows(surface.Weight)
    return found


def area(shape):
    properties = GProp_GProps()
    static(BRepGProp, "SurfaceProperties")(shape, properties)
    return properties.Mass()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("input", type=Path, help=".step, .stp, .iges, .igs or .brep")
    parser.add_argument("output", type=Path, help=".json")
    parser.add_argument("--whole", action="store_true", help="write trimmed faces too, as their whole rectangles")
    arguments = parser.parse_args()
    shape = read(arguments.input)
    faces = list(parts(shape, TopAbs_FACE, static(TopoDS, "Face")))
    converted = BRepBuilderAPI_NurbsConvert(shape, True).Shape()
    surfaces, n_trimmed = [], 0
    for number, face in enumerate(parts(converted, TopAbs_FACE, static(TopoDS, "Face"))):
        rectangle = static(BRepTools, "UVBounds")(face)
        whole = is_whole(face, rectangle)
        if not whole:
            n_trimmed += 1
            n_loops = len(list(parts(face, TopAbs_WIRE, static(TopoDS, "Wire"))))
            done = "written as its whole rectangle" if arguments.whole else "left out"
            kind = str(BRepAdaptor_Surface(faces[number]).GetType()).split("_")[-1]
            loops = f"{n_loops} loop{'s' if n_loops > 1 else ''}"
            print(
                f"face {number} ({kind}, area {area(faces[number]):.6g}) is trimmed by {loops}: {done}",
                file=sys.stderr,
            )
        if whole or arguments.whole:
            surfaces.append(as_json(spline(face, rectangle)))
    n = len(surfaces)
    if n > 0:
        arguments.output.write_text(json.dumps({"up": "z", "metres_per_unit": 0.001, "surfaces": surfaces}))
    print(f"{n} surface{'' if n == 1 else 's'} written, {n_trimmed} of {len(faces)} faces trimmed", file=sys.stderr)
    return 1 if n_trimmed > 0 or n == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
