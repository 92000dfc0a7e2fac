"""Fields to triangles against the gates of the design, beside fidget in the same run; writes a section of RESULTS.md.

`gates.py [--limit SECONDS] [--alone] [--no-results] [MODEL ...]` runs some rows or all. Every run is a process of its own
that is stopped after the limit, so the program always ends. With `--alone` fidget is left out: to judge its meshes of
large models takes minutes.
"""

import argparse
import csv
import json
import os
import subprocess
import sys
from array import array
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
BENCH = HERE.parent
ROOT = BENCH.parent
sys.path.insert(0, str(BENCH))
import section  # noqa: E402

OUT = BENCH / "out" / "gates"
BENCH_PROGRAM = BENCH / "target" / "release" / "field_meshes"
CHORDAL = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "chordal"
DATA = Path(os.environ.get("CHORDAL_DATA", ROOT.parent / "shared" / "data"))
EXAMPLES, MODELS = ROOT / "examples", HERE / "models"
THREADS = 2
#: Depths of fidget's octree, until its measured error is no larger than the row's tolerance.
DEPTHS = range(4, 10)
#: Half of the height to which the drawing of prospero is extruded.
PROSPERO_HALF = 0.1
ABOUT = """
Each row asks the command for a length, and counts where it is proved; *ms* are the command's own, without the start of its
process. *Triangles* and *ms* stand beside their gates, and a **!** marks what misses its gate. The preview is the command
with `--require measured`. fidget is run at growing depths until its mesh, measured by dense
samples of both surfaces, is no farther off than the same length; where it never is, its best row is shown. Both sides
use two threads. A dash means no proof or no answer within {limit} s, no op list that fidget could read, or no such option.

Where a surface is very thin, as at the rim of the wedge and all over the wall, *measured* is too large: more than 20,000
samples would have to be looked around. `chordal deviation` proves at most 3.1e-3 for the wedge. The gates' times are for
a machine about three times as fast.
""".strip()


@dataclass(frozen=True)
class Row:
    """One model at one length, and what is to be reached; nothing where there is no gate."""

    title: str
    model: str
    tol: float
    triangles: int | None
    ms: float | None


#: The table of the design; then the parts, which have 10 s each at 0.1 % of their size and more.
ROWS = {
    "ball": Row("sphere, R 0.6", "ball", 3e-3, 2000, 14),
    "ball-fine": Row("sphere, R 0.6", "ball", 1.5e-3, 4000, 34),
    "torus": Row("torus", "torus", 2e-3, 4000, 38),
    "block": Row("block", str(EXAMPLES / "block.star"), 1e-2, 120, 5),
    "cube-ball": Row("cube − ball", "cube-ball", 1e-2, 700, 40),
    "csg6": Row("CSG of 6 solids", "csg6", 1e-2, 1100, 80),
    "textbook": Row("the textbook's CSG", str(MODELS / "textbook.star"), 2e-3, 12000, 300),
    "gyroid-ball": Row("gyroid ∩ ball", "gyroid-ball", 1.5e-2, 3000, 300),
    "wedge": Row("5° wedge in a ball", str(MODELS / "wedge.star"), 5e-3, 200, 20),
    "tanglecube": Row("tanglecube", str(MODELS / "tanglecube.star"), 1e-2, 5600, 80),
    "wall": Row("wall 1/1000", str(MODELS / "wall.star"), 2.5e-4, 50000, 300),
    "gyroid": Row("gyroid.star", str(EXAMPLES / "gyroid.star"), 0.05, 15000, 1000),
    "bracket": Row("bracket.star", str(EXAMPLES / "bracket.star"), 0.02, 1200, 150),
    "sponge": Row("sponge.star, depth 3", str(EXAMPLES / "sponge.star"), 1e-3, 45000, 400),
    "blobs": Row("100 blobs", "blobs", 3e-3, 15000, 3400),
    "prospero": Row("prospero, extruded", "prospero", 1e-3, 60000, 5000),
} | {
    name: Row(f"{name}.star", str(EXAMPLES / f"{name}.star"), 0.1, None, 10000)
    for name in ("angle_bracket", "twisted_bolt", "gear", "enclosure", "vase", "creature", "gyroid_cube")
}


def ask(command, limit):
    """The JSON that a program prints, or nothing where it does not come in time."""
    cores = ",".join(str(i) for i in range(THREADS))
    environment = {**os.environ, "RAYON_NUM_THREADS": str(THREADS)}
    words = ["taskset", "-c", cores, *map(str, command)]
    try:
        done = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=limit, check=False)
        return json.loads(done.stdout)
    except (subprocess.TimeoutExpired, json.JSONDecodeError):
        return {}


def extruded_prospero():
    """The drawing within two planes, as an op list of its own; nothing where the drawing is not there."""
    source = DATA / "implicit" / "fidget" / "models" / "prospero.vm"
    if not source.exists():
        print(f"SKIPPED: prospero, because there is no {source}.", file=sys.stderr)
        return None
    text = source.read_text().rstrip("\n")
    flat = text.split("\n")[-1].split()[0]
    lines = [f"pz var-z\npa abs pz\nph const {PROSPERO_HALF}\nps sub pa ph\npr max {flat} ps\n"]
    path = OUT / "prospero.vm"
    path.write_text("\n".join([text, *lines]))
    return str(path)


