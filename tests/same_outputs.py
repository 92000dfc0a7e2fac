"""Whether a change of the code changed anything that a user gets.

    python3 tests/same_outputs.py record CHORDAL BEFORE.json
    python3 tests/same_outputs.py compare CHORDAL BEFORE.json

`record` runs the command CHORDAL over the examples and the data in `../shared/data` (CHORDAL_DATA names another place),
and keeps for every run the exit code, both streams and a hash of each file written. `compare` does the same with
another build and lists what differs. Times and memory are left out of both. `--sums` compares files and exit codes
alone, for changes that mean to change messages. Only the Python standard library is needed. All are some 5,000 runs;
the 2,725 of `--only '^(inspect |mend|counted|deviation|bake|render|normals|polyline|help) '` took ten minutes on two
cores.
"""

import argparse
import concurrent.futures
import difflib
import hashlib
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
DATA = Path(os.environ.get("CHORDAL_DATA", ROOT.parent / "shared" / "data"))
#: Seconds of one run; a run that takes longer counts as `timeout`, which is no difference beside another one.
LIMIT = 120
#: Larger files are left out, so that the whole takes minutes.
LARGEST = 1_500_000
MESHES = {".obj", ".ply", ".stl", ".glb"}
VOLUMES = {".npy", ".nrrd", ".nii", ".gz"}
#: What differs from run to run: seconds, bytes of memory, and the rate made of them.
VOLATILE = re.compile(r'"(seconds|peak_bytes|memory_bytes)": ?[0-9.e+-]+|[0-9.,]+ (s|ms|min|MB|MiB|GB|GiB)\b')
CURES = (
    "--weld --drop-duplicates --drop-degenerate --resolve-t-junctions --split-nonmanifold --orient --fill-holes=100"
    " --drop-unused"
)


def jobs():
    """Names and words of all runs; OUT stands for the folder that a run writes to."""
    files = sorted(path for folder in (ROOT / "examples", DATA) for path in folder.rglob("*") if path.is_file())
    for path in files:
        if path.stat().st_size > LARGEST:
            continue
        kind, name = path.suffix.lower(), str(path.relative_to(ROOT if ROOT in path.parents else DATA))
        yield f"inspect {name}", ["inspect", path, "--json"]
        if kind in MESHES:
            yield f"inspect text {name}", ["inspect", path]
            yield f"mend {name}", ["mend", path, *CURES.split(), "-o", "OUT/mended.ply", "--json"]
            yield f"mesh {name}", ["mesh", path, "--tol", "1%", "-o", "OUT/mesh.glb", "--json"]
            yield f"counted {name}", ["mesh", path, "--triangles", "300", "-o", "OUT/mesh.ply", "--json"]
            yield f"normals {name}", ["mesh", path, "--tol", "0.5%", "--normals", "creased:40", "-o", "OUT/mesh.obj"]
            if path.stat().st_size < LARGEST // 8:
                yield f"lod {name}", ["lod", path, "--px", "1", "-o", "OUT/levels.glb", "--json"]
                yield f"bake {name}", ["bake", path, "--cells", "24", "-o", "OUT/field.npy", "--json"]
                yield f"render {name}", ["render", path, "--size", "160x120", "-o", "OUT/picture.png", "--json"]
                yield f"cage {name}", ["mesh", path, "--surface", "limit", "--tol", "1%", "-o", "OUT/limit.ply", "--json"]
                yield f"deviation {name}", ["deviation", path, ROOT / "examples" / "cube.obj", "--json"]
        elif kind in VOLUMES:
            yield f"mesh {name}", ["mesh", path, "--iso", "0.5", "--tol", "2", "-o", "OUT/mesh.ply", "--json"]
            yield f"labels {name}", ["mesh", path, "--labels", "all", "--tol", "2", "-o", "OUT/mesh.glb", "--json"]
        elif kind in {".bpt", ".json", ".svg", ".vm", ".star", ".txt"}:
            for tol in ("1%", "0.2%"):
                yield f"mesh {tol} {name}", ["mesh", path, "--tol", tol, "-o", "OUT/mesh.ply", "--json"]
            yield f"pixels {name}", ["mesh", path, "--px", "1", "-o", "OUT/mesh.stl"]
            yield f"preview {name}", ["mesh", path, "--tol", "0.5%", "--require", "measured", "-o", "OUT/mesh.glb"]
            yield f"render {name}", ["render", path, "--size", "160x120", "-o", "OUT/picture.png", "--json"]
            yield f"polyline {name}", ["mesh", path, "--tol", "0.5%", "--to", "svg", "-o", "OUT/line.svg", "--json"]
    for verb in ("mesh", "lod", "mend", "bake", "render", "inspect", "deviation"):
        yield f"help {verb}", [verb, "--help"]


