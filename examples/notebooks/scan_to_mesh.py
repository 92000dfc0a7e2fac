# ---
# jupyter:
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---
# %% [markdown]
# # A scan to a mesh, half a millimetre off
#
# A scanner gives numbers on a lattice, here a magnetic resonance scan of a head; what one wants is a surface, and to know how
# good it is. This notebook needs nibabel, which reads such files and whose package carries the scan as an example of its own
# (`example4d.nii.gz`: 24 slices through the middle of a head, at two times, with steps of 2 × 2 × 2.2 mm).
#
# ## The scan
#
# The first of the two times is taken. A file that holds one volume needs one line: `scan = chordal.load("scan.nii.gz")`, and a
# folder of DICOM slices the same. Unit, steps and the oblique position in the scanner come along.

# %%
from pathlib import Path

import nibabel
import numpy as np
from nibabel.testing import data_path

import chordal

image = nibabel.load(Path(data_path) / "example4d.nii.gz").slicer[..., 0]
scan = chordal.volume(image)
scan

# %% [markdown]
# ## The surface at the scan's own resolution
#
# The brain is where the signal passes 200. Between samples the scan says nothing; there it is taken as the trilinear
# interpolant of the eight samples around, which is what "the surface" means from here on. Where the scan ends, the mesh is
# closed.
#
# A mesh by marching cubes is how far from that surface? It cuts corners inside the cells, and Chordal proves by how much.

# %%
plain = scan.mesh(iso=200)
print(f"{len(plain.faces):,} triangles, {plain.bound.sentence()}")
plain

# %% [markdown]
# ## Half a millimetre
#
# A plain mesh is a cell off, 2 mm and more. With `tol` it is made finer where that is needed and coarser where it can be, and
# the bound is proved again. This takes some twenty seconds for the whole scan, so here it is a part of it: the right side of
# the back of the head. Where three millimetres will do, few triangles are enough.

# %%
part = chordal.volume(image.slicer[:64, :48])
mesh = part.mesh(iso=200, tol="0.5mm")
coarse = part.mesh(iso=200, tol="3mm")
for made in (mesh, coarse):
    print(f"{len(made.faces):6,} triangles, {made.bound.sentence()}")
assert mesh.bound.evidence == "proved" and mesh.bound.at_most <= 0.5 < plain.bound.at_most and mesh.is_watertight
assert coarse.bound.at_most <= 3 and len(coarse.faces) < len(mesh.faces) / 4
mesh.show(deviation=coarse)

# %% [markdown]
# The bound is about the mesh and the samples. It does not cover the scanner: its noise, its distortion, and the choice of 200.
# What that choice does can be asked in the same way.

# %%
for iso in (150, 200, 250):
    print(f"iso {iso}: {scan.mesh(iso=iso).volume / 1000:.0f} cm³ in these 24 slices")

# %% [markdown]
# ## A scan that does not fit into memory
#
# The same scan read block by block: each block is meshed on its own, and together they are, bit for bit, the plain mesh.

# %%
again = chordal.block_volume(image.dataobj, affine=image.affine, unit="mm").mesh(iso=200, block=32)
assert np.array_equal(again.vertices, plain.vertices) and np.array_equal(again.faces, plain.faces)
print(f"{len(again.faces):,} triangles, the same numbers")

# %% [markdown]
# ## On to other libraries
#
# `vertices` and `faces` are numpy arrays, in the millimetres of the scanner. Other libraries get objects of their own:
# `mesh.to_trimesh()`, `mesh.to_pyvista()`, and `scan.to_nibabel()` for the samples.

# %%
print(mesh.vertices.shape, mesh.vertices.dtype, mesh.faces.shape, mesh.faces.dtype)
print("from", mesh.bounds[0].round(1), "to", mesh.bounds[1].round(1), "mm")
