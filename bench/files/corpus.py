"""Runs `chordal inspect` on every file of the test data, counts the same with other programs, and writes docs/corpus.md.

Run by `make corpus`; with --check (`make corpus-check`) it writes nothing, and fails where the page would be another. It
also fails for a crash, a run over time, and a count that nobody explains. Times and peaks go to out/corpus.json.
"""

import json
import os
import subprocess
import sys
import threading
import time
from collections import Counter
from pathlib import Path

import reasons
from peers import Peers

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
DATA = Path(os.environ.get("CHORDAL_DATA", ROOT.parent / "shared" / "data"))
OURS = os.environ.get("CHORDAL", str(ROOT / "target" / "release" / "chordal"))
PAGE = ROOT / "docs" / "corpus.md"
OUT = HERE.parent / "out"
# Over these a file counts as one that hangs or takes too much: what the library's tests ask of hostile files.
MOST_SECONDS = 60
MOST_BYTES = (64 << 20, 16)
# The f32 of VTK's points: two units in the last place.
SAME_BOX = 2.0**-22

READERS = {
    "obj": ["trimesh", "MeshLab", "VTK", "lines"], "ply": ["plyfile", "trimesh", "MeshLab"],
    "off": ["trimesh", "MeshLab", "numbers"], "stl": ["VTK", "trimesh", "MeshLab"], "gltf": ["JSON", "trimesh"],
    "glb": ["JSON", "trimesh"], "3mf": ["lib3mf", "trimesh"], "dae": ["MeshLab", "trimesh"], "nii": ["nibabel"],
    "vti": ["VTK"], "slc": ["VTK"], "mha": ["VTK"], "npy": ["NumPy"], "svg": ["svgelements"], "teaset": ["first line"], "vm": ["steps"],
}
KINDS = {"triangles": "triangles", "cage": "cage", "field": "field", "volume": "samples", "drawing": "drawing", "patches": "patches"}


def watched(command):
    """Exit code (negative: a signal), seconds, peak bytes and stdout of a command, killed when it is over time."""
    start = time.perf_counter()
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
        timer = threading.Timer(MOST_SECONDS, process.kill)
        timer.start()
        said = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, time.perf_counter() - start, 1024 * usage.ru_maxrss, said


def counts(report):
    """What Chordal counts, under the names of readers.py."""
    output, seen = report["certificate"]["output"], report["inspection"]
    kind = report["certificate"]["input"]["kind"]
    if kind == "triangles":
        return {
            "vertices": output["vertices"], "triangles": output["triangles"], "parts": len(seen["parts"]),
            "shown": sum(part["triangles"] * part["instances"] for part in seen["parts"]),
        }
    if kind == "cage":
        corners = seen["cage"]["faces_by_corners"]
        return {
            "vertices": output["vertices"], "polygons": output["faces"],
            "triangles": sum((int(n) - 2) * faces for n, faces in corners.items()),
        }
    if kind == "volume":
        return {key: seen["volume"][key] for key in ("size", "low", "high")}
    if kind == "drawing":
        return {key: seen["drawing"][key] for key in ("elements", "subpaths")}
    return {"terms": seen["field"]["terms"]} if kind == "field" else {"patches": seen["patches"]}


def counts_in_words(found):
    """The counts as a cell of the table."""
    if "size" in found:
        return " × ".join(map(str, found["size"])) + f", {found['low']:.6g} to {found['high']:.6g}"
    names = {"vertices": "v", "triangles": "t", "polygons": "polygons"}
    words = [f"{found[key]:,} {names.get(key, key)}" for key in found if key not in ("parts", "shown")]
    if "polygons" in found:
        words = [word for word in words if not word.endswith(" t")]
    if found.get("parts", 1) != 1:
        words.append(f"{found['parts']} parts")
    if found.get("shown", 0) != found.get("triangles", 0) and "shown" in found:
        words.append(f"shown as {found['shown']:,} t")
    return ", ".join(words)


def same_box(a, b):
    """Whether two boxes are the same up to the rounding of f32."""
    if not a or not b:
        return bool(a) == bool(b)
    size = max(abs(x) for corner in a for x in corner)
    return all(abs(x - y) <= SAME_BOX * size for p, q in zip(a, b) for x, y in zip(p, q))


def difference(ours, box, theirs):
    """What a reader counts otherwise, as words with commas between; empty where all is the same."""
    if "error" in theirs:
        return "error"
    words = [key for key in ours if key in theirs and ours[key] != theirs[key]]
    if "box" in theirs and not same_box(box, theirs["box"]):
        words.append("box")
    return ",".join(words)


def judged(name, form, report, peers):
    """What each reader says of a file: its counts, and the difference to ours (None where we refuse the file)."""
    judgements = {}
    for reader in READERS.get(form, []):
        theirs = peers.ask(reader, DATA / name)
        differs = None
        if report is not None:
            differs = difference(counts(report), report["inspection"]["box"], theirs)
        judgements[reader] = {"counts": theirs, "differs": differs}
    return judgements