def outcome(chordal, words, limit):
    """What one run says and writes."""
    with tempfile.TemporaryDirectory() as folder:
        command = [str(chordal), *(str(word).replace("OUT/", f"{folder}/") for word in words)]
        if words[0] not in ("help",) and "--help" not in words:
            command += ["--max-memory", "1G"] + ([] if words[0] == "inspect" else ["--threads", "1"])
        try:
            done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=limit, check=False)
        except subprocess.TimeoutExpired:
            return {"exit": "timeout"}
        said = {stream: VOLATILE.sub("TIME", text.replace(folder, "OUT")) for stream, text in
                (("stdout", done.stdout), ("stderr", done.stderr))}
        files = {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
                 for path in sorted(Path(folder).rglob("*")) if path.is_file()}
    return {"exit": done.returncode, **said, "files": files}


def outcomes(chordal, only, limit):
    """Of all runs whose name matches, by name."""
    named = {name: words for name, words in jobs() if re.search(only, name)}
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        results = pool.map(lambda words: outcome(chordal, words, limit), named.values())
        return dict(zip(named, results, strict=True))


def difference(name, before, after, sums):
    """Lines that say how a run differs; none where it does not, or where one of both took too long."""
    if "timeout" in (before["exit"], after["exit"]):
        return [f"{name}: timeout"] if before["exit"] != after["exit"] else []
    keys = ("exit", "files") if sums else ("exit", "files", "stdout", "stderr")
    lines = []
    for key in keys:
        old, new = before[key], after[key]
        if old == new:
            continue
        if isinstance(old, str):
            told = difflib.unified_diff(old.splitlines(), new.splitlines(), lineterm="", n=0)
            lines += [f"{name}: {key}", *(f"    {line[:300]}" for line in list(told)[2:12])]
        else:
            lines.append(f"{name}: {key} was {old}, is {new}")
    return lines


def main():
    """Records, or compares and fails where anything differs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("record", "compare"))
    parser.add_argument("chordal", type=Path, help="the command to run")
    parser.add_argument("file", type=Path, help="where the outcomes are kept")
    parser.add_argument("--sums", action="store_true", help="leave out what is said")
    parser.add_argument("--only", default="", metavar="REGEX", help="the runs whose names match")
    parser.add_argument("--limit", type=float, default=LIMIT, metavar="SECONDS", help="for each run")
    asked = parser.parse_args()
    if not DATA.is_dir():
        print(f"NOTE: only the examples are run, because there is no {DATA}.", file=sys.stderr)
    now = outcomes(asked.chordal.resolve(), asked.only, asked.limit)
    if asked.what == "record":
        asked.file.write_text(json.dumps(now, indent=1))
        print(f"{len(now)} runs recorded.")
        return
    before = {name: told for name, told in json.loads(asked.file.read_text()).items() if re.search(asked.only, name)}
    lines = [line for name in before.keys() & now.keys() for line in difference(name, before[name], now[name], asked.sums)]
    print(*lines, sep="\n")
    differing = len({line.split(":")[0] for line in lines if not line.startswith(" ")})
    print(f"{len(now)} runs, {differing} differ; {len(before.keys() ^ now.keys())} are in one of both alone.")
    sys.exit(1 if lines else 0)


if __name__ == "__main__":
    main()