def command(model, tol, limit, out, *more):
    """What the command of a release makes of a model: its own seconds, the triangles, and the bound."""
    # Models of the bench itself are written out as what the command reads.
    if not Path(model).exists():
        path = OUT / f"{model}.vm"
        path.write_text(ask([BENCH_PROGRAM, "text", model], limit).get("text") or "")
        model = path
    region = ["--region=-1.25,-1.25,-1.25 1.25,1.25,1.25"] if str(model).endswith(".vm") else []
    asked = ["--tol", tol, "--threads", THREADS, "-o", out, "--force", "--json", *more]
    got = ask([CHORDAL, "mesh", model, *region, *asked], limit)
    if "certificate" not in got:
        return {}
    certificate = got["certificate"]
    return {
        "seconds": got["run"]["seconds"], "triangles": certificate["output"]["triangles"],
        "most": certificate["bound"]["at_most"], "is_proved": certificate["bound"]["evidence"] == "proved",
    }


def dump(obj, path):
    """Writes the triangles of an OBJ as the bench's programs read them: both counts, coordinates, rows."""
    positions, faces = array("d"), array("I")
    with open(obj, encoding="utf-8") as lines:
        for line in lines:
            kind, *words = line.split() or [""]
            if kind == "v":
                positions.extend(map(float, words))
            elif kind == "f":
                faces.extend(int(word.split("/")[0]) - 1 for word in words)
    path.write_bytes(array("I", [len(positions) // 3, len(faces) // 3]).tobytes() + positions.tobytes() + faces.tobytes())


def proved(model, tol, limit):
    """Chordal with its proof, and its error as measured; nothing where the proof does not end."""
    obj, path = OUT / "ours.obj", OUT / "ours.mesh"
    got = command(model, tol, limit, obj)
    if not got.get("is_proved"):
        return {}
    dump(obj, path)
    got.update(ask([BENCH_PROGRAM, "judge", model, path], limit))
    return got


def preview(model, tol, limit):
    """The command without a proof."""
    return command(model, tol, limit, OUT / "preview.ply", "--require", "measured")


def fidget(model, tol, limit):
    """fidget at the first depth that is within the length, or its best."""
    best = {}
    path = OUT / "fidget.mesh"
    for depth in DEPTHS:
        got = ask([BENCH_PROGRAM, "fidget", model, THREADS, depth, path], limit)
        if got.get("triangles") is None:
            break
        if got["triangles"]:
            got.update(ask([BENCH_PROGRAM, "judge", model, path], limit))
        if "error" not in got:
            continue
        if not best or got["error"] < best["error"]:
            best = got
        if got["error"] <= tol:
            break
    return best


def shown(value, form, gate=None):
    """A number or a dash, with a mark where it misses its gate."""
    if value is None:
        return "–"
    return format(value, form) + ("" if gate is None or value <= gate else " **!**")


def milliseconds(got):
    """Of a run, or nothing."""
    return None if got.get("seconds") is None else 1e3 * got["seconds"]


def cells(row, model, limit, alone):
    """What a row of the table holds."""
    mine, quick = (run(model, row.tol, limit) for run in (proved, preview))
    theirs = {} if alone else fidget(model, row.tol, limit)
    met = mine.get("triangles") is not None
    sound = "–" if not met else ", ".join("yes" if mine.get(key) else "no" for key in ("closed", "manifold"))
    ms = milliseconds(mine) if met else None
    ratio = ms / milliseconds(theirs) if met and theirs else None
    quick_ratio = milliseconds(quick) / milliseconds(theirs) if quick and theirs else None
    return [
        row.title, f"{row.tol:g}",
        shown(mine.get("triangles"), ",d", row.triangles), shown(row.triangles, ",d"),
        shown(ms, ".0f", row.ms), shown(row.ms, ".0f"),
        shown(mine.get("most") if met else None, ".2e"), shown(mine.get("error"), ".2e"), sound,
        shown(quick.get("triangles"), ",d"), shown(milliseconds(quick), ".0f"),
        shown(theirs.get("triangles"), ",d"), shown(milliseconds(theirs), ".0f"), shown(theirs.get("error"), ".2e"),
        shown(ratio, ".2f"), shown(quick_ratio, ".2f", 1.0),
    ]


HEAD = [
    "model", "length", "triangles", "gate", "ms", "gate", "proved", "measured", "closed, manifold",
    "preview triangles", "preview ms", "fidget triangles", "fidget ms", "fidget measured", "ms / fidget's",
    "preview ms / fidget's",
]


def main():
    """Runs the rows and writes the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--limit", type=float, default=120.0, help="seconds that each process may take")
    parser.add_argument("--alone", action="store_true", help="leave fidget out")
    parser.add_argument("--no-results", action="store_true", help="print the rows and leave RESULTS.md alone")
    parser.add_argument("models", nargs="*", choices=[[], *ROWS], metavar="MODEL", help=", ".join(ROWS))
    asked = parser.parse_args()
    OUT.mkdir(parents=True, exist_ok=True)
    table = []
    print(*HEAD, sep=" | ", flush=True)
    for name in asked.models or ROWS:
        row = ROWS[name]
        model = extruded_prospero() if row.model == "prospero" else row.model
        if model is not None:
            table.append(cells(row, model, asked.limit, asked.alone))
            print(*table[-1], sep=" | ", flush=True)
    if asked.no_results:
        return
    with open(BENCH / "out" / "field_gates.csv", "w", newline="") as file:
        csv.writer(file).writerows([HEAD, *table])
    text = [ABOUT.format(limit=f"{asked.limit:g}"), "", f"| {' | '.join(HEAD)} |", "|" + "---|" * len(HEAD)]
    text += [f"| {' | '.join(line)} |" for line in table]
    text += ["", f"Measured on {section.machine()}."]
    section.put("Fields to triangles, against their gates", "\n".join(text))


main()
