"""Sixty frames of a moving camera, each mesh made anew and with tiles kept; writes a section of RESULTS.md and out/frames.csv.

Run by `make frames`. The car is one of OpenSubdiv's regression shapes, which are not part of this tree: CHORDAL_DATA says where they are.
"""

import csv
import os
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
BENCH = HERE.parent
ROOT = BENCH.parent
sys.path.insert(0, str(BENCH))
import section  # noqa: E402

PROGRAM = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "examples" / "frames"
DATA = Path(os.environ.get("CHORDAL_DATA", ROOT.parent / "shared" / "data"))
HEAD = [
    "shape", "pixels", "threads", "ms anew", "ms kept", "anew / kept", "slowest anew", "slowest kept", "triangles anew", "triangles kept",
    "tiles kept",
]
ABOUT = """
A camera of 1920 × 1080 pixels and 45° goes a quarter around the shape and comes nearer, from six of its radii to two, in 60 frames. Every
frame is meshed within so many pixels, *anew* (`patches_to_mesh`, `CageMesher`) and with the tiles *kept* that still hold
(`ViewDependentMesher`), both in turns. Both are proved for the view of the frame. Milliseconds are those of a frame, in the mean and of the
slowest, without the first frame, where nothing is known yet. Kept tiles are planned for three quarters of the length that is allowed, so there
are more triangles.
""".strip()


def row_of(line):
    """A row of the table from one of the program."""
    shape, pixels, threads, anew, slowest_anew, triangles_anew, kept, slowest_kept, triangles_kept, share = line.split("\t")
    ratio = float(anew) / float(kept)
    return [
        shape, pixels, threads, anew, kept, f"{ratio:.1f}", slowest_anew, slowest_kept, f"{int(triangles_anew):,}", f"{int(triangles_kept):,}",
        f"{100 * float(share):.0f} %",
    ]


def main():
    """Runs everything and writes the table."""
    cages = [path for path in [DATA / "subdiv" / "cages" / "catmark_car.obj"] if path.exists()]
    words = [PROGRAM, ROOT / "examples" / "teapot.bpt", *cages]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    rows = [row_of(line) for line in done.stdout.strip().split("\n")]
    (BENCH / "out").mkdir(exist_ok=True)
    with open(BENCH / "out" / "frames.csv", "w", newline="") as file:
        csv.writer(file).writerows([HEAD, *rows])
    text = [ABOUT, "", f"| {' | '.join(HEAD)} |", "|" + "---|" * len(HEAD), *(f"| {' | '.join(row)} |" for row in rows)]
    text += ["", f"Measured on {section.machine()}."]
    section.put("Frames of a moving camera, tiles kept and made anew", "\n".join(text))


main()
