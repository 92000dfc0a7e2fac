"""The bench of splines, surfaces and faces: Chordal beside OpenCASCADE and geomdl at the same tolerance.

Surfaces have a closed form or a profile, against which samples of each triangle are measured. Curves are measured at
their parameters by de Boor's algorithm. Faces are solids that OpenCASCADE makes, through examples/step_to_surfaces.py.

Prints tables, and writes them to RESULTS.md.
"""

import json
import math
import random
import statistics
import struct
import subprocess
import sys
import time
from datetime import date
from importlib.metadata import version
from pathlib import Path

BENCH = Path(__file__).resolve().parent.parent
sys.path += [str(BENCH), str(BENCH.parent / "examples")]
import section  # noqa: E402

OUT = BENCH / "out"
RING, TUBE, BALL = 2.0, 0.5, 1.0
# Of the diagonals, some 5.2, 3.5 and 4.
TOLERANCES = ["5e-2", "5e-3", "5e-4"]
CURVE_TOLERANCES = ["1e-2", "1e-3", "1e-4"]
SOLID_TOLERANCES = ["1e-1", "1e-2"]
INSIDE = [(1 / 3, 1 / 3, 1 / 3), (0.5, 0.5, 0), (0, 0.5, 0.5), (0.5, 0, 0.5), (0.6, 0.2, 0.2), (0.2, 0.6, 0.2), (0.2, 0.2, 0.6)]
CORNER = math.sqrt(0.5)
QUARTERS = [0, 0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1, 1]
AROUND = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]
CIRCLE = [1, CORNER] * 4 + [1]


def revolved(degree, knots, profile, weights):
    """The surface of a profile (radius, height) around z, as Chordal's JSON has it."""
    return {
        "degree": [2, degree],
        "knots": [QUARTERS, knots],
        "control": [[[r * x, r * y, z] for x, y in AROUND] for r, z in profile],
        "weights": [[u * v for u in CIRCLE] for v in weights],
    }


def torus():
    profile = [(RING + TUBE * a, TUBE * b) for a, b in AROUND]
    return revolved(2, QUARTERS, profile, CIRCLE), lambda r, z: abs(math.hypot(r - RING, z) - TUBE)


def ball():
    profile = [(BALL * a, BALL * b) for a, b in [(0, -1), (1, -1), (1, 0), (1, 1), (0, 1)]]
    knots = [0, 0, 0, 0.5, 0.5, 1, 1, 1]
    return revolved(2, knots, profile, [1, CORNER, 1, CORNER, 1]), lambda r, z: abs(math.hypot(r, z) - BALL)


def goblet():
    """A cubic B-spline around z."""
    profile = [(0.9, 0), (0.9, 0.1), (0.15, 0.2), (0.12, 1.2), (0.9, 1.4), (1.1, 2.2), (0.8, 3.0)]
    knots = [0, 0, 0, 0, 0.25, 0.5, 0.75, 1, 1, 1, 1]
    close = [de_boor(3, knots, [(*p, 1.0) for p in profile], k / 5000)[:2] for k in range(5001)]
    heights = [z for _, z in close]

    def off(r, z):
        # The profile rises all along, so that the nearest of its chords are about as high.
        from bisect import bisect

        low, high = bisect(heights, z - 0.1), bisect(heights, z + 0.1)
        near = min(range(max(low, 1), min(high, 5000)), key=lambda k: math.dist(close[k], (r, z)))
        return min(to_segment((r, z), close[k], close[k + 1]) for k in (near - 1, near))

    return revolved(3, knots, profile, [1] * len(profile)), off


def to_segment(p, a, b):
    ab = [y - x for x, y in zip(a, b)]
    square = sum(x * x for x in ab) or 1.0
    t = min(max(sum((x - y) * d for x, y, d in zip(p, a, ab)) / square, 0), 1)
    return math.dist(p, [x + t * d for x, d in zip(a, ab)])


