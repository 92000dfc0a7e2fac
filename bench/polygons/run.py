"""Polygons to triangles beside mapbox earcut and i_triangle; writes a section of RESULTS.md and out/polygons.csv.

Run by `make polygons`. The fixtures are those of mapbox earcut's tests, which are not part of this tree: CHORDAL_DATA
says where they are.
"""

import csv
import os
import subprocess
import sys
from pathlib import Path

BENCH = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(BENCH))
import section  # noqa: E402

FIXTURES = Path(os.environ.get("CHORDAL_DATA", BENCH.parent.parent / "shared" / "data")) / "polygon/earcut/test/fixtures"
ABOUT = """
Microseconds of CPU time on one thread, the median of many runs in turn. Chordal's hold its proof that the areas add up
and that nothing overlaps; earcut (crate 0.4, f64) and i_triangle (0.51) make no such promise. Where counts differ, the
polygon crosses or touches itself: Chordal names the repair, and keeps every corner on straight sides, which earcut
drops.
""".strip()


def main():
    """Runs the program and writes the table, largest polygons first."""
    if not FIXTURES.is_dir():
        print(f"SKIPPED: there is no folder {FIXTURES}")
        return
    program = BENCH / "target" / "release" / "polygons"
    done = subprocess.run([program, FIXTURES], check=True, capture_output=True, text=True)
    (BENCH / "out" / "polygons.csv").write_text(done.stdout)
    rows = [row for row in csv.DictReader(done.stdout.splitlines()) if row["corners"]]
    rows.sort(key=lambda row: -int(row["corners"]))
    text = [ABOUT, "", "| polygon | corners | holes | Chordal | earcut | i_triangle | triangles | theirs |"]
    text.append("|---|---|---|---|---|---|---|---|")
    for row in rows:
        times = " | ".join(f"{float(row[name]):,.1f}" for name in ("chordal_us", "earcut_us", "i_triangle_us"))
        theirs = f"{row['earcut']}, {row['i_triangle']}"
        text.append(f"| {row['polygon']} | {row['corners']} | {row['holes']} | {times} | {row['chordal']} | {theirs} |")
    ratios = sorted(float(row["chordal_us"]) / float(row["earcut_us"]) for row in rows)
    text += ["", f"Chordal's time over earcut's: median {ratios[len(ratios) // 2]:.2f}, from {ratios[0]:.2f} to {ratios[-1]:.2f}."]
    text.append(f"Measured on {section.machine()}.")
    section.put("Polygons to triangles, against earcut and i_triangle", "\n".join(text))


main()
