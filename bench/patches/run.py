"""The patch bench: both sides on each corpus at each tolerance, one after the other, measured by one sampler.

Prints a table, and writes it with what it was measured on to out/patches.csv and to RESULTS.md.
"""

import csv
import subprocess
import sys
from datetime import date
from importlib.metadata import version
from pathlib import Path

import occt

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import section  # noqa: E402

BENCH = Path(__file__).resolve().parent.parent
CORPORA = {
    "teapot": "Newell's teapot, 32 patches in one call, scaled to diagonal 1",
    "hard": "520 single patches of 10 random families, each scaled to diagonal 1 and meshed by itself",
}
TOLERANCES = ["1e-2", "1e-3", "1e-4"]
NAMES = {
    "chordal": "Chordal, proved",
    "occt": "OpenCASCADE, linear deflection only",
    "occt-sewn": "OpenCASCADE, faces sewn",
    "occt-default-angle": "OpenCASCADE, angular 0.5 rad as by default",
    "occt-default-angle-sewn": "OpenCASCADE, sewn, angular 0.5 rad",
}
COLUMNS = ["corpus", "tolerance", "engine", "family", "triangles", "seconds", "failed", "shapes", "over", "worst", "median"]


def program(name, *arguments):
    """The CSV rows that a program of the bench prints."""
    path = BENCH / "target" / "release" / name
    done = subprocess.run([path, *arguments], check=True, stdout=subprocess.PIPE, text=True)
    return [line.split(",") for line in done.stdout.split()]


def rows(corpus, tolerance):
    """All engines on one corpus at one tolerance."""
    made = {}
    for angle in occt.ANGLES:
        for name, triangles, seconds, missing in occt.run(corpus, tolerance, angle):
            made[name] = [triangles, seconds, missing]
    for _, _, name, triangles, seconds, failed, _ in program("patches", corpus, tolerance):
        made[name] = [int(triangles), float(seconds), int(failed)]
    for _, _, name, family, shapes, triangles, over, worst, median in program("measure", corpus, tolerance, *made):
        seconds, failed = made[name][1:] if family == "all" else ("", "")
        counts = [int(shapes), int(over), float(worst), float(median)]
        yield [corpus, tolerance, name, family, int(triangles), seconds, failed, *counts]


def table(corpus, found):
    """The Markdown table of one corpus."""
    lines = [
        "| tolerance | engine | triangles | × OCCT | CPU seconds | OCCT / it | µs/triangle | over | worst error/tolerance | median |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for tolerance in TOLERANCES:
        here = [row for row in found if row[0] == corpus and row[1] == tolerance and row[3] == "all"]
        peer = next(row for row in here if row[2] == "occt")
        here.sort(key=lambda row: list(NAMES).index(row[2]))
        for _, _, name, _, triangles, seconds, _, shapes, over, worst, median in here:
            lines.append(
                f"| {tolerance} | {NAMES[name]} | {triangles} | {triangles / peer[4]:.2f} | {seconds:.4f} "
                f"| {peer[5] / seconds:.1f} | {1e6 * seconds / triangles:.2f} "
                f"| {over} of {shapes} ({100 * over / shapes:.1f} %) | {worst:.3f} | {median:.3f} |"
            )
    return "\n".join(lines)


def families(found):
    """The Markdown table of the hard corpus by family: triangles against the peer's, and shapes over on both sides."""
    head = " | ".join(f"triangles at {t}, × OCCT | over, OCCT's over" for t in TOLERANCES)
    lines = [f"| family | {head} |", "|---" * (2 * len(TOLERANCES) + 1) + "|"]
    rows = {(row[3], row[1], row[2]): row for row in found if row[0] == "hard"}
    for family in dict.fromkeys(row[3] for row in found if row[0] == "hard"):
        cells = [family]
        for tolerance in TOLERANCES:
            own, peer = rows[family, tolerance, "chordal"], rows[family, tolerance, "occt"]
            cells += [f"{own[4]} (× {own[4] / peer[4]:.2f})", f"{own[8]}, {peer[8]}"]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def main():
    """Runs everything."""
    found = []
    for corpus in CORPORA:
        for tolerance in TOLERANCES:
            for row in rows(corpus, tolerance):
                found.append(row)
                print(*row, flush=True)
    with open(BENCH / "out" / "patches.csv", "w", newline="") as out:
        csv.writer(out).writerows([COLUMNS, *found])
    parts = [(BENCH / "patches" / "ABOUT.md").read_text().strip()]
    parts.append(
        f"Measured on {date.today()}: {section.machine()}; one thread on both sides; seconds are CPU time, medians of 5 (Chordal) and 3 runs; "
        f"cadquery-ocp {version('cadquery-ocp')}."
    )
    for corpus, about in CORPORA.items():
        parts.append(f"### {corpus}: {about}\n\n{table(corpus, found)}")
    parts.append(f"### hard, by family\n\n{families(found)}")
    section.put("Bicubic patches to tolerance, against OpenCASCADE", "\n\n".join(parts))
    for corpus in CORPORA:
        print(f"\n{corpus}\n{table(corpus, found)}")
    print(f"\n{families(found)}")


if __name__ == "__main__":
    main()
