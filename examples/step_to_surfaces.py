"""Writes the faces of a CAD file (STEP, IGES or BREP) as trimmed NURBS surfaces in JSON, which `chordal mesh` reads.

    pip install cadquery-ocp
    python step_to_surfaces.py part.step part.json
    chordal mesh part.json --tol 0.01 -o part.glb

Every face becomes a surface with the loops that its edges are in its parameter plane, and with its front outside.
Chordal sews faces where they meet, so that a solid becomes a closed mesh.
"""

import argparse
import json
import sys
from pathlib import Path

try:
    from OCP.BRep import BRep_Builder, BRep_Tool
    from OCP.BRepAdaptor import BRepAdaptor_Curve2d
    from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert
    from OCP.BRepTools import BRepTools, BRepTools_WireExplorer
    from OCP.Geom2d import Geom2d_TrimmedCurve
    from OCP.Geom2dConvert import Geom2dConvert
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.IGESControl import IGESControl_Reader
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_FACE, TopAbs_FORWARD, TopAbs_REVERSED, TopAbs_WIRE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS, TopoDS_Shape
except ImportError as error:
    sys.exit(f"cadquery-ocp is needed, which reads CAD files: pip install cadquery-ocp ({error})")


# A share of a surface's range of parameters. Chosen: far above rounding, far below what is seen.
NEAR = 1e-9


def static(owner, name):
    """A function of a class, which bindings before version 8 spell with `_s` at the end."""
    return getattr(owner, name + "_s", None) or getattr(owner, name)


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
    """The faces of a shape, or the wires of a face."""
    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        yield cast(explorer.Current())
        explorer.Next()


def repeated(n, knot, multiplicity):
    return [knot(k) for k in range(1, n + 1) for _ in range(multiplicity(k))]


def surface_json(surface):
    """A B-spline surface as the schema has it: rows of control points, u along a row."""
    n_u, n_v = surface.NbUPoles(), surface.NbVPoles()

    def rows(value):
        return [[value(u, v) for u in range(1, n_u + 1)] for v in range(1, n_v + 1)]

    def point(u, v):
        pole = surface.Pole(u, v)
        return [pole.X(), pole.Y(), pole.Z()]

    found = {
        "degree": [surface.UDegree(), surface.VDegree()],
        "knots": [
            repeated(surface.NbUKnots(), surface.UKnot, surface.UMultiplicity),
            repeated(surface.NbVKnots(), surface.VKnot, surface.VMultiplicity),
        ],
        "control": rows(point),
    }
    if surface.IsURational() or surface.IsVRational():
        found["weights"] = rows(surface.Weight)
    return found


def curve_json(edge, face):
    """An edge in the plane of a face's parameters, in the direction of its wire."""
    own = BRepAdaptor_Curve2d(edge, face)
    part = Geom2d_TrimmedCurve(own.Curve(), own.FirstParameter(), own.LastParameter())
    spline = static(Geom2dConvert, "CurveToBSplineCurve")(part)
    if spline.IsPeriodic():
        spline.SetNotPeriodic()
    if edge.Orientation() == TopAbs_REVERSED:
        spline.Reverse()
    n = spline.NbPoles()
    found = {
        "degree": spline.Degree(),
        "knots": repeated(spline.NbKnots(), spline.Knot, spline.Multiplicity),
        "control": [[spline.Pole(k).X(), spline.Pole(k).Y()] for k in range(1, n + 1)],
    }
    if spline.IsRational():
        found["weights"] = [spline.Weight(k) for k in range(1, n + 1)]
    return found


def face_json(face):
    """A face as a surface with its loops; turned over where its front is the surface's back."""
    surface = static(BRep_Tool, "Surface")(face).Copy()
    rectangle = static(BRepTools, "UVBounds")(face)
    parts_of_it, around = [], surface.Bounds()
    for side, release in ((0, surface.SetUNotPeriodic), (2, surface.SetVNotPeriodic)):
        (first, last), (low, high) = around[side : side + 2], rectangle[side : side + 2]
        near = NEAR * (last - first)
        if first - near <= low and high <= last + near:
            # Its loops stay within its parameters, wherever a closed one is said to begin.
            release()
            low, high = first, last
        parts_of_it += [low, high]
    if parts_of_it != list(around):
        surface.Segment(*parts_of_it)
        surface.SetUNotPeriodic()
        surface.SetVNotPeriodic()
    front = static(TopoDS, "Face")(face.Oriented(TopAbs_FORWARD))
    found = surface_json(surface)
    found["trim"] = []
    for wire in parts(front, TopAbs_WIRE, static(TopoDS, "Wire")):
        explorer, loop = BRepTools_WireExplorer(wire, front), []
        while explorer.More():
            loop.append(curve_json(explorer.Current(), front))
            explorer.Next()
        found["trim"].append(loop)
    if face.Orientation() == TopAbs_REVERSED:
        found["flip"] = True
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("input", type=Path, help=".step, .stp, .iges, .igs or .brep")
    parser.add_argument("output", type=Path, help=".json")
    arguments = parser.parse_args()
    converted = BRepBuilderAPI_NurbsConvert(read(arguments.input), True).Shape()
    faces = [face_json(face) for face in parts(converted, TopAbs_FACE, static(TopoDS, "Face"))]
    if not faces:
        sys.exit(f"{arguments.input}: there is no face in it")
    arguments.output.write_text(json.dumps({"up": "z", "metres_per_unit": 0.001, "surfaces": faces}))
    print(f"{len(faces)} faces written", file=sys.stderr)


if __name__ == "__main__":
    main()