def de_boor(degree, knots, points, t):
    """A rational spline's point; its control points are homogeneous."""
    n = len(points)
    k = max(j for j in range(degree, n) if knots[j] <= t and knots[j] < knots[j + 1])
    row = [list(points[j + k - degree]) for j in range(degree + 1)]
    for r in range(1, degree + 1):
        for j in range(degree, r - 1, -1):
            low, high = knots[j + k - degree], knots[j + 1 + k - r]
            part = (t - low) / (high - low)
            row[j] = [(1 - part) * x + part * y for x, y in zip(row[j - 1], row[j])]
    *x, w = row[degree]
    return [c / w for c in x] + [w]


SURFACES = {
    "torus": ("radii 2 and 0.5, biquadratic, rational", torus),
    "ball": ("radius 1, biquadratic, rational, two poles", ball),
    "goblet": ("a cubic B-spline of 7 points around z", goblet),
}


def program(file, tolerances):
    """Chordal's results by tolerance: triangles or segments, seconds, bound."""
    line = [BENCH / "target" / "release" / "nurbs", file, *tolerances]
    done = subprocess.run(line, check=True, stdout=subprocess.PIPE, text=True)
    rows = (row.split(",") for row in done.stdout.split())
    return {row[0]: (int(row[1]), float(row[2]), float(row[3])) for row in rows if row[1]}


def dumped(tolerance):
    """Positions and triangles of each shape that Chordal made."""
    data = (OUT / f"nurbs.{tolerance}.mesh").read_bytes()
    at = 0
    while at < len(data):
        n, m = struct.unpack_from("<II", data, at)
        points = list(struct.iter_unpack("<3d", data[at + 8 : at + 8 + 24 * n]))
        at += 8 + 24 * n
        yield points, list(struct.iter_unpack("<3I", data[at : at + 12 * m]))
        at += 12 * m