def look(name, peers):
    """Everything about one file."""
    code, seconds, peak, said = watched([OURS, "inspect", str(DATA / name), "--json"])
    row = {"name": name, "code": code, "seconds": round(seconds, 3), "peak": peak, "bytes": (DATA / name).stat().st_size}
    try:
        said = json.loads(said)
    except ValueError:
        return {**row, "fate": "crashed", "peers": {}}
    if code != 0:
        error = said["error"]
        form = Path(name).suffix[1:].lower()
        unknown = error["code"] == "unknown-format" or form in ("json", "npz")
        message = error["messages"][0].replace(f"{DATA / name}: ", "")
        return {
            **row, "fate": "refused", "error": error["code"], "message": message,
            "peers": {} if unknown else judged(name, form, None, peers),
        }
    given = said["certificate"]["input"]
    warnings = [[warning["code"], warning["count"]] for warning in given["warnings"]]
    beside = [str(Path(name).parent / file["path"]) for file in given.get("files", [])]
    return {
        **row, "fate": "read", "kind": given["kind"], "format": given["format"], "counts": counts(said),
        "warnings": warnings, "beside": beside, "peers": judged(name, given["format"], said, peers),
    }


def named_by(rows):
    """For files beside others: who names them, and whether it was read."""
    found = {}
    for row in rows:
        for file in row.get("beside", []):
            found.setdefault(os.path.normpath(file), (row["name"], True))
    for row in rows:
        path = DATA / row["name"]
        if row["fate"] != "read" and path.suffix == ".gltf":
            try:
                buffers = json.loads(path.read_bytes()).get("buffers", [])
            except ValueError:
                continue
            for uri in (buffer.get("uri", "") for buffer in buffers):
                found.setdefault(os.path.normpath(Path(row["name"]).parent / uri), (row["name"], False))
    return found


def sort_out(rows):
    """Gives each file that was refused without being known what it is."""
    parents = named_by(rows)
    for row in rows:
        if row["name"] in parents and row["fate"] == "refused":
            parent, was_read = parents[row["name"]]
            row["fate"] = "companion"
            row["what"] = f"{'read with' if was_read else 'named by'} {Path(parent).name}{'' if was_read else ', which is refused'}"
        elif row["fate"] == "refused" and row["error"] in ("unknown-format", "no-shapes", "wrong-type", "not-3d"):
            row["fate"], row["what"] = reasons.other(row["name"])


def of_peers(row):
    """The cell about other programs."""
    peers = row["peers"]
    if row["fate"] == "refused":
        refuse = [reader for reader, judgement in peers.items() if "error" in judgement["counts"]]
        read = [reader for reader in peers if reader not in refuse and reader not in ("lines", "JSON", "numbers")]
        return "; ".join(
            [f"refused by {', '.join(refuse)}"] * bool(refuse) + [f"read by {', '.join(read)}"] * bool(read)
        )
    agree = [reader for reader, judgement in peers.items() if judgement["differs"] == ""]
    if agree:
        return ", ".join(agree)
    return reasons.OF_FILES.get(row["name"], "no program reads it" if peers else "no other program")


def cells(row):
    """A row of the table without the name."""
    warnings = ", ".join(f"{code} {n:,}" if n > 1 else code for code, n in row.get("warnings", []))
    if row["fate"] == "read":
        return [f"{KINDS[row['kind']]}, {row['format']}", counts_in_words(row["counts"]), warnings, of_peers(row)]
    if row["fate"] == "refused":
        return ["refused", "", f"{row['error']}: {row['message']}", of_peers(row)]
    return [row["fate"], "", row.get("what", ""), ""]


def safe(text):
    """A text that means itself in a cell of Markdown."""
    for mark in "\\`*_<>[]|":
        text = text.replace(mark, "\\" + mark)
    return "".join(c if c.isprintable() else "�" for c in text)


def pattern(names, others):
    """One name for several files, if it fits no other file of the folder."""
    head, tail = os.path.commonprefix(names), os.path.commonprefix([name[::-1] for name in names])[::-1]
    tail = tail if tail.startswith(".") or "." in tail else ""
    tail = tail[tail.index("."):] if "." in tail else tail
    fits = [name for name in others if name.startswith(head) and name.endswith(tail) and len(name) >= len(head) + len(tail)]
    return f"{safe(head)}\\*{safe(tail)} ({len(names)} files)" if len(fits) == len(names) else None


def table(rows):
    """The rows of one folder; four and more that say the same are one."""
    groups = {}
    for row in rows:
        groups.setdefault((tuple(cells(row)), os.path.dirname(row["name"])), []).append(row["name"])
    lines = ["| file | result | counts | warnings or reason | other programs |", "|---|---|---|---|---|"]
    top = "/".join(rows[0]["name"].split("/")[:2]) + "/"
    for (cell, folder), names in groups.items():
        inside = [row["name"] for row in rows if os.path.dirname(row["name"]) == folder]
        short = lambda name: name.removeprefix(top) if name.startswith(top) else name
        texts = [safe(short(name)) for name in names]
        if len(names) >= 4:
            one = pattern([short(name) for name in names], [short(name) for name in inside])
            texts = [one or ", ".join(texts)]
        lines += [f"| {' | '.join([text, *map(safe, cell)])} |" for text in texts]
    return lines


