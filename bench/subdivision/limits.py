"""Limit surfaces within a budget beside uniform levels; writes a section of RESULTS.md and out/limits.csv.

Run by `make subdivision-limits`. The cages are OpenSubdiv's regression shapes, which are not part of this tree: CHORDAL_DATA says
where they are.
"""

import csv
import json
import os
import statistics
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
BENCH = HERE.parent
sys.path.insert(0, str(BENCH))
import section  # noqa: E402

DATA = Path(os.environ.get("CHORDAL_DATA", BENCH.parent.parent / "shared" / "data")) / "subdiv/cages"
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", BENCH / "target"))
PROGRAM = TARGET / "release" / "limit_meshes"
# Above this an error is one, as a share of the diagonal; limit_meshes takes the same.
ROUNDING = 1e-12
# Seconds a cage. Points near a vertex of hundreds of needles are near them all, which no tree of boxes helps; chosen.
TIMEOUT = 300
ABOUT = """
`cage_to_mesh` beside refinement to a uniform level with the vertices on the limit surface and two triangles a quad, which is what
OpenSubdiv gives. **The levels are made by Chordal's refinement and the masks of limit points**: the section above and the tests show its points equal to
OpenSubdiv's to 1e-6 of the extent; so OpenSubdiv itself does not run here. Where creases have not ended at a level its vertices are on the limit
surface all the same, which masks of that level alone would not do.

Lengths are shares of the diagonal of the cage's box. *bound* is what Chordal proves; *error* is measured by samples, the same for both
sides: from the surface (the vertices of a level some rounds finer, and points of `Sheet::at` that come ever closer to corners and sides) to the
mesh, and from points spread over the mesh to the finer level. `check::deviation` encloses each of Chordal's errors as well, against the finer level,
and the run stops where they disagree. *level* is the first whose measured error is no larger than Chordal's. *ratio* is Chordal's triangles
over that level's. Since levels come in steps of 4, that flatters Chordal by up to 4: *between levels* takes the triangles
that would reach Chordal's error if errors fell with 1/triangles, from that level (at level 0 too, where no fewer triangles exist).
Chordal's error is below its bound, since a bound has slack; *to the budget* does not count that for it: it takes the first level whose
measured error is within the budget, which nobody knows without measuring.
""".strip()
HEAD = ["cage", "faces", "budget", "triangles", "bound", "error", "ms", "level", "its triangles", "its error", "ratio", "between levels", "to the budget"]


def row_of(found):
    """A row of the table, and the three ratios; None where they say nothing."""
    error = max(found["from"], found["to"])
    low, high = found["enclosed"]
    # The finer level is off the surface itself.
    assert low <= error * 1.01 + 2 * found["off"] + ROUNDING and error <= high * 1.01 + 2 * found["off"] + ROUNDING, found
    assert error <= found["bound"] + found["off"], found
    is_beyond = found["level"] < 0
    is_flat = error <= ROUNDING
    ratio = found["ours"] / found["theirs"]
    between = None if is_flat or is_beyond else ratio * error / found["their_error"] if found["their_error"] > ROUNDING else None
    within = next((n for n, e in found["levels"] if e <= found["share"]), None)
    level = f"> {len(found['levels']) - 1}" if is_beyond else found["level"]
    row = [
        found["cage"], found["faces"], f"{found['share']:.0e}", found["ours"], f"{found['bound']:.1e}", f"{error:.1e}",
        f"{1e3 * found['seconds']:.0f}", level, f"{'> ' if is_beyond else ''}{found['theirs']}", f"{found['their_error']:.1e}",
        f"{'< ' if is_beyond else ''}{ratio:.2f}", f"{between:.2f}" if between else "–",
        f"{found['ours'] / within:.2f}" if within else "–",
    ]
    return row, ratio, between, found["ours"] / within if within else None


def summary(rows):
    """What the targets ask for, as lines of a table."""
    head = [f"{kind} at {share}" for kind in ("ratio", "between levels", "to the budget") for share in ("1e-2", "1e-3")]
    lines = [f"| | {' | '.join(head)} |", "|" + "---|" * 7]

    def line(title, names, how):
        cells = []
        for kind in (1, 2, 3):
            for share in ("1e-02", "1e-03"):
                of = [(row[kind], row[0][0]) for row in rows if row[0][2] == share and row[kind] and names(row[0][0])]
                cells.append(how(of))
        lines.append(f"| {title} | {' | '.join(cells)} |")

    line("median", lambda _: True, lambda of: f"{statistics.median(r for r, _ in of):.2f}")
    line("worst", lambda _: True, lambda of: "{:.2f} ({})".format(*max(of)))
    for name in ("catmark_car", "catmark_cube_creases0", "catmark_cube_creases1", "catmark_cube_creases2"):
        line(name, lambda n, name=name: n == name, lambda of: f"{of[0][0]:.2f}" if of else "–")
    return lines


def main():
    """Runs everything and writes the table."""
    if not DATA.is_dir():
        print(f"SKIPPED: there is no folder {DATA}")
        return
    rows, refused = [], []
    for path in sorted(DATA.glob("catmark_*.obj")):
        try:
            done = subprocess.run([PROGRAM, path], capture_output=True, text=True, timeout=TIMEOUT, check=True)
        except subprocess.TimeoutExpired:
            refused.append(f"{path.stem} (not measured within {TIMEOUT} seconds)")
            continue
        for line in done.stdout.strip().split("\n"):
            found = json.loads(line)
            if "refused" in found:
                refused.append(f"{found['cage']} ({found['refused']})")
                continue
            rows.append(row_of(found))
            print(*rows[-1][0], flush=True)
    (BENCH / "out").mkdir(exist_ok=True)
    with open(BENCH / "out" / "limits.csv", "w", newline="") as file:
        csv.writer(file).writerows([HEAD, *(row for row, *_ in rows)])
    text = [ABOUT, "", *summary(rows), "", f"| {' | '.join(HEAD)} |", "|" + "---|" * len(HEAD)]
    text += [f"| {' | '.join(map(str, row))} |" for row, *_ in rows]
    text += ["", f"Left out: {'; '.join(refused)}."] if refused else []
    text += ["", f"Measured on {section.machine()}.", (HERE / "LIMITS.md").read_text().strip()]
    section.put("Subdivision surfaces to a tolerance, against uniform levels", "\n".join(text))


main()
