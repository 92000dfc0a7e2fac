"""Meshes parts with the command and judges what it wrote: closed, manifold, oriented, and of the right volume.

It shares no code with Chordal: it reads the triangles of the .ply, counts edges and vertices itself, and compares the
volume with the line `# volume:` of the script, which `python -m volumes` calculates.

    python check.py --command target/release/chordal            every part but those that are kept aside
    python check.py --command target/release/chordal gear_name  some of them
    python check.py --aside                                     those kept aside: looked at last, not while tuning

Needs numpy; where trimesh is installed, it has to agree. The exit code is 1 if a part fails.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

try:
    import trimesh
except ImportError:
    trimesh = None

FOLDER = Path(__file__).resolve().parent
#: Types of numbers in a .ply.
TYPES = {"double": "<f8", "float": "<f4", "uint": "<u4", "int": "<i4", "uchar": "u1", "ushort": "<u2"}
LINE = re.compile(r"^# volume: (\S+)(?: # monte carlo, standard error (\S+))?$", re.MULTILINE)


@dataclass
class Row:
    """What is known of one part."""

    name: str
    kind: str
    code: int
    seconds: float
    triangles: int = 0
    tolerance: float = math.nan
    bound: float = math.nan
    evidence: str = "-"
    open_places: int = 0
    volume: float = math.nan
    said: float = math.nan
    #: The volume's error in percent, and as a share of what it may be: the bound, or else the tolerance, times the area.
    percent: float = math.nan
    share: float = math.nan
    faults: str = ""


def kept_aside() -> set[str]:
    """The names in KEPT_ASIDE."""
    lines = (FOLDER / "KEPT_ASIDE").read_text(encoding="utf-8").splitlines()
    return {line.strip() for line in lines if line.strip() and not line.startswith("#")}


def read_ply(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Positions and triangles of a binary .ply whose faces are all triangles."""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    elements: list[tuple[str, int, list[tuple[str, str]]]] = []
    for line in data[:end].decode("ascii").splitlines():
        words = line.split()
        if words[0] == "element":
            elements.append((words[1], int(words[2]), []))
        elif words[0] == "property" and words[1] == "list":
            elements[-1][2].extend([("count", TYPES[words[2]]), ("corners", "3" + TYPES[words[3]])])
        elif words[0] == "property":
            elements[-1][2].append((words[2], TYPES[words[1]]))
    tables = {}
    for name, count, properties in elements:
        tables[name] = np.frombuffer(data, np.dtype(properties), count, end)
        end += tables[name].nbytes
    vertex, face = tables["vertex"], tables["face"]
    assert (face["count"] == 3).all(), "every face is a triangle"
    return np.stack([vertex[axis].astype(float) for axis in "xyz"], axis=1), face["corners"].astype(np.int64)


def faults_of(points: np.ndarray, faces: np.ndarray) -> list[str]:
    """What is wrong with the triangles: every edge has two faces that run along it in opposite directions, and the faces
    around a vertex are one fan."""
    found = []
    n = len(points)
    if not np.isfinite(points).all() or faces.min() < 0 or faces.max() >= n:
        return ["positions or indices make no sense"]
    degenerate = (faces == np.roll(faces, 1, axis=1)).any(axis=1).sum()
    if degenerate:
        found.append(f"{degenerate} degenerate faces")
    start, end = faces.reshape(-1), np.roll(faces, -1, axis=1).reshape(-1)
    directed = np.sort(start * n + end)
    if (np.diff(directed) == 0).any():
        found.append(f"{int((np.diff(directed) == 0).sum())} edges twice in one direction")
    lonely = np.setdiff1d(directed, end * n + start)
    if len(lonely):
        found.append(f"{len(lonely)} edges without a partner")
    if found:
        return found
    # Corner k of a face leaves along edge k; around its vertex the next corner is the one that leaves along the twin of
    # the edge that comes in. One fan is one cycle, and each cycle is known by its least corner.
    twin = np.argsort(start * n + end)[np.argsort(np.argsort(end * n + start))]
    incoming = np.arange(len(start)).reshape(-1, 3)[:, [2, 0, 1]].reshape(-1)
    fans = np.unique(start * len(start) + least_of_cycle(twin[incoming])).size
    if fans != np.unique(start).size:
        found.append(f"{fans - np.unique(start).size} vertices with more than one fan")
    return found


def least_of_cycle(following: np.ndarray) -> np.ndarray:
    """For each element of a permutation the least of its cycle, by doubling."""
    label, step = np.arange(len(following)), following
    for _ in range(len(following).bit_length()):
        label, step = np.minimum(label, label[step]), step[step]
    return label