def section_of(name):
    """The folder whose table a file is in."""
    parts = name.split("/")
    return parts[0] if len(parts) < 3 and parts[0] not in ("mesh", "corner", "gltf") else "/".join(parts[:2])


def readers_table(rows):
    """How often each reader agrees, and where it does not, why."""
    tally = {}
    for row in rows:
        for reader, judgement in row["peers"].items():
            if row["fate"] == "read":
                tally.setdefault((row["format"], reader), Counter())[judgement["differs"]] += 1
    lines = ["| format | reader | agrees | differs in | reason |", "|---|---|---|---|---|"]
    for (form, reader), kinds in sorted(tally.items()):
        others = sorted(kind for kind in kinds if kind) or [""]
        for at, kind in enumerate(others):
            agrees = f"{kinds['']} of {sum(kinds.values())}" if at == 0 else ""
            what = f"{kind.replace(',', ', ')}: {kinds[kind]}" if kind else ""
            what = f"not read: {kinds[kind]}" if kind == "error" else what
            lines.append(f"| {form if at == 0 else ''} | {reader if at == 0 else ''} | {agrees} | {what} | {reasons.OF_KINDS.get((form, reader, kind), '') if kind else ''} |")
    return lines


def page(rows):
    """The text of docs/corpus.md, without the part that round_trips.py writes."""
    fates = Counter(row["fate"] for row in rows)
    read = [row for row in rows if row["fate"] == "read"]
    warned = sum(bool(row["warnings"]) for row in read)
    asked = [row for row in read if row["peers"]]
    agreed = sum(any(j["differs"] == "" for j in row["peers"].values()) for row in asked)
    heavy = [row["name"] for row in rows if row["peak"] > MOST_BYTES[0] + MOST_BYTES[1] * row["bytes"]]
    text = reasons.ABOUT.format(
        files=len(rows), read=len(read), warned=warned, refused=fates["refused"], companions=fates["companion"],
        others=fates["other format"], texts=fates["text"], asked=len(asked), agreed=agreed,
        alone=len(read) - len(asked), crashed=fates["crashed"],
        heavy=", ".join(map(safe, heavy)) if heavy else "none",
    )
    lines = [*text.strip().split("\n"), "", "## The other programs", *reasons.ABOUT_READERS.strip().split("\n"), "", *readers_table(rows)]
    folders = {}
    for row in rows:
        folders.setdefault(section_of(row["name"]), []).append(row)
    for folder, inside in folders.items():
        title = folder if (DATA / folder).is_dir() else "the folder itself"
        lines += ["", f"## {title}", *table(inside)]
    return "\n".join(lines) + "\n"


def unexplained(rows):
    """Findings: what ended badly, and differences without a reason."""
    found = []
    for row in rows:
        if row["fate"] == "crashed" or row["code"] not in (0, 3):
            found.append(f"{row['name']}: exit code {row['code']} after {row['seconds']} s")
        kinds = {reader: judgement["differs"] for reader, judgement in row["peers"].items()}
        for reader, kind in kinds.items():
            if kind and (row["format"], reader, kind) not in reasons.OF_KINDS:
                found.append(f"{row['name']}: {reader} differs in {kind}: {row['peers'][reader]['counts']}, ours {row['counts']}")
        if row["fate"] == "read" and kinds and "" not in kinds.values() and row["name"] not in reasons.OF_FILES:
            found.append(f"{row['name']}: no reader agrees, and reasons.py does not say why")
    return found


def main():
    """Looks at every file, then writes or compares."""
    if not DATA.is_dir():
        print(f"SKIPPED: the table of the test data, because there is no folder {DATA}.")
        return
    peers = Peers()
    names = sorted(str(path.relative_to(DATA)) for path in DATA.rglob("*") if path.is_file())
    rows = [look(name, peers) for name in names]
    peers.stop()
    sort_out(rows)
    OUT.mkdir(exist_ok=True)
    (OUT / "corpus.json").write_text(json.dumps(rows, indent=1))
    found, text = unexplained(rows), page(rows)
    trips = OUT / "round_trips.md"
    before = PAGE.read_text() if PAGE.exists() else ""
    if "--check" in sys.argv:
        # The part about round trips is that of round_trips.py.
        kept = before.split("\n## Round trips")[0] if "\n## Round trips" in before else before
        new, old = text.strip().split("\n"), kept.strip().split("\n")
        gone, come = [x for x in old if x not in set(new)], [x for x in new if x not in set(old)]
        found += [f"docs/corpus.md says: {x}" for x in gone] + [f"but it is now: {x}" for x in come]
    else:
        tail = trips.read_text() if trips.exists() else ""
        PAGE.write_text(text + ("\n" + tail if tail else ""))
    for line in found:
        print(line)
    print(f"{len(rows)} files, {len(found)} findings; slowest {max(row['seconds'] for row in rows)} s")
    sys.exit(bool(found))


if __name__ == "__main__":
    main()
