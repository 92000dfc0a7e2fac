"""Writes docs/gallery.md: twenty of the parts, each with a picture, its triangles and its bound, and the docs' other pictures.

    python gallery.py --command target/release/chordal

Pictures and numbers are those of meshes at 0.1 % of the size; `make pictures` makes them again.
"""

from __future__ import annotations

import argparse
import json
import math
import shlex
import subprocess
import tempfile
from itertools import zip_longest
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
DOCS = FOLDER.parent.parent / "docs"

#: The parts, and the captions of their pictures.
PARTS = {
    "printed_hinge": "A hinge printed in place: two leaves, five knuckles, a pin with 0.3 mm of play",
    "gridfinity_bin": "A bin of two units on stepped feet",
    "knurled_knob": "The head of a thumb screw, with 24 grooves",
    "jar_neck": "The neck of a jar with a thread M30, pitch 3.5",
    "involute_gear": "Twelve involute teeth of module 3",
    "herringbone_gear": "Two twisted halves, each the mirror image of the other",
    "geneva_wheel": "A Geneva wheel with six slots and six hollows",
    "lantern_pinion": "Two discs with eight pins between them",
    "timing_pulley": "Twenty round grooves between two flanges",
    "valve_wheel": "Five spokes, and a hub with a square hole",
    "universal_joint": "Two forks at right angles and the cross between them",
    "spool_holder": "Two uprights with notches on a board",
    "wire_spring": "A zigzag of wire between two plates",
    "truss": "A truss of round rods with balls at its nodes",
    "rod_lattice": "A lattice of round struts",
    "schwarz_cube": "One period of the Schwarz P surface",
    "mug": "A cup with a handle that ends in its wall",
    "chess_pawn": "A pawn: a turned foot, a collar and a ball",
    "dog_tag": "A plate with a raised rim and letters",
    "starfish": "Five tapering arms around a ball",
}

HEAD = """\
# Gallery: parts as code
Twenty of the 179 everyday parts in `tests/parts`, each a [shape script](shape-scripts.md) of a few lines. Every part becomes a
closed, manifold mesh, and the tests compare its volume with a value calculated without Chordal. A picture is made by

```sh
chordal mesh tests/parts/NAME.star --tol 0.1% -o NAME.ply
chordal render NAME.ply --size 360x270 -o NAME.png
```

The *bound* limits how far a point of the mesh is from the shape, and a point of the shape from the mesh; *allowed* is the
budget, 0.1 % of the size. If the proof of a bound does not end, the mesh is measured: *at least* is the largest distance
found, and the report lists the places without a proof ([bounds](bound.md)).

"""

#: The other pictures of the docs, and the commands that take them.
OTHERS = {
    **{
        name: f"render examples/{name}.star"
        for name in ("block", "bracket", "gyroid", "gyroid_cube", "blobs", "angle_bracket", "creature")
    },
    "twisted_bolt": 'render examples/twisted_bolt.star --view "480x360 fov=30 eye=60,-80,25 target=0,0,-17"',
    "gear": 'render examples/gear.star --view "480x360 fov=35 eye=25,-55,70 target=0,0,0"',
    "enclosure": 'render examples/enclosure.star --view "480x360 fov=35 eye=-25,-62,110 target=0,0,9"',
    "vase": 'render examples/vase.star --view "480x360 fov=35 eye=70,-140,130 target=0,0,44"',
    "cube": "render examples/cube.obj --show wire --tol 1%",
    "zebra": "render examples/cube.obj --show zebra",
    "overshade": "render examples/teapot.bpt --show overshade --cull back",
    "sponge": "render examples/sponge.star",
}
TAIL = """
## Other pictures of these pages
Each is made by the command below it, with `--size 480x360` where it names no view, and `-o NAME.png`.

"""


def other(program: str, name: str) -> str:
    """A cell of the other table: a picture, taken by its command, and that command."""
    size = [] if "--view" in OTHERS[name] else ["--size", "480x360"]
    command([program, *shlex.split(OTHERS[name]), *size, "-o", str(DOCS / "pictures" / f"{name}.png"), "--force", "-q"])
    return f"![{name}](pictures/{name}.png) `chordal {OTHERS[name]}`"


def command(words: list[str]) -> str:
    return subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True).stdout


def rounded_up(length: float) -> str:
    """Three digits that are no less than a bound."""
    digits = 2 - math.floor(math.log10(length))
    return f"{math.ceil(length * 10**digits) / 10**digits:.{max(digits, 0)}f}"


def entry(program: str, name: str, words: str) -> str:
    """A cell of the table: the picture of a part's mesh, its triangles and its bound."""
    picture = DOCS / "pictures" / "parts" / f"{name}.png"
    picture.parent.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        mesh = f"{folder}/part.ply"
        made = command([program, "mesh", str(FOLDER / f"{name}.star"), "--tol", "0.1%", "-o", mesh, "--json"])
        command([program, "render", mesh, "--size", "360x270", "-o", str(picture), "--force", "-q"])
    certificate = json.loads(made)["certificate"]
    bound, triangles = certificate["bound"], certificate["output"]["triangles"]
    if bound["at_most"] is None:
        known = f"at least {bound['at_least']:.3g} (measured)"
    else:
        known = f"{rounded_up(bound['at_most'])} ({bound['evidence']})"
    asked = rounded_up(certificate["budget"]["length"])
    return (
        f"![{name}](pictures/parts/{name}.png) `{name}.star`: {words}. {triangles:,} triangles; bound {known}, {asked} allowed"
    )


def table(cells: list[str]) -> str:
    """Two cells a row."""
    rows = [f"| {a} | {b} |\n" for a, b in zip_longest(cells[::2], cells[1::2], fillvalue="")]
    return "| | |\n|---|---|\n" + "".join(rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--command", required=True)
    program = parser.parse_args().command
    parts = table([entry(program, name, words) for name, words in PARTS.items()])
    (DOCS / "gallery.md").write_text(HEAD + parts + TAIL + table([other(program, name) for name in OTHERS]), encoding="utf-8")


if __name__ == "__main__":
    main()
