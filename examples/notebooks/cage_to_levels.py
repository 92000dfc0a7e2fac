# ---
# jupyter:
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---
# %% [markdown]
# # From a cage to levels of detail, one pixel off at any distance
#
# A cage is a handful of polygons that stands for a smooth surface. Seen from afar that surface needs few triangles, and from
# near many. This notebook makes the levels that a viewer switches between, so that no switch and no level shows an error of
# more than a pixel, and proves each of them against the smooth surface itself.
#
# ## The cage
#
# Two boxes on top of each other: ten polygons, coordinates in metres. `creases` keeps four edges of the bottom sharp for two
# steps of subdivision, then they are smoothed as the others are (Catmull–Clark).

# %%
import tempfile
from pathlib import Path

import chordal

corners = [(x, y, z) for z in (0, 1, 3) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
sides = [(4 * k + a, 4 * k + (a + 1) % 4, 4 * k + 4 + (a + 1) % 4, 4 * k + 4 + a) for k in (0, 1) for a in range(4)]
cage = chordal.Cage(corners, [(3, 2, 1, 0), *sides, (8, 9, 10, 11)], creases=[(0, 1, 2), (1, 2, 2), (2, 3, 2), (0, 3, 2)])
smooth = cage.shape(unit="m")
smooth.render(size=(640, 480))

# %% [markdown]
# ## The levels
#
# `view` is the screen: its size in pixels and its vertical angle in degrees. A level is good from the distance on at which its
# error is one pixel there; halving the distance takes half the error. `rel` is how fine the finest is, as a share of the
# diagonal.

# %%
levels = smooth.lod(pixels=1, view="1920x1080 fov=60", rel=0.002)
for k, level in enumerate(levels):
    off = f"off by at most {1000 * level.bound.at_most:2.0f} mm"
    print(f"level {k}: {len(level.mesh.faces):5,} triangles, {off}, from {level.distance:5.1f} m on")
assert all(level.bound.evidence == "proved" for level in levels)
print(f"at 50 m a viewer takes the level with {len(levels.at(50).mesh.faces):,} triangles")

# %% [markdown]
# The coarsest level to be turned by hand, with its edges, coloured by how far its vertices are from the finest one.

# %%
levels[-1].mesh.show(deviation=levels[0].mesh, wire=True)

# %% [markdown]
# ## The file
#
# One glTF holds all levels, with the shares of the screen at which viewers switch. A folder instead of a file name gives 3D
# Tiles.

# %%
with tempfile.TemporaryDirectory() as folder:
    report = levels.export(Path(folder) / "cage.glb")
    print(f"{report['run']['bytes']:,} bytes for {len(levels)} levels in one glTF")