def volume_and_area(points: np.ndarray, faces: np.ndarray) -> tuple[float, float]:
    """By the divergence theorem about the middle, so that little cancels."""
    a, b, c = (points[faces[:, k]] - points.mean(axis=0) for k in range(3))
    cross = np.cross(b - a, c - a)
    return float((a * np.cross(b, c)).sum() / 6), float(np.sqrt((cross**2).sum(axis=1)).sum() / 2)


def check(name: str, kind: str, asked: argparse.Namespace, folder: Path) -> Row:
    """Meshes one part and judges it."""
    output = folder / f"{name}.ply"
    command = [asked.command, "mesh", str(FOLDER / f"{name}.star"), "--tol", asked.tol, "-o", str(output), "--json"]
    if asked.within:
        command += ["--within", asked.within]
    began = time.monotonic()
    try:
        done = subprocess.run([*command, "--force"], capture_output=True, text=True, timeout=asked.patience)
    except subprocess.TimeoutExpired:
        return Row(name, kind, -1, asked.patience, faults="no end")
    row = Row(name, kind, done.returncode, time.monotonic() - began)
    found = LINE.search((FOLDER / f"{name}.star").read_text(encoding="utf-8"))
    assert found, f"{name} has no line of its volume"
    row.said, error = float(found.group(1)), float(found.group(2) or 0)
    if not output.exists():
        row.faults = "no mesh: " + " ".join(done.stderr.split())[:300]
        return row
    report = json.loads(done.stdout)
    certificate = report.get("certificate", report)
    bound = certificate["bound"]
    row.evidence = bound["evidence"]
    row.bound = bound.get("at_most") or bound.get("at_least") or 0.0
    row.open_places = (bound.get("open") or {}).get("count", 0)
    row.tolerance = certificate["budget"]["length"]
    points, faces = read_ply(output)
    row.triangles = len(faces)
    faults = faults_of(points, faces)
    row.volume, area = volume_and_area(points, faces)
    # What is proved is often less than what was asked for, of flat parts most of all.
    allowed = (bound.get("at_most") or row.tolerance) * area + 4 * error
    row.percent = 100 * (row.volume - row.said) / row.said
    row.share = (row.volume - row.said) / allowed
    if not abs(row.share) <= 1:
        faults.append("wrong volume")
    if trimesh is not None:
        other = trimesh.Trimesh(points, faces, process=False)
        if not (other.is_watertight and other.is_winding_consistent):
            faults.append("trimesh: not closed")
        if abs(other.volume - row.volume) > 1e-6 * abs(row.volume):
            faults.append(f"trimesh: volume {other.volume}")
    row.faults = "; ".join(faults)
    return row


def main() -> int:
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--command", default="chordal", help="the command")
    arguments.add_argument("--tol", default="0.1%", help="the largest distance")
    arguments.add_argument("--within", help="the command's own limit of time, as in 20s")
    arguments.add_argument("--patience", type=float, default=300, help="seconds after which a part counts as failed")
    arguments.add_argument("--aside", action="store_true", help="the parts that are kept aside, instead of the others")
    arguments.add_argument("--all", action="store_true", help="both")
    arguments.add_argument("--json", type=Path, help="a file to write the table to as well")
    arguments.add_argument("parts", nargs="*", help="names; all of them unless some are named")
    asked = arguments.parse_args()
    from volumes import KINDS

    kinds = {name: kind for kind, module in KINDS.items() for name in vars(module) if (FOLDER / f"{name}.star").exists()}
    aside = kept_aside()
    names = asked.parts or sorted(n for n in kinds if asked.all or (n in aside) == asked.aside)
    rows = []
    print(f"{'part':22} code seconds triangles   bound/tol evidence  open  volume %  of allowed")
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            row = check(name, kinds.get(name, "-"), asked, Path(folder))
            rows.append(row)
            print(
                f"{name:22} {row.code:4d} {row.seconds:7.2f} {row.triangles:9d}   {row.bound / row.tolerance:9.3f} "
                f"{row.evidence:9} {row.open_places:5d} {row.percent:9.4f} {row.share:9.4f}  {row.faults}",
                flush=True,
            )
    failed = [row.name for row in rows if row.code != 0 or row.faults]
    seconds = sorted(row.seconds for row in rows)
    proved = sum(row.evidence.startswith("proved") for row in rows)
    print(f"{len(rows)} parts: {len(rows) - len(failed)} good, {proved} proved; median {seconds[len(seconds) // 2]:.2f} s, "
          f"worst {seconds[-1]:.2f} s")
    print("failed:", ", ".join(failed) or "none")
    if asked.json:
        asked.json.write_text(json.dumps([asdict(row) for row in rows], indent=1) + "\n", encoding="utf-8")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
