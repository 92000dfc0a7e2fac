"""Every mesh of the test data through every writer and back, as Chordal and as other programs read the result.

Run by `make corpus` before corpus.py, for which it leaves out/round_trips.md; with --check it compares that with the end
of docs/corpus.md. What the result does not hold any more has to be named by a note of `chordal convert` or by a warning of
its input; what is not is a finding. All of them are in out/round_trips.json.
"""

import json
import re
import sys
import tempfile
from collections import Counter
from pathlib import Path

import trips_words as words
from corpus import DATA, OURS, OUT, PAGE, same_box, watched
from peers import Peers
from traits import OF_FORMAT, traits

# Larger ones say nothing that smaller ones do not, and the whole is to take minutes.
MOST_BYTES = 5_000_000
WRITERS = {
    "glb": "JSON", "gltf": "JSON", "obj": "MeshLab", "ply": "plyfile", "stl": "VTK", "off": "MeshLab", "3mf": "lib3mf",
    "usda": "OpenUSD", "vtp": "VTK",
}


def inspected(path):
    """What `chordal inspect` says, or the exit code where it refuses."""
    code, _, _, said = watched([OURS, "inspect", str(path), "--json"])
    return json.loads(said) if code == 0 else code


def shown(report):
    """Triangles and the box of the scene, y up."""
    parts, frame = report["inspection"]["parts"], report["certificate"]["frame"]
    box = report["inspection"]["box"]
    return sum(part["triangles"] * part["instances"] for part in parts), box, frame


def turned(box, frame_from, frame_to):
    """A box of a frame in another one: up from y to z, or back, and the unit."""
    if not box:
        return box
    scale = (frame_from["metres_per_unit"] or 1) / (frame_to["metres_per_unit"] or 1) if frame_from["metres_per_unit"] and frame_to["metres_per_unit"] else 1
    (x0, y0, z0), (x1, y1, z1) = [[scale * x for x in corner] for corner in box]
    if frame_from["up"] == "y" and frame_to["up"] == "z":
        return [[x0, -z1, y0], [x1, -z0, y1]]
    if frame_from["up"] == "z" and frame_to["up"] == "y":
        return [[x0, z0, -y1], [x1, z1, -y0]]
    return [[x0, y0, z0], [x1, y1, z1]]


def silent(lost, said):
    """Those of the lost traits that no note and no warning names."""
    return sorted(trait for trait in lost if not re.search(words.pattern_of(trait), said, re.IGNORECASE))


def trip(name, before, source_traits, ending, folder, peers):
    """One file through one writer."""
    target = folder / f"x.{ending}"
    code, seconds, _, said = watched([OURS, "convert", str(DATA / name), str(target), "--force", "--json"])
    row = {"name": name, "writer": ending, "code": code, "seconds": round(seconds, 3), "findings": []}
    if code != 0:
        error = json.loads(said).get("error", {}) if said else {}
        return {**row, "error": error.get("code", "none"), "message": " ".join(error.get("messages", [])).replace(str(DATA), "")}
    report = json.loads(said)["certificate"]
    notes, warnings = report["notes"], [f"{w['code']} {w['message']}" for w in report["input"]["warnings"]]
    row["notes"] = notes
    after = inspected(target)
    if isinstance(after, int):
        row["findings"].append("the result is refused" if after > 0 else "the result is not read within 60 s")
        return row
    row["warnings_after"] = [f"{w['code']} {w['count']}" for w in after["certificate"]["input"]["warnings"]]
    spoken = "\n".join(notes + warnings)
    if before["certificate"]["input"]["kind"] == "triangles" and after["certificate"]["input"]["kind"] == "triangles":
        (n_before, box_before, from_frame), (n_after, box_after, to_frame) = shown(before), shown(after)
        left_out = sum(int(n) for note in notes for n in re.findall(r"corner twice \((\d+)x\)", note))
        if n_before != n_after + left_out:
            row["findings"].append(f"triangles: {n_before} became {n_after}")
        says_unused = any("vertices beside those of its triangles" in note for note in notes)
        if n_before and not says_unused and not same_box(turned(box_before, from_frame, to_frame), box_after):
            row["findings"].append(f"box: {box_before} became {box_after}")
        theirs = peers.ask(WRITERS[ending], target)
        wanted = n_after if "triangles" in theirs and ending not in ("3mf", "glb", "gltf") else sum(
            part["triangles"] for part in after["inspection"]["parts"])
        row["reader"] = theirs.get("triangles") == wanted
        if "error" in theirs:
            error = theirs["error"].split("details: ")[-1].replace(str(target), target.name)
            row["findings"].append(f"{WRITERS[ending]} does not read it: {error}"[:160])
        elif theirs["triangles"] != wanted:
            row["findings"].append(f"{WRITERS[ending]} counts {theirs['triangles']} triangles of {wanted}")
    try:
        now = traits(target)
    except Exception as error:  # What it cannot read is a finding, whatever it raises.
        row["findings"].append(f"traits: {error}"[:160])
        return row
    lost = source_traits[0] - now[0]
    row["lost"] = sorted(lost)
    row["materials"] = [len(source_traits[1]), len(source_traits[1] & now[1]), len(now[1])]
    if source_traits[1] - now[1] - {""}:
        lost.add("names of materials")
    if source_traits[2] - now[2] - now[3] - {""}:
        keeps_nodes = source_traits[3] and source_traits[3] <= now[2] | now[3]
        lost.add("names of meshes beside those of their nodes" if keeps_nodes else "names of parts")
    row["silent"] = silent(lost, spoken)
    return row


def main():
    """Converts everything, then writes the part of the page, or compares it."""
    if not DATA.is_dir():
        print(f"SKIPPED: the round trips of the test data, because there is no folder {DATA}.")
        return
    peers, rows = Peers(), []
    names = sorted(str(p.relative_to(DATA)) for p in DATA.rglob("*") if p.is_file() and p.suffix.lower() in OF_FORMAT)
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            if (DATA / name).stat().st_size > MOST_BYTES:
                continue
            before = inspected(DATA / name)
            if isinstance(before, int):
                continue
            source_traits = traits(DATA / name)
            rows += [trip(name, before, source_traits, ending, Path(folder), peers) for ending in WRITERS]
    peers.stop()
    OUT.mkdir(exist_ok=True)
    (OUT / "round_trips.json").write_text(json.dumps(rows, indent=1))
    text = words.section(rows, WRITERS)
    found = [f"{r['name']} to {r['writer']}: exit code {r['code']}" for r in rows if r["code"] not in (0, 2, 3, 4)]
    for line in words.all_findings(rows):
        print(line)
    if "--check" in sys.argv:
        kept = "## Round trips" + PAGE.read_text().split("\n## Round trips")[-1]
        old, new = kept.strip().split("\n"), text.strip().split("\n")
        found += [f"docs/corpus.md says: {x}" for x in old if x not in new] + [f"but it is now: {x}" for x in new if x not in old]
    else:
        (OUT / "round_trips.md").write_text(text)
    for line in found:
        print(line)
    codes = Counter(row["code"] for row in rows)
    print(f"{len(rows)} conversions, exit codes {dict(codes)}, {len(found)} findings")
    sys.exit(bool(found))


if __name__ == "__main__":
    main()
