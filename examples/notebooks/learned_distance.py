# ---
# jupyter:
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---
# %% [markdown]
# # A learned distance to a mesh
#
# A small network learns the signed distance to a shape from samples of it: training in twenty lines of numpy. Chordal turns its
# zero into triangles and says how far they are from the network's surface, first measured, then proved under a promise that the
# network's own weights keep.
#
# ## Samples
#
# The truth is a ring and a ball that overlap, about two units wide. Half of the samples are near its surface, half anywhere in
# a box. Outside the values are exact distances, inside a lower bound where the two parts overlap, and `truth.distance` says so.

# %%
import numpy as np

import chordal
from chordal.shapes import move, sphere, torus

truth = torus(0.6, 0.25) | move(sphere(0.35), 0.6, 0, 0)
print("outside, inside:", truth.distance)

rng = np.random.default_rng(1)
box = np.array([(-1.2, -1.2, -0.7), (1.2, 1.2, 0.7)])
surface = truth.mesh(tol=0.02).vertices
near = surface[rng.integers(0, len(surface), 6000)] + rng.normal(0, 0.05, (6000, 3))
points = np.concatenate([near, rng.uniform(*box, (6000, 3))])
distances = truth(points)

# %% [markdown]
# ## The network
#
# Three layers, 3 → 32 → 32 → 1, with the activation `abs`. A distance has the slope 1 everywhere, so a network should not be
# able to be much steeper. A matrix lengthens no vector by more than its spectral norm, and `abs` none at all, so the product of
# the three norms is a Lipschitz constant of the network: values at two points differ by no more than it times the distance of
# the points. After each step the norms are cut to 1.5, 1 and 1, so the constant is 1.5. Because `abs` keeps slopes, where a
# sine or softplus would flatten them, that much is enough to learn the shape (C. Anil, J. Lucas and R. Grosse, *Sorting out
# Lipschitz function approximation*, 2019). Training is Adam (D. Kingma and J. Ba, 2015) on the squared error.

# %%
widths, norms = (3, 32, 32, 1), (1.5, 1.0, 1.0)
weights = [rng.normal(0, 1 / np.sqrt(a), (a, b)) for a, b in zip(widths, widths[1:])]
shifts = [np.zeros(b) for b in widths[1:]]


def forward(at: np.ndarray) -> list[np.ndarray]:
    """What comes out of each layer before its activation; of the last that is the distance."""
    sums = [at @ weights[0] + shifts[0]]
    for w, b in zip(weights[1:], shifts[1:]):
        sums.append(np.abs(sums[-1]) @ w + b)
    return sums


def network(at: np.ndarray) -> np.ndarray:
    return forward(at)[-1][:, 0]


steps = 3000
learned = [*weights, *shifts]
mean, square = [np.zeros_like(p) for p in learned], [np.zeros_like(p) for p in learned]
for step in range(1, steps + 1):
    batch = rng.integers(0, len(points), 512)
    sums = forward(points[batch])
    slope = 2 * (sums[-1] - distances[batch, None]) / len(batch)
    by_shifts, by_weights = [slope.sum(0)], []
    for k in (2, 1, 0):
        below = np.abs(sums[k - 1]) if k else points[batch]
        by_weights.insert(0, below.T @ slope)
        if k:
            slope = (slope @ weights[k].T) * np.sign(sums[k - 1])
            by_shifts.insert(0, slope.sum(0))
    rate = 0.005 * (1 + np.cos(np.pi * step / steps))
    for p, by, m, s in zip(learned, by_weights + by_shifts, mean, square):
        m += 0.1 * (by - m)
        s += 0.001 * (by * by - s)
        p -= rate * m / (1 - 0.9**step) / (np.sqrt(s / (1 - 0.999**step)) + 1e-8)
    for w, most in zip(weights, norms):
        w *= min(1, most / np.linalg.norm(w, 2))

lipschitz = float(np.prod([np.linalg.norm(w, 2) for w in weights])) * (1 + 1e-9)
print(f"off by {np.abs(network(points) - distances).mean():.4f} on average; Lipschitz constant {lipschitz:.3f}")
assert lipschitz < 1.51

# %% [markdown]
# With PyTorch the layers are `torch.nn.Linear(32, 32)`, whose weights are scaled after each step as here, with
# `torch.linalg.matrix_norm(w, 2)`. `torch.nn.utils.parametrizations.spectral_norm` does not keep the promise that the proof
# below needs: it estimates the norm by power iteration, from below, so that a layer may be steeper than it says. One line below
# differs: a `torch.nn.Module` is given as it is, `chordal.field(model, bounds=box)`.
#
# ## A mesh, measured
#
# Of a function nobody knows what it does between two points. So this mesh is measured: at points of the network's surface
# beside the triangles, and the farthest of them is the bound's lower end. There is no upper end.

# %%
bounds = tuple(map(tuple, box))
measured = chordal.field(network, bounds=bounds).mesh(tol=0.04)
print(len(measured.faces), "triangles,", measured.bound.sentence())
assert measured.bound.evidence == "measured" and measured.bound.at_most is None

# %% [markdown]
# ## A mesh, proved if a promise holds
#
# The Lipschitz constant is what a proof needs: where the value is 0.3, no surface is nearer than 0.3 / 1.5. Chordal does not
# check the promise, and its sentence says so. Here it is kept, up to the rounding of the network's own arithmetic. Without the
# cut it is of no use: a network of sines, trained as it comes, had a product of 19, and two minutes were not enough for a
# proof.

# %%
mesh = chordal.field(network, bounds=bounds, lipschitz=lipschitz).mesh(tol=0.04)
print(len(mesh.faces), "triangles,", mesh.bound.sentence())
print(f"{mesh.report['run']['evaluations']:,} values of the network")
assert mesh.bound.evidence == "proved-if" and mesh.bound.at_most <= 0.04 and mesh.is_watertight

# %% [markdown]
# ## How far from the truth?
#
# Both bounds are about the network's surface. How far that is from the shape that it has learned is another question, the one
# that training answers badly: the average above says nothing about the worst place. The distance of the two meshes is proved,
# and with the 0.01 of the truth's mesh it is proved for the truth itself. The colours show where.

# %%
exact = truth.mesh(tol=0.01)
apart = mesh.deviation(exact, relative=0.3).bound
print(apart.sentence())
print(f"so no more than {apart.at_most + exact.bound.at_most:.3f} from the truth")
assert apart.at_most < 0.3
mesh.show(deviation=exact)
