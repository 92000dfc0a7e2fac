"""Booleans of meshes side by side with Manifold; writes a section of RESULTS.md and out/booleans.csv.

Run by `make booleans`.
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

OUT = BENCH / "out" / "booleans"
OURS = Path(os.environ.get("BOOLEANS", BENCH / "target" / "release" / "booleans"))
PAIRS = {
    "spheres-8192": "two spheres, 16,384 triangles",
    "spheres-131072": "two spheres, 262,144 triangles",
    "spheres-524288": "two spheres, 1,048,576 triangles",
    "tori": "two bumpy tori, 256,000 triangles",
    "same": "a bumpy torus and itself, 256,000 triangles",
    "flush": "a plate and 400 bars flush with it, 4,812 triangles",
    "crossing": "a chain of 200 boxes that cross each other, and a bar, 2,412 triangles",
}
RANDOM = 1000
ABOUT = """
Chordal's time includes its check of the result (distances of all triangles to the faces they were cut from, winding numbers at
up to 2,048 points) and the search for self-intersections in the operands; Manifold's is that of manifold3d 3.5.4 from arrays to
arrays in double precision. Both cut with the same method where operands are simple: Chordal calls manifold-rust, a port.
Where an operand crosses itself Chordal calls its rational engine, and Manifold counts what overlaps twice (*volume*).
""".strip()


def ask(command, threads):
    """The line of JSON that a program prints."""
    cores = ",".join(str(i) for i in range(threads))
    environment = {**os.environ, "OMP_NUM_THREADS": str(threads)}
    done = subprocess.run(["taskset", "-c", cores, *command], env=environment, capture_output=True, text=True, timeout=900)
    if done.returncode:
        raise RuntimeError(done.stderr.strip().split("\n")[-1])
    return json.loads(done.stdout.strip().split("\n")[-1])


def main():
    """Runs everything and writes the table."""
    OUT.mkdir(parents=True, exist_ok=True)
    subprocess.run([str(OURS), "make", str(OUT)], check=True)
    heads = ["pair", "what", "threads", "Chordal, s", "Manifold, s", "ratio", "triangles", "method", "volume", "Manifold's volume"]
    text = [ABOUT, "", f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
    rows = []
    for pair, title in PAIRS.items():
        for op in ("union", "difference", "intersection"):
            for threads in (1, 2):
                words = [str(OUT / pair), op]
                mine = ask([str(OURS), "run", str(threads), *words], threads)
                peer = ask([sys.executable, str(HERE / "peers.py"), "run", *words], threads)
                if not mine["sound"]:
                    raise RuntimeError(f"{pair} {op}: the result is not sound")
                row = [
                    title, op, str(threads), f"{mine['seconds']:.3f}", f"{peer['seconds']:.3f}",
                    f"{mine['seconds'] / peer['seconds']:.2f}", f"{mine['triangles']:,}", mine["method"],
                    f"{mine['volume']:.6g}", f"{peer['volume']:.6g}",
                ]
                rows.append(row)
                text.append(f"| {' | '.join(row)} |")
                print(*row, flush=True)
    folder = str(OUT / "random")
    mine = ask([str(OURS), "random", str(RANDOM), "1", folder], 2)
    peer = ask([sys.executable, str(HERE / "peers.py"), "random", str(RANDOM), folder], 2)
    text += ["", f"Of {RANDOM} random pairs in three operations each (boxes on a lattice, which share faces, edges and corners; "
             f"boxes anywhere; coarse spheres), {mine['failed']} were not closed, not manifold, not within their bound, or had volumes "
             f"that do not add up; in {peer['differ']} Manifold's volumes differ from Chordal's by more than a billionth."]
    with open(BENCH / "out" / "booleans.csv", "w", newline="") as file:
        csv.writer(file).writerows(rows)
    text += ["", f"Measured on {section.machine()}."]
    section.put("Booleans of meshes, against Manifold", "\n".join(text))


main()
