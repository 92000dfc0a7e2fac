"""A NURBS torus: triangles, time and true error beside OpenCASCADE at the same tolerance.

    python bench/patches/nurbs.py CHORDAL

prints a table. The error is that of samples of each triangle against the torus' equation.
"""

import json
import math
import pathlib
import subprocess
import sys
import tempfile
import time

RING, TUBE = 2.0, 0.5
TOLERANCES = [7e-2, 7e-3, 7e-4]
INSIDE = [(1 / 3, 1 / 3, 1 / 3), (0.5, 0.5, 0), (0, 0.5, 0.5), (0.5, 0, 0.5)]


def torus() -> dict:
    """The surface as Chordal's JSON has it."""
    corner = math.sqrt(0.5)
    knots = [0, 0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1, 1]
    around = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]
    rows = [[[(RING + TUBE * a) * x, (RING + TUBE * a) * y, TUBE * b] for x, y in around] for a, b in around]
    weight = [1, corner] * 4 + [1]
    return {
        "surfaces": [
            {
                "degree": [2, 2],
                "knots": [knots, knots],
                "control": rows,
                "weights": [[u * v for u in weight] for v in weight],
            }
        ]
    }


def error(triangles, tolerance) -> tuple[float, int]:
    """The largest error of samples, and how many triangles are beyond the tolerance."""
    worst, over = 0.0, 0
    for corners in triangles:
        here = 0.0
        for weights in INSIDE:
            x, y, z = (sum(w * p[k] for w, p in zip(weights, corners)) for k in range(3))
            here = max(here, abs(math.hypot(math.hypot(x, y) - RING, z) - TUBE))
        worst, over = max(worst, here), over + (here > tolerance)
    return worst, over


def opencascade(tolerance: float):
    """Triangles and seconds of OpenCASCADE, without its limit of angles."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.Geom import Geom_ToroidalSurface
    from OCP.GeomConvert import GeomConvert
    from OCP.gp import gp_Ax3, gp_Dir, gp_Pnt
    from OCP.TopLoc import TopLoc_Location

    frame = gp_Ax3(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))
    surface = GeomConvert.SurfaceToBSplineSurface_s(Geom_ToroidalSurface(frame, RING, TUBE))
    best = math.inf
    for _ in range(3):
        face = BRepBuilderAPI_MakeFace(surface, 1e-7).Face()
        start = time.perf_counter()
        BRepMesh_IncrementalMesh(face, tolerance, False, math.pi, False)
        best = min(best, time.perf_counter() - start)
    made = BRep_Tool.Triangulation_s(face, TopLoc_Location())
    nodes = [made.Node(i + 1) for i in range(made.NbNodes())]
    points = [(p.X(), p.Y(), p.Z()) for p in nodes]
    faces = [made.Triangle(i + 1).Get() for i in range(made.NbTriangles())]
    return [[points[i - 1] for i in face] for face in faces], best


def chordal(command: str, tolerance: float):
    """Triangles, seconds of the whole command less those of its start, and the bound, on one thread."""
    with tempfile.TemporaryDirectory() as folder:
        source, target = pathlib.Path(folder, "torus.json"), pathlib.Path(folder, "torus.stl")
        source.write_text(json.dumps(torus()))
        line = [command, "mesh", source, "--tol", str(tolerance), "-o", target, "--force", "--json", "--threads", "1"]
        reports = [json.loads(subprocess.run(line, check=True, capture_output=True).stdout) for _ in range(3)]
        data = target.read_bytes()
    import struct

    count = struct.unpack_from("<I", data, 80)[0]
    corners = [struct.unpack_from("<9f", data, 84 + 50 * i + 12) for i in range(count)]
    bound = reports[0]["certificate"]["bound"]["at_most"]
    seconds = min(report["run"]["seconds"] for report in reports)
    return [[c[0:3], c[3:6], c[6:9]] for c in corners], seconds, bound


def main() -> None:
    print("| tolerance | Chordal | ms | bound | worst sample | OpenCASCADE | ms | worst sample | over |")
    print("|---|---|---|---|---|---|---|---|---|")
    for tolerance in TOLERANCES:
        ours, seconds, bound = chordal(sys.argv[1], tolerance)
        theirs, slow = opencascade(tolerance)
        off, _ = error(ours, tolerance)
        their_off, over = error(theirs, tolerance)
        print(
            f"| {tolerance:g} | {len(ours):,} | {seconds * 1e3:.0f} | {bound:.3g} | {off:.3g} "
            f"| {len(theirs):,} | {slow * 1e3:.0f} | {their_off:.3g} | {over} |"
        )


if __name__ == "__main__":
    main()
