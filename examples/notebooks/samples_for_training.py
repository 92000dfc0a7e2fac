# ---
# jupyter:
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---
# %% [markdown]
# # Training samples for neural fields, with their errors
#
# A network that learns a shape is fed with points and their signed distances. This notebook makes such samples from a mesh, and
# says what usually stays unsaid: how wrong a distance may be, and where inside and outside are certain. It needs matplotlib for
# a picture.
#
# ## The surface
#
# The teapot is 32 curved patches; lengths are in the file's own units, in which it is about six wide. It is made triangles
# within 0.2 % of its diagonal, which is proved.

# %%
import pickle
from pathlib import Path

import numpy as np
from matplotlib import pyplot

import chordal

# From whatever folder of the repository Jupyter was started in.
here = Path.cwd()
teapot = next(folder / "examples/teapot.bpt" for folder in (here, *here.parents) if (folder / "examples/teapot.bpt").exists())
mesh = chordal.load(teapot).mesh(rel=0.002)
print(mesh.bound.sentence())
mesh

# %% [markdown]
# ## The signed distance
#
# `to_field` is the signed distance to the triangles at any point. The teapot is no solid: handle and spout are open tubes that
# end inside the body, and the lid only rests on it. So which side a point is on rests on a sentence, and the field says it. For
# a closed mesh that does not go through itself there is none.

# %%
field = mesh.to_field()
print(field.evidence)
print(*field.assumptions, *field.notes, sep="\n")

# %% [markdown]
# ## The samples
#
# Half of the points are anywhere in a box around it, and half are near the surface, where a network has most to learn: at
# places spread evenly over each triangle, moved by a normal distribution of 0.05.

# %%
rng = np.random.default_rng(1)
low, high = mesh.bounds
uniform = rng.uniform(low - 0.2, high + 0.2, (2000, 3))
sizes = np.linalg.norm(np.cross(*np.diff(mesh.vertices[mesh.faces], axis=1).swapaxes(0, 1)), axis=1)
corners = mesh.vertices[mesh.faces[rng.choice(len(mesh.faces), 2000, p=sizes / sizes.sum())]]
near = np.einsum("nk,nkd->nd", rng.dirichlet((1, 1, 1), 2000), corners) + rng.normal(0, 0.05, (2000, 3))
points = np.concatenate([uniform, near])
distances = field(points)

# %% [markdown]
# ## Their errors
#
# How wrong may a distance be? The distance to the triangles is exact but for rounding. The triangles are off the patches by no
# more than their bound, and where a surface moves by so much, no distance to it changes by more. So that one number is the
# error of every sample. A sample that is closer to the surface than that may have the wrong sign as well.

# %%
error = mesh.bound.at_most
unsure = np.abs(distances) <= error
print(f"{len(points):,} samples, {np.mean(distances < 0):.0%} inside, each within {error:.4f} of the distance to the patches")
print(f"{np.mean(unsure):.1%} are so close that their sign is not certain; give those no weight, or a finer mesh")
assert np.isfinite(distances).all() and error < 0.02 and 0 < np.mean(distances < 0) < 1

# %% [markdown]
# A cut through the middle: the distance at each pixel, blue inside, and the samples within a tenth of it.

# %%
across = np.linspace(low[0] - 0.2, high[0] + 0.2, 240), np.linspace(low[2] - 0.2, high[2] + 0.2, 160)
x, z = np.meshgrid(*across)
values = field(np.stack([x, 0 * x, z], axis=-1).reshape(-1, 3)).reshape(x.shape)
figure, axes = pyplot.subplots(figsize=(7, 4))
axes.contourf(x, z, values, levels=np.linspace(-1.5, 1.5, 31), cmap="RdBu_r", extend="both")
axes.contour(x, z, values, levels=[0], colors="k")
axes.plot(*points[np.abs(points[:, 1]) < 0.1][:, ::2].T, "k.", ms=2)
axes.set(aspect="equal", xlabel="x", ylabel="z")
pyplot.show()

# %% [markdown]
# ## Into a data loader
#
# The field goes to worker processes as it is, without its file, and gives the same numbers there. `numpy.savez` keeps samples.

# %%
again = pickle.loads(pickle.dumps(field))
assert np.array_equal(again(points[:50]), distances[:50])
print("the copy of a worker gives the same 50 distances, bit for bit")