def errors(points, faces, off, tolerance):
    """The largest error of samples of every k-th triangle, some 3,000 in all, and how many of them are beyond the tolerance."""
    worst, over = 0.0, 0
    for face in faces[:: max(1, len(faces) // 3000)]:
        corners = [points[k] for k in face]
        here = 0.0
        for weights in INSIDE:
            x, y, z = (sum(w * p[k] for w, p in zip(weights, corners)) for k in range(3))
            here = max(here, off(math.hypot(x, y), z))
        worst, over = max(worst, here), over + (here > tolerance)
    return worst, over


def timed(run, fresh=lambda: None):
    """What a call gives, and the median of its CPU seconds."""
    times = []
    for _ in range(3):
        given = fresh()
        start = time.process_time()
        made = run(given)
        times.append(time.process_time() - start)
    return made, statistics.median(times)


def static(owner, name):
    return getattr(owner, name + "_s", None) or getattr(owner, name)


def occt_knots(knots):
    """Different knots, and how often each of them occurs."""
    from OCP.collections import Array1_double, Array1_int

    once = sorted(set(knots))
    values, times = Array1_double(1, len(once)), Array1_int(1, len(once))
    for k, value in enumerate(once):
        values.SetValue(k + 1, value)
        times.SetValue(k + 1, knots.count(value))
    return values, times


def occt_surface(surface):
    """The same surface in OpenCASCADE."""
    from OCP.collections import Array2_double, Array2_gp_Pnt
    from OCP.Geom import Geom_BSplineSurface
    from OCP.gp import gp_Pnt

    control, weights = surface["control"], surface["weights"]
    n, m = len(control[0]), len(control)
    poles, heavy = Array2_gp_Pnt(1, n, 1, m), Array2_double(1, n, 1, m)
    for j in range(m):
        for i in range(n):
            poles.SetValue(i + 1, j + 1, gp_Pnt(*control[j][i]))
            heavy.SetValue(i + 1, j + 1, weights[j][i])

    (u, nu), (v, nv) = (occt_knots(of) for of in surface["knots"])
    return Geom_BSplineSurface(poles, heavy, u, v, nu, nv, *surface["degree"], False, False)


def occt_mesh(surface, tolerance):
    """OpenCASCADE's triangles, without its limit of angles."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.TopLoc import TopLoc_Location

    made = occt_surface(surface)

    def run(face):
        BRepMesh_IncrementalMesh(face, tolerance, False, math.pi, False)
        return face

    face, seconds = timed(run, lambda: BRepBuilderAPI_MakeFace(made, 1e-7).Face())
    mesh = static(BRep_Tool, "Triangulation")(face, TopLoc_Location())
    nodes = [mesh.Node(k + 1) for k in range(mesh.NbNodes())]
    faces = [tuple(k - 1 for k in mesh.Triangle(k + 1).Get()) for k in range(mesh.NbTriangles())]
    return [(p.X(), p.Y(), p.Z()) for p in nodes], faces, seconds


def geomdl_mesh(surface, off, tolerance):
    """geomdl's triangles with the least number of equal steps whose samples are within the tolerance: it knows none."""
    from geomdl import NURBS

    control, weights = surface["control"], surface["weights"]
    n, m = len(control[0]), len(control)
    made = NURBS.Surface()
    made.degree_u, made.degree_v = surface["degree"]
    made.ctrlpts_size_u, made.ctrlpts_size_v = n, m
    order = [(i, j) for i in range(n) for j in range(m)]
    made.ctrlptsw = [[*(c * weights[j][i] for c in control[j][i]), weights[j][i]] for i, j in order]
    made.knotvector_u, made.knotvector_v = (list(map(float, of)) for of in surface["knots"])
    steps = 8
    while True:
        made.sample_size = steps
        start = time.process_time()
        made.tessellate()
        seconds = time.process_time() - start
        points = [tuple(vertex.data) for vertex in made.vertices]
        faces = [tuple(face.vertex_ids) for face in made.faces]
        worst, over = errors(points, faces, off, tolerance)
        if over == 0:
            return points, faces, seconds
        if steps > 120:
            return None
        steps = math.ceil(steps * max(1.1, min(2, math.sqrt(worst / tolerance))))


def surfaces():
    lines = [
        "| surface | tolerance | engine | triangles | × OCCT | CPU ms | OCCT / it | bound | worst sample | over |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for name, (about, make) in SURFACES.items():
        surface, off = make()
        file = OUT / f"{name}.json"
        file.write_text(json.dumps({"surfaces": [surface]}))
        ours = program(file, TOLERANCES)
        for text in TOLERANCES:
            tolerance = float(text)
            points, faces, slow = occt_mesh(surface, tolerance)
            base, rows = len(faces), []
            ((mine, triangles),) = dumped(text)
            n, seconds, bound = ours[text]
            rows.append(("Chordal, proved", n, seconds, f"{bound:.3g}", *errors(mine, triangles, off, tolerance)))
            rows.append(("OpenCASCADE", base, slow, "none", *errors(points, faces, off, tolerance)))
            # Beyond, it and the samples take minutes.
            peer = geomdl_mesh(surface, off, tolerance) if tolerance > 1e-3 else None
            if peer:
                rows.append(("geomdl, the fewest steps", len(peer[1]), peer[2], "none", *errors(*peer[:2], off, tolerance)))
            for engine, count, seconds, bound, worst, over in rows:
                lines.append(
                    f"| {name}: {about} | {text} | {engine} | {count:,} | {count / base:.2f} | {1e3 * seconds:.2f} "
                    f"| {slow / seconds:.1f} | {bound} | {worst:.3g} | {over} |"
                )
                print(lines[-1], flush=True)
    return "\n".join(lines)


def random_curves():
    """200 rational splines of degrees 2 to 5 in the plane, of a size of about 1."""
    chance = random.Random(6)
    made = []
    for _ in range(200):
        degree, inner = chance.randint(2, 5), chance.randint(0, 6)
        knots = [0.0] * (degree + 1) + sorted(chance.random() for _ in range(inner)) + [1.0] * (degree + 1)
        n = degree + 1 + inner
        control = [[chance.random(), chance.random()] for _ in range(n)]
        weights = [2 ** chance.uniform(-1, 1) for _ in range(n)]
        made.append({"degree": degree, "knots": knots, "control": control, "weights": weights})
    return made


def curve_error(curve, lines):
    """The largest distance of 2,000 points of a curve from a chain of lines."""
    import numpy

    heavy = [(*(c * w for c in p), w) for p, w in zip(curve["control"], curve["weights"])]
    on = numpy.array([de_boor(curve["degree"], curve["knots"], heavy, min(k / 2000, 1))[:2] for k in range(2001)])
    chain = numpy.array(lines)
    starts, along = chain[:-1], numpy.diff(chain, axis=0)
    square = numpy.maximum((along**2).sum(axis=1), 1e-300)
    to = on[:, None, :] - starts
    part = numpy.clip((to * along).sum(axis=2) / square, 0, 1)
    return float(numpy.linalg.norm(to - part[:, :, None] * along, axis=2).min(axis=1).max())


def occt_curve(curve, tolerance):
    from OCP.collections import Array1_double, Array1_gp_Pnt2d
    from OCP.GCPnts import GCPnts_QuasiUniformDeflection
    from OCP.Geom2d import Geom2d_BSplineCurve
    from OCP.Geom2dAdaptor import Geom2dAdaptor_Curve
    from OCP.gp import gp_Pnt2d

    n = len(curve["control"])
    poles, weights = Array1_gp_Pnt2d(1, n), Array1_double(1, n)
    for k, (p, w) in enumerate(zip(curve["control"], curve["weights"])):
        poles.SetValue(k + 1, gp_Pnt2d(*p))
        weights.SetValue(k + 1, w)
    values, times = occt_knots(curve["knots"])
    adaptor = Geom2dAdaptor_Curve(Geom2d_BSplineCurve(poles, weights, values, times, curve["degree"], False))
    made, seconds = timed(lambda _: GCPnts_QuasiUniformDeflection(adaptor, tolerance))
    points = [made.Value(k + 1) for k in range(made.NbPoints())]
    return [(p.X(), p.Y()) for p in points], seconds


def curves():
    all_curves = random_curves()
    file = OUT / "curves.json"
    file.write_text(json.dumps({"curves": all_curves}))
    ours = program(file, CURVE_TOLERANCES)
    lines = [
        "| tolerance | engine | segments | × OCCT | CPU ms | OCCT / it | over | worst error/tolerance | median |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for text in CURVE_TOLERANCES:
        tolerance = float(text)
        peer = [occt_curve(curve, tolerance) for curve in all_curves]
        theirs, slow = [points for points, _ in peer], sum(seconds for _, seconds in peer)
        mine = [[p[:2] for p in points] for points, _ in dumped(text)]
        base = sum(len(chain) - 1 for chain in theirs)
        for engine, chains, seconds in [("Chordal, proved", mine, ours[text][1]), ("OpenCASCADE", theirs, slow)]:
            off = [curve_error(curve, chain) / tolerance for curve, chain in zip(all_curves, chains)]
            count = sum(len(chain) - 1 for chain in chains)
            lines.append(
                f"| {text} | {engine} | {count:,} | {count / base:.2f} | {1e3 * seconds:.2f} | {slow / seconds:.1f} "
                f"| {sum(x > 1 for x in off)} of {len(off)} | {max(off):.3f} | {statistics.median(off):.3f} |"
            )
            print(lines[-1], flush=True)
    return "\n".join(lines)


def solids():
    """Solids of OpenCASCADE, by name."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
    from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
    from OCP.BRepPrimAPI import (
        BRepPrimAPI_MakeBox,
        BRepPrimAPI_MakeCone,
        BRepPrimAPI_MakeCylinder,
        BRepPrimAPI_MakeSphere,
        BRepPrimAPI_MakeTorus,
    )
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
    from OCP.TopAbs import TopAbs_EDGE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    def axis(place, along):
        return gp_Ax2(gp_Pnt(*place), gp_Dir(*along))

    box = BRepPrimAPI_MakeBox(20, 30, 10).Shape()
    hole = BRepPrimAPI_MakeCylinder(axis((10, 15, -1), (0, 0, 1)), 4, 12).Shape()
    fillet = BRepFilletAPI_MakeFillet(box)
    edges = TopExp_Explorer(box, TopAbs_EDGE)
    while edges.More():
        fillet.Add(2.0, static(TopoDS, "Edge")(edges.Current()))
        edges.Next()
    rounded = fillet.Shape()
    across = BRepPrimAPI_MakeCylinder(axis((-1, 15, 5), (1, 0, 0)), 2.5, 30).Shape()
    pipes = [
        BRepPrimAPI_MakeCylinder(axis((0, 0, -10), (0, 0, 1)), 4, 20).Shape(),
        BRepPrimAPI_MakeCylinder(axis((-10, 0, 0), (1, 0, 0)), 3, 20).Shape(),
    ]
    ring, off_centre = BRepPrimAPI_MakeTorus(10, 3).Shape(), BRepPrimAPI_MakeSphere(gp_Pnt(10, 0, 0), 4.5).Shape()
    return {
        "cylinder": BRepPrimAPI_MakeCylinder(5, 10).Shape(),
        "cone": BRepPrimAPI_MakeCone(5, 0, 8).Shape(),
        "ball": BRepPrimAPI_MakeSphere(5).Shape(),
        "torus": ring,
        "drilled block": BRepAlgoAPI_Cut(box, hole).Shape(),
        "filleted block": rounded,
        "filleted, drilled twice": BRepAlgoAPI_Cut(BRepAlgoAPI_Cut(rounded, hole).Shape(), across).Shape(),
        "crossing pipes": BRepAlgoAPI_Fuse(*pipes).Shape(),
        "torus and ball": BRepAlgoAPI_Fuse(ring, off_centre).Shape(),
        "bitten torus": BRepAlgoAPI_Cut(ring, off_centre).Shape(),
    }


def faces():
    import step_to_surfaces
    from OCP.BRep import BRep_Tool
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.BRepTools import BRepTools
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS

    lines = [
        "| solid | tolerance | Chordal | × OCCT | CPU ms | bound, proved | OpenCASCADE | CPU ms |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for name, shape in solids().items():
        brep, file = OUT / "solid.brep", OUT / "solid.json"
        static(BRepTools, "Write")(shape, str(brep))
        subprocess.run([sys.executable, step_to_surfaces.__file__, brep, file], check=True, stdout=subprocess.DEVNULL)
        ours = program(file, SOLID_TOLERANCES)
        for text in SOLID_TOLERANCES:

            def run(solid, tolerance=float(text)):
                BRepMesh_IncrementalMesh(solid, tolerance, False, math.pi, False)
                return solid

            solid, slow = timed(run, lambda shape=shape: BRepBuilderAPI_Copy(shape, True, False).Shape())
            count, explorer = 0, TopExp_Explorer(solid, TopAbs_FACE)
            while explorer.More():
                face = static(TopoDS, "Face")(explorer.Current())
                count += static(BRep_Tool, "Triangulation")(face, TopLoc_Location()).NbTriangles()
                explorer.Next()
            n, seconds, bound = ours[text]
            lines.append(
                f"| {name} | {text} | {n:,} | {n / count:.2f} | {1e3 * seconds:.1f} | {bound:.3g} | {count:,} | {1e3 * slow:.1f} |"
            )
            print(lines[-1], flush=True)
    return "\n".join(lines)


def main():
    """Runs everything."""
    OUT.mkdir(exist_ok=True)
    parts = [
        "Both sides get one tolerance, one thread, and no limit of angles; seconds are CPU time, medians of 5 (Chordal) and 3 runs "
        "(geomdl: one). geomdl takes no tolerance: it gets the fewest equal steps whose samples are within it, found by trying, which is not timed. "
        "Samples are of some 3,000 triangles, evenly among all; `over` counts those, or curves, of which one is beyond the tolerance. No Rust crate was compared: truck was not tried.",
        f"Measured on {date.today()}: {section.machine()}; cadquery-ocp {version('cadquery-ocp')}, geomdl {version('geomdl')}.",
        f"### Whole surfaces\n\n{surfaces()}",
        f"### 200 random rational splines in the plane, degrees 2 to 5\n\n{curves()}",
        f"### Solids of trimmed faces, in millimetres\n\n{faces()}",
    ]
    section.put("Splines, surfaces and faces, against OpenCASCADE and geomdl", "\n\n".join(parts))


if __name__ == "__main__":
    main()
