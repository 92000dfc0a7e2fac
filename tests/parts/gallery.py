"""Writes docs/gallery.md: twenty of the parts, each with a picture, its command, and what came of it.

    python gallery.py --command target/release/chordal

Both the pictures and the numbers are of the meshes at 0.1 % of the size: `make pictures` takes them again.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import tempfile
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
DOCS = FOLDER.parent.parent / "docs"

#: The parts, and what their pictures show.
PARTS = {
    "printed_hinge": "A hinge that is printed in place: five knuckles, a pin with 0.3 mm of play, two leaves",
    "gridfinity_bin": "A bin of two units on stepped feet",
    "knurled_knob": "A thumb screw's head with 24 grooves",
    "jar_neck": "The neck of a jar: a thread M30 with a pitch of 3.5",
    "involute_gear": "Twelve involute teeth of module 3",
    "herringbone_gear": "Two twisted halves, each the mirror image of the other",
    "geneva_wheel": "A Geneva wheel: six slots, six hollows",
    "lantern_pinion": "Two discs with eight pins between them",
    "timing_pulley": "Twenty round grooves between two flanges",
    "valve_wheel": "Five spokes, and a hub with a square hole",
    "universal_joint": "Two forks at right angles and the cross between them",
    "spool_holder": "Two uprights with notches on a board",
    "wire_spring": "A zigzag of wire between two plates",
    "truss": "A truss of round rods with balls at its nodes",
    "rod_lattice": "A lattice of round struts",
    "schwarz_cube": "One period of Schwarz' surface P",
    "mug": "A cup with a handle that ends in its wall",
    "chess_pawn": "A pawn: a turned foot, a collar, a ball",
    "dog_tag": "A plate with a raised rim and letters",
    "starfish": "Five tapering arms around a ball",
}

HEAD = """\
# Gallery: parts as code
Twenty of the 179 everyday parts in `tests/parts`, each a few lines of [shape script](shape-scripts.md). Every one becomes a
closed, manifold mesh; the tests compare its volume with one that is calculated without Chordal. The pictures show the
triangles of

```sh
chordal mesh tests/parts/NAME.star --tol 0.1% -o NAME.ply
```

and the *bound* is how far any point of the mesh is from the shape, and of the shape from the mesh, at most. Where the proof of
it does not end, the mesh is measured, and the report lists the places ([bounds](bound.md)).

"""


def command(words: list[str]) -> str:
    return subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True).stdout


def rounded_up(length: float) -> str:
    """Three digits that are no less than a bound."""
    digits = 2 - math.floor(math.log10(length))
    return f"{math.ceil(length * 10**digits) / 10**digits:.{max(digits, 0)}f}"


def entry(program: str, name: str, words: str) -> str:
    """The picture of a part's mesh, and what is known of it."""
    picture = DOCS / "pictures" / "parts" / f"{name}.png"
    picture.parent.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        mesh = f"{folder}/part.ply"
        made = command([program, "mesh", str(FOLDER / f"{name}.star"), "--tol", "0.1%", "-o", mesh, "--json"])
        command([program, "render", mesh, "--size", "360x270", "-o", str(picture), "--force", "-q"])
    certificate = json.loads(made)["certificate"]
    bound, triangles = certificate["bound"], certificate["output"]["triangles"]
    if bound["at_most"] is None:
        known = f"measured, {bound['at_least']:.3g} at least"
    else:
        known = f"{rounded_up(bound['at_most'])} ({bound['evidence']})"
    asked = rounded_up(certificate["budget"]["length"])
    return (
        f"![{name}](pictures/parts/{name}.png) `{name}.star`: {words}. {triangles:,} triangles; bound {known}, {asked} allowed"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--command", required=True)
    program = parser.parse_args().command
    cells = [entry(program, name, words) for name, words in PARTS.items()]
    rows = [f"| {a} | {b} |\n" for a, b in zip(cells[::2], cells[1::2], strict=True)]
    (DOCS / "gallery.md").write_text(HEAD + "| | |\n|---|---|\n" + "".join(rows), encoding="utf-8")


if __name__ == "__main__":
    main()
