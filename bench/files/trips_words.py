"""The part of docs/corpus.md about round trips: its text, its table, and the words by which a note names a trait."""

import re
from collections import Counter

PATTERNS = (
    ("colors of faces", "propert"), ("normals", "normals"), ("tangents", "tangents"), ("texcoords", "texture coordinates|texcoord"), ("colors", "colou?r"),
    ("joints", "joint|weights|skin"), ("skins", "joint|weights|skin"), ("morph", "morph|target"), ("animations", "animation"),
    ("cameras", "camera"), ("lights", "light"), ("textures", "texture[^s ]|textures|picture|looks"), ("names of materials", "material|looks"),
    ("names of parts", "parts?\\b|names? of|groups '[og]'"), ("names of meshes", "names? of"), ("points and lines", "lines|points"), ("extras", "extras"),
)


def pattern_of(trait):
    """The words that name a trait in a note or a warning."""
    for start, pattern in PATTERNS:
        if trait.startswith(start):
            return pattern
    return re.escape(trait.split()[-1]) + "|propert|attribute|values|element"


def findings(row):
    """What is wrong with a conversion, in a form that files share."""
    numbered = [re.sub(r"\d+ triangles of \d+", "another number of triangles", what).split(": [")[0] for what in row["findings"]]
    return numbered + [f"{trait} lost without a note" for trait in row.get("silent", [])]


def all_findings(rows):
    """A line for each finding."""
    return [f"{row['name']} to {row['writer']}: {what}" for row in rows for what in row["findings"] + row.get("silent", [])]


ABOUT = """
## Round trips
`bench/files/round_trips.py` converts every mesh and every cage of the folder below 5 MB to every format ({files} files,
{trips} conversions). Chordal and the program in the row read the result; triangles, boxes, attributes, and names of
materials and parts are compared. *Refused* counts conversions that end with the message that the format cannot hold
the shape: cages in formats of triangles, points alone, coordinates beyond f32. The last column lists properties that
the format does not hold, with the number of files; a note of `chordal convert`, or a warning about the input, says so.

| to | converted | refused | read back by | same number of triangles | lost, with a note |
|---|---|---|---|---|---|
"""

ABOUT_FINDINGS = """
Losses without a note, and files that the other program does not read:

| to | files | finding | first file |
|---|---|---|---|
"""

# Why, for those that are not Chordal's.
REASONS = (
    ("MeshLab counts another number of triangles", "it drops triangles that use a vertex twice, and cuts polygons in its own way"),
    ("Invalid Model Coordinate Indices", "3MF forbids triangles that use a vertex twice"),
    ("Invalid Model Coordinates", "coordinates beyond lib3mf's limit"),
    ("No vertex found", "a file without vertices"),
    ("'ascii' codec", "a name in the certificate is not ASCII, but the header of a PLY has to be"),
)


def safe(text):
    """A text that means itself in a cell of Markdown."""
    for mark in "\\`*_<>[]|":
        text = text.replace(mark, "\\" + mark)
    return text


def section(rows, writers):
    """The end of docs/corpus.md."""
    text = ABOUT.strip().format(files=f"{len({row['name'] for row in rows}):,}", trips=f"{len(rows):,}")
    lines = text.split("\n")
    for writer, reader in writers.items():
        mine = [row for row in rows if row["writer"] == writer]
        done = [row for row in mine if row["code"] == 0]
        asked = [row for row in done if "reader" in row]
        refused = Counter(row["error"] for row in mine if row["code"] != 0)
        noted = Counter(trait.split(" property")[0] for row in done for trait in row.get("lost", []) if trait not in row.get("silent", []))
        often = ", ".join(f"{trait} {n:,}" for trait, n in sorted(noted.items(), key=lambda x: (-x[1], x[0])) if not trait.startswith(("property", "primvar", "face", "element")))
        refusals = ", ".join(f"{code} {n}" for code, n in sorted(refused.items()))
        agree = f"{sum(row['reader'] for row in asked)} of {len(asked)}"
        lines.append(f"| {writer} | {len(done)} | {refusals} | {reader} | {agree} | {safe(often)} |")
    grouped = {}
    for row in rows:
        for what in findings(row):
            grouped.setdefault((row["writer"], what), []).append(row["name"])
    if grouped:
        lines += ABOUT_FINDINGS.rstrip().split("\n")
    for (writer, what), names in sorted(grouped.items()):
        why = next((why for key, why in REASONS if key in what), "")
        lines.append(f"| {writer} | {len(names)} | {safe(what)}{': ' + why if why else ''} | {safe(names[0])} |")
    return "\n".join(lines) + "\n"
