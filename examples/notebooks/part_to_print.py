# ---
# jupyter: {kernelspec: {display_name: Python 3, language: python, name: python3}}
# ---
# %% [markdown]
# # A part as code, to a file for a printer
#
# A shelf bracket: a plate, a rib, two holes. Its size is three numbers; how much error may be seen is one more.

# %%
import tempfile
from pathlib import Path

import chordal
from chordal.shapes import box, cylinder, move, rotate_x, rounded_box, smooth_union


def bracket(width: float = 40, height: float = 50, thick: float = 5) -> chordal.Field:
    """A bracket that stands on its lower leg, in millimetres."""
    leg = move(rounded_box(width, height, thick, 1), 0, height / 2, thick / 2)
    wall = move(rounded_box(width, thick, height, 1), 0, thick / 2, height / 2)
    rib = move(rotate_x(box(thick, height, thick), 45), 0, height / 3, height / 3)
    hole = cylinder(2.2, 4 * thick)
    holes = move(hole, width / 4, height * 0.7, 0) | move(hole, -width / 4, height * 0.7, 0)
    return (smooth_union(leg, wall, radius=3) | rib) - holes


part = bracket()
part

# %% [markdown]
# A twentieth of a millimetre is finer than a nozzle. The mesh says how far it is off, and that this is proved.

# %%
mesh = part.mesh(tol=0.05)
print(mesh.bound.sentence())
print(f"{mesh.volume / 1000:.1f} cm³, watertight: {mesh.is_watertight}")
mesh

# %% [markdown]
# A slicer wants a 3MF, which knows its unit. The report says what is in the file, after its own rounding.

# %%
with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "bracket.3mf"
    report = chordal.Mesh(mesh.vertices, mesh.faces, unit="mm").export(path)
    again = chordal.load(path)
    assert isinstance(again, chordal.Mesh) and again.is_watertight
    print(path.name, report["run"]["bytes"], "bytes, off by", report["certificate"]["bound"]["at_most"], "more")

# %% [markdown]
# How many triangles does half the error take? About twice as many, once they are small.

# %%
costs = {tol: len(part.mesh(tol=tol).faces) for tol in (0.2, 0.1, 0.05)}
print(costs)
assert costs[0.2] <= costs[0.1] <= costs[0.05]
