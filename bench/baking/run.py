"""Meshes to grids of distances side by side with other programs; writes a section of RESULTS.md and out/baking.csv.

Run by `make baking`. OpenVDB has no wheel: its rows need Debian's python3-openvdb and are left out, with a word, without it.
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

OUT = BENCH / "out" / "baking"
OURS = BENCH / "target" / "release" / "baking"
SYSTEM = "/usr/bin/python3"
NAMES = {"open3d": "Open3D", "igl": "libigl (pseudonormals)", "openvdb": "OpenVDB 10"}
ABOUT = """
A bumpy torus of 102,400 triangles on a lattice of 128 cells along its longest side: the distance at all samples, and in a
band of three cells on each side. Building trees is counted on all sides; one or two threads. *Off* is the largest difference from
Chordal's values within the band, in cells, and *wrong signs* are counted over all samples; Chordal's own values are checked
against an independent referee in its tests. Open3D and OpenVDB compute in f32.
""".strip()


def ask(command, threads):
    """The line of JSON that a program prints."""
    cores = ",".join(str(i) for i in range(threads))
    environment = {**os.environ, "OMP_NUM_THREADS": str(threads)}
    done = subprocess.run(["taskset", "-c", cores, *command], env=environment, capture_output=True, text=True, timeout=600)
    if done.returncode:
        raise RuntimeError(done.stderr.strip().split("\n")[-1])
    return json.loads(done.stdout.strip().split("\n")[-1])


def main():
    """Runs everything and writes the table."""
    OUT.mkdir(parents=True, exist_ok=True)
    mesh = str(OUT / "torus.mesh")
    subprocess.run([str(OURS), "make", mesh], check=True)
    text = [ABOUT, "", "| what | program | threads | seconds | M samples/s | off, cells | wrong signs | Chordal's speed over it |", "|" + "---|" * 8]
    rows = []
    for what, title, peers in (("full", "all samples", ("open3d", "igl")), ("band", "band", ("openvdb",))):
        for threads in (1, 2):
            grid = str(OUT / f"{what}.grid")
            mine = ask([str(OURS), what, str(threads), mesh, grid], threads)
            found = [("Chordal", mine, None)]
            for who in peers:
                python = SYSTEM if who == "openvdb" else sys.executable
                try:
                    peer = ask([python, str(HERE / "peers.py"), who, str(threads), mesh, grid], threads)
                except (RuntimeError, FileNotFoundError) as error:
                    print(f"{NAMES[who]} is left out: {error}", flush=True)
                    continue
                found.append((NAMES[who], peer, peer["seconds"] / mine["seconds"]))
            for name, got, ratio in found:
                cells = [
                    title, name, str(threads), f"{got['seconds']:.2f}", f"{mine['samples'] / got['seconds'] / 1e6:.2f}",
                    f"{got['off']:.1e}" if "off" in got else "–", str(got.get("wrong", "–")), f"{ratio:.2f}" if ratio else "–",
                ]
                rows.append(cells)
                text.append(f"| {' | '.join(cells)} |")
                print(*cells, flush=True)
    with open(BENCH / "out" / "baking.csv", "w", newline="") as file:
        csv.writer(file).writerows(rows)
    text += ["", f"Measured on {section.machine()}."]
    section.put("Meshes to grids of distances, against Open3D, libigl and OpenVDB", "\n".join(text))


main()
