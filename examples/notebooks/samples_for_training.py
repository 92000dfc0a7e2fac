# ---
# jupyter: {kernelspec: {display_name: Python 3, language: python, name: python3}}
# ---
# %% [markdown]
# # Training samples for neural fields, with their errors
#
# Signed distances to a mesh at any points; whether inside is certain; and how far the mesh itself is from the shape that it
# stands for. All of it goes through processes, for data loaders.

# %%
import pickle

import numpy as np

import chordal

shape = chordal.load("examples/teapot.bpt")
mesh = shape.mesh(rel=0.002)
print(mesh.bound.sentence())
mesh

# %% [markdown]
# The teapot's patches are open, so which side a point is on rests on a sentence, and the field says which.

# %%
field = mesh.to_field()
print(field.evidence, field.assumptions, field.notes)

# %%
rng = np.random.default_rng(1)
low, high = mesh.bounds
uniform = rng.uniform(low - 0.2, high + 0.2, (2000, 3))
corners = mesh.vertices[mesh.faces[rng.integers(0, len(mesh.faces), 2000)]]
shares = rng.dirichlet((1, 1, 1), 2000)
near = np.einsum("nk,nkd->nd", shares, corners) + rng.normal(0, 0.05, (2000, 3))
points = np.concatenate([uniform, near])
distances = field(points)

# %% [markdown]
# How wrong may a distance be? The mesh is off by no more than its bound, and a distance changes by no more than the surface moves.

# %%
error = mesh.bound.at_most
print(f"{len(points):,} samples, {np.mean(distances < 0):.0%} inside, each within {error:.4f} of the distance to the patches")
assert np.isfinite(distances).all() and error < 0.02 and 0 < np.mean(distances < 0) < 1

# %% [markdown]
# The field goes to workers as it is, without its file.

# %%
again = pickle.loads(pickle.dumps(field))
assert np.array_equal(again(points[:50]), distances[:50])
