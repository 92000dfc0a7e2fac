"""Subdivision surfaces beside OpenSubdiv; writes a section of RESULTS.md and out/subdivision.csv.

Run by `make subdivision`. The cages are OpenSubdiv's regression shapes, which are not part of this tree: CHORDAL_DATA says
where they are. OpenSubdiv is Debian's libosd-dev 3.5; without it there is nothing to compare, and nothing is written.
"""

import csv
import json
import os
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
BENCH = HERE.parent
sys.path.insert(0, str(BENCH))
import section  # noqa: E402

DATA = Path(os.environ.get("CHORDAL_DATA", BENCH.parent.parent / "shared" / "data")) / "subdiv/cages"
OUT = BENCH / "out" / "subdivision"
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", BENCH / "target"))
OURS = TARGET / "release" / "subdivision"
THEIRS = BENCH / "out" / "opensubdiv"
# The torus has nearly as many points at level 4 as the car at 6.
CASES = [
    *((f"catmark_{name}", level) for name in ("helmet", "rook", "car") for level in (4, 5, 6)),
    *(("torus of 20k", level) for level in (3, 4)),
    *((f"loop_{name}", level) for name in ("icos_semisharp", "pole64") for level in (5, 6)),
]
# Measured on the same cages with the code before grids were done by rows, at a load of 1 to 3; ms.
BEFORE = {
    ("catmark_helmet", 4): 1.19, ("catmark_helmet", 5): 3.20, ("catmark_rook", 4): 15.2, ("catmark_rook", 5): 48.2,
    ("catmark_car", 4): 32.0, ("catmark_car", 5): 95.1,
}
ABOUT = """
Cages to the faces and points of a level, and positions that move. Medians of wall time on one thread, both sides in turn, from a cage in
memory; before any time is taken, the points of both are compared as sets, in f64 (*off*, as a share of the diagonal).

*refine*: topology and positions of the level. Chordal's are in f64; OpenSubdiv's (`TopologyRefiner`, uniform, without what only limits
need in the last level, and `PrimvarRefiner`) in f32, its faster way. OpenSubdiv also keeps all levels and the
edges of the level, which Chordal does not make. *before* is Chordal's time before grids were done by rows.

*moved*: the same points for other positions. OpenSubdiv's table of stencils has to be built (with its topology) and is then
applied in f32 (`CpuEvaluator`); Chordal's `Refinement` is built with all indices, and evaluated in f32 and f64, into memory that is there.
""".strip()
HEAD = [
    "cage", "level", "faces", "off", "refine, ms", "on 2 threads", "before", "OpenSubdiv", "Mfaces/s", "theirs", "× as fast",
    "build, ms", "theirs", "their build over ours", "moved f32, ms", "f64", "theirs", "× as fast, f32", "f64",
]


def ask(command, threads=1):
    """The line of JSON that a program prints on so many cores."""
    cores = ",".join(str(i) for i in range(threads))
    done = subprocess.run(["taskset", "-c", cores, *map(str, command)], capture_output=True, text=True, timeout=1200, check=True)
    return json.loads(done.stdout.strip().split("\n")[-1])


def main():
    """Runs everything and writes the table."""
    if not DATA.is_dir() or not THEIRS.exists():
        print(f"SKIPPED: there is no folder {DATA}, or no {THEIRS}")
        return
    OUT.mkdir(parents=True, exist_ok=True)
    torus = OUT / "torus.obj"
    subprocess.run([OURS, "make", torus], check=True)
    rows = []
    for name, level in CASES:
        path = torus if name.startswith("torus") else DATA / f"{name}.obj"
        points = OUT / "points.bin"
        peer = ask([THEIRS, path, level, 3 if level > 5 else 5, points])
        one = ask([OURS, "run", path, level, 15, 1, points])
        two = ask([OURS, "run", path, level, 15, 2, points], 2)
        assert one["faces"] == peer["faces"] and one["off"] <= 1e-6, f"{name} {level}: {one['off']} off"
        theirs = peer["topology"] + peer["positions_f32"]
        before = BEFORE.get((name, level))
        row = [
            name, level, peer["faces"], f"{one['off']:.0e}", f"{1e3 * one['refine']:.2f}", f"{1e3 * two['refine']:.2f}",
            f"{before:.1f}" if before else "–", f"{1e3 * theirs:.1f}", f"{peer['faces'] / one['refine'] / 1e6:.1f}",
            f"{peer['faces'] / theirs / 1e6:.1f}", f"{theirs / one['refine']:.1f}", f"{1e3 * one['build']:.2f}",
            f"{1e3 * peer['build']:.0f}", f"{peer['build'] / one['build']:.0f}", f"{1e3 * one['apply_f32']:.2f}",
            f"{1e3 * one['apply']:.2f}", f"{1e3 * peer['apply']:.2f}", f"{peer['apply'] / one['apply_f32']:.1f}",
            f"{peer['apply'] / one['apply']:.1f}",
        ]
        rows.append(row)
        print(*row, flush=True)
    with open(BENCH / "out" / "subdivision.csv", "w", newline="") as file:
        csv.writer(file).writerows([HEAD, *rows])
    text = [ABOUT, "", f"| {' | '.join(HEAD)} |", "|" + "---|" * len(HEAD)]
    text += [f"| {' | '.join(map(str, row))} |" for row in rows]
    text += ["", f"Measured on {section.machine()}.", (HERE / "NOTES.md").read_text().strip()]
    section.put("Subdivision surfaces, against OpenSubdiv", "\n".join(text))


main()
