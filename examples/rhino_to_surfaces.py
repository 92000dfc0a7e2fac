"""Writes the surfaces of a Rhino file (.3dm) as NURBS surfaces in JSON, which `chordal mesh` reads.

    pip install rhino3dm
    python rhino_to_surfaces.py part.3dm part.json
    chordal mesh part.json --tol 0.01 -o part.glb

Surfaces, faces of polysurfaces and extrusions become one surface each, with its front outside. A face is *trimmed* where
its edges are not the sides of its surface. The JSON has no loops for that (docs/schema/surfaces.schema.json), so trimmed
faces are listed and left out, and the status is 1; with --whole they are written as their whole surfaces, which reach
beyond the face. Curves, meshes, SubDs, points and instances of blocks are listed and left out.
"""

import argparse
import json
import sys
from collections import Counter
from pathlib import Path

try:
    import rhino3dm
except ImportError as error:
    sys.exit(f"rhino3dm is needed, which reads Rhino's files: pip install rhino3dm ({error})")

METRES = {
    "Microns": 1e-6,
    "Millimeters": 0.001,
    "Centimeters": 0.01,
    "Decimeters": 0.1,
    "Meters": 1.0,
    "Kilometers": 1000.0,
    "Inches": 0.0254,
    "Feet": 0.3048,
    "Yards": 0.9144,
    "Miles": 1609.344,
}


def as_json(surface, is_reversed):
    """A NURBS surface as the schema has it: rows of control points, u along a row."""
    n_u, n_v = surface.Points.CountU, surface.Points.CountV
    columns = range(n_u - 1, -1, -1) if is_reversed else range(n_u)
    points = [[surface.Points.GetControlPoint(u, v) for u in columns] for v in range(n_v)]

    def knots(of_file):
        # Rhino leaves out the first and the last knot, which change nothing.
        inner = list(of_file)
        return [inner[0], *inner, inner[-1]]

    along_u = knots(surface.KnotsU)
    if is_reversed:
        along_u = [-knot for knot in reversed(along_u)]
    found = {
        "degree": [surface.OrderU - 1, surface.OrderV - 1],
        "knots": [along_u, knots(surface.KnotsV)],
        "control": [[[point.X / point.W, point.Y / point.W, point.Z / point.W] for point in row] for row in points],
    }
    if surface.IsRational:
        found["weights"] = [[point.W for point in row] for row in points]
    return found


def faces(geometry):
    """The surfaces of an object: each with whether its normal is turned and whether it is trimmed; none for others."""
    if isinstance(geometry, rhino3dm.Extrusion):
        geometry = geometry.ToBrep(True)
    if isinstance(geometry, rhino3dm.Brep):
        return [
            (face.UnderlyingSurface().ToNurbsSurface(), face.OrientationIsReversed, not face.DuplicateFace(False).IsSurface)
            for face in (geometry.Faces[k] for k in range(len(geometry.Faces)))
        ]
    if isinstance(geometry, rhino3dm.Surface):
        return [(geometry.ToNurbsSurface(), False, False)]
    return []


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("input", type=Path, help=".3dm")
    parser.add_argument("output", type=Path, help=".json")
    parser.add_argument("--whole", action="store_true", help="write trimmed faces too, as their whole surfaces")
    arguments = parser.parse_args()
    model = rhino3dm.File3dm.Read(str(arguments.input))
    if model is None:
        sys.exit(f"{arguments.input}: this is no file of Rhino that can be read")
    surfaces, others, n_trimmed, n_faces = [], Counter(), 0, 0
    for number, item in enumerate(model.Objects):
        found = faces(item.Geometry)
        if not found:
            others[type(item.Geometry).__name__] += 1
        for face, (surface, is_reversed, is_trimmed) in enumerate(found):
            n_faces += 1
            if is_trimmed:
                n_trimmed += 1
                done = "written as its whole surface" if arguments.whole else "left out"
                name = f" '{item.Attributes.Name}'" if item.Attributes.Name else ""
                print(f"face {face} of object {number}{name} is trimmed: {done}", file=sys.stderr)
            if not is_trimmed or arguments.whole:
                surfaces.append(as_json(surface, is_reversed))
    for kind, n in sorted(others.items()):
        print(f"left out: {n} {kind}", file=sys.stderr)
    n = len(surfaces)
    if n > 0:
        shape = {"up": "z", "surfaces": surfaces}
        unit = METRES.get(str(model.Settings.ModelUnitSystem).split(".")[-1])
        if unit is not None:
            shape["metres_per_unit"] = unit
        arguments.output.write_text(json.dumps(shape))
    print(f"{n} surface{'' if n == 1 else 's'} written, {n_trimmed} of {n_faces} faces trimmed", file=sys.stderr)
    return 1 if n_trimmed > 0 or n == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
