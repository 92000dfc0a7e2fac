# ---
# jupyter:
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---
# %% [markdown]
# # A part as code, to a file for a printer
#
# A shelf bracket in a few lines of Python: two plates, a rib between them, four screw holes. Chordal turns it into triangles
# that are nowhere more than a twentieth of a millimetre from the exact shape, proves that, and writes the 3MF that a slicer
# opens.
#
# ## The part
#
# A shape is a function of points, negative inside. `|` joins shapes, `-` cuts one off another, and `&` keeps what both have.
# The words know no unit; all lengths here are meant as millimetres.

# %%
import tempfile
from pathlib import Path

import chordal
from chordal.shapes import box, cylinder, move, plane, rotate_x, rounded_box, symmetric


def bracket(width: float = 40, height: float = 50, thick: float = 5) -> chordal.Field:
    """A bracket whose leg lies on the plane z = 0 and whose wall stands on y = 0, in millimetres."""
    half = height / 2
    leg = move(box(width, height, thick), 0, half, thick / 2)
    wall = move(box(width, thick, height), 0, thick / 2, half)
    rib = move(box(thick, height, height), 0, half, half) & plane((0, 1, 1), 0.6 * height)
    edges = move(rounded_box(width, height, height, 1), 0, half, half)
    screw = cylinder(2.2, 4 * thick)
    in_leg = move(screw, width / 4, 0.7 * height, 0)
    in_wall = move(rotate_x(screw, 90), width / 4, 0, 0.7 * height)
    return ((leg | wall | rib) & edges) - symmetric(in_leg | in_wall, 1, 0)


part = bracket()
inside, above = part([(0, 25, 2), (0, 40, 30)])
print(f"in the leg {inside:.1f}, above it {above:.1f}")
part.render(size=(640, 480), view="640x480 fov=30 eye=80,150,100 target=0,20,20")

# %% [markdown]
# ## Triangles, with their bound
#
# `tol` is what may be lost: 0.05 mm, an eighth of a usual nozzle. `bound` is what was lost. It is between two numbers, and the
# upper one is proved: no point of the mesh is farther from the exact shape, and no point of the shape is farther from the mesh.

# %%
mesh = part.mesh(tol=0.05)
print(mesh.bound.sentence())
print(f"{mesh.volume / 1000:.1f} cm³, watertight: {mesh.is_watertight}")
assert mesh.bound.evidence == "proved" and mesh.is_watertight
mesh.show(wire=True)

# %% [markdown]
# What do fewer triangles cost? Flat faces are exact with any number of them; what gets finer is the round edges and the holes.

# %%
coarse = part.mesh(tol=0.2)
print(f"within 0.2 mm: {len(coarse.faces):,} triangles; within 0.05 mm: {len(mesh.faces):,}")

# %% [markdown]
# ## The file
#
# A 3MF says its unit, so this is where millimetres come in. The report is about the file as it was written: `valid` is what a
# slicer asks for, its bound is what writing has lost, and the `total` of its `history` how far the file is from the part itself.
# The file carries both, and `verify` proves them again. To print it, take a folder that stays.

# %%
with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "bracket.3mf"
    report = chordal.scene({"bracket": mesh}, unit="mm", up="z").export(path)
    printed = chordal.load(path)
    verified = chordal.verify(path, [mesh, part])

assert isinstance(printed, chordal.Mesh) and printed.is_watertight and printed.unit == "mm"
print("its size in millimetres:", printed.extents)
total = report["certificate"]["history"]["total"]
print(f"the file is within {total['at_most']:.4f} mm of the part, {total['evidence']}; {verified['verdict']}")
assert total["at_most"] < 0.05 + 1e-9 and verified["verdict"] == "re-proved"
report
