"""What is spent at each distance: Chordal's levels at one pixel, and the fewest triangles of the others within the same error."""

import json
import os
import subprocess
from pathlib import Path

from meshfile import foreign, read, write

ROOT = Path(__file__).resolve().parent.parent.parent
CHORDAL = os.environ.get("CHORDAL", str(ROOT / "target" / "release" / "chordal"))
#: What is looked at: a name, what it is, and its file.
SHAPES = {
    "large": ("a bumpy torus of 160,000 triangles", "out/simplify/bumpy.mesh"),
    "cage": ("a creased Catmull–Clark cage, examples/cube.obj", "examples/cube.obj"),
    "patches": ("32 bicubic patches, examples/teapot.bpt", "examples/teapot.bpt"),
    "field": ("a field, examples/block.star", "examples/block.star"),
}
#: Sides without a column, to save hours: in the table of tolerances they are at most 2 % better than the best of the others.
LEFT_OUT = ("ours", "meshopt-update", "fast")
#: What others simplify where the source is smooth, as a share of the finest level's error: so near that it hardly counts. Of a field no nearer
#: one has a proof: it is what Chordal simplifies itself.
FINE = {"cage": 0.1, "patches": 0.1, "field": 0.8}
ABOUT = """
*From* is the distance of the eye to the shape's box, on a screen of 1920 × 1080 with a field of view of 60°, where it covers so many pixels,
and *may be off* the proved error of the level that `chordal lod --px 1` shows there. The others get, where the source is a mesh, that mesh; where
it is smooth, a mesh of Chordal's within a tenth of the finest level's error (for the field, four fifths), whose own error is not held against them. Their settings are searched as
above until their triangles are the fewest that are proved to be within the error. fast-simplification and meshoptimizer with update are left out, to
save hours.
""".strip()


def chordal(*words):
    """The report of a run."""
    done = subprocess.run([CHORDAL, *map(str, words), "--json", "--force"], capture_output=True, text=True, check=True, cwd=ROOT)
    return json.loads(done.stdout)


def obj(path, points, faces):
    """A mesh as text, every digit kept."""
    with open(path, "w") as file:
        file.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist())
        file.writelines(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces.tolist())


def levels(name, out):
    """The levels at each distance of the table, and the file that the others are given."""
    _, source = SHAPES[name]
    mesh = out / f"{name}-fine.mesh"
    if source.endswith(".mesh"):
        points, faces = read(ROOT / "bench" / source)
        given = out / f"{name}.obj"
        obj(given, points, faces)
        write(mesh, points, faces)
    else:
        given = ROOT / source
    report = chordal("lod", given, "--px", "1", "-o", out / f"{name}.glb")
    table = report["certificate"]["levels"]
    if not source.endswith(".mesh"):
        fine = out / f"{name}-fine.obj"
        surface = ["--surface", "catmull-clark"] if name == "cage" else []
        chordal("mesh", given, *surface, "--tol", repr(FINE[name] * table["levels"][0]["at_most"]), "-o", fine)
        write(mesh, *foreign(fine))
    return table, mesh


def measured(ask, names, out):
    """The rows: each level that is shown at a distance of the table, and each side's triangles for its error."""
    rows = []
    for name, (what, _) in SHAPES.items():
        table, mesh = levels(name, out)
        known = {}
        for shown in table["shown"]:
            level = table["levels"][shown["level"]]
            error = level["at_most"]
            if error not in known:
                known[error] = {}
                for side in names:
                    if side not in LEFT_OUT:
                        got = ask(side, "tolerance", 2, mesh, out / "trial.mesh", error)
                        known[error][side] = (got.get("best") or {}).get("triangles")
                        print(name, error, level["triangles"], names[side], known[error][side], flush=True)
            rows.append({"source": what, "from": shown["distance"], "covers": shown["covers_px"], "error": error,
                         "ours": level["triangles"], **known[error]})
    return rows


def table_of_distances(rows):
    sides = {"meshopt": "meshoptimizer", "vtk": "VTK quadric", "open3d": "Open3D", "meshlib": "MeshLib"}
    text = ["### At each distance", "", ABOUT, "", f"| source | from | covers | may be off | Chordal | {' | '.join(sides.values())} |",
            "|---" * (5 + len(sides)) + "|"]
    for row in rows:
        counts = " | ".join(f"{row[side]:,}" if row[side] else "–" for side in sides)
        text.append(f"| {row['source']} | {row['from']:.4g} | {row['covers']:.3g} px | {row['error']:.3g} | "
                    f"**{row['ours']:,}** | {counts} |")
    return text
