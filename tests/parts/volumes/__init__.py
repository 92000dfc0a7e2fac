"""What the volume of each part is, by a formula or by sampling its own membership test; nothing here calls Chordal.

`python -m volumes` (in tests/parts, with numpy) compares the lines `# volume:` of the scripts with what these functions
say; `--write` writes them. A module for each kind of part, a function for each part.
"""

from __future__ import annotations

from . import boxes, gears, grids, hinges, holders, letters, organic, threads

KINDS = {
    "holders and brackets": holders,
    "boxes with lids": boxes,
    "hinges and snaps": hinges,
    "threads and knobs": threads,
    "gears": gears,
    "letters and badges": letters,
    "grids and lattices": grids,
    "organic blends": organic,
}
