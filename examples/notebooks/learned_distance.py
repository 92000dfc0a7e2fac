# ---
# jupyter: {kernelspec: {display_name: Python 3, language: python, name: python3}}
# ---
# %% [markdown]
# # A learned distance to a mesh
#
# A small network learns the signed distance to a shape from samples of it; Chordal makes its zero a mesh, and says how far
# that is off. Nothing but numpy is needed; a network of PyTorch or JAX is called in the same way, with an array n × 3.

# %%
import numpy as np

import chordal
from chordal.shapes import move, sphere, torus

truth = torus(0.6, 0.25) | move(sphere(0.35), 0.6, 0, 0)
rng = np.random.default_rng(1)

# %% [markdown]
# Training samples: signed distances, half of them near the surface. Outside they are exact, inside a lower bound where the two
# parts overlap, and `truth.distance` says so.

# %%
print(truth.distance)
surface = truth.mesh(tol=0.02).vertices
near = surface[rng.integers(0, len(surface), 3000)] + rng.normal(0, 0.05, (3000, 3))
points = np.concatenate([near, rng.uniform(-1.2, 1.2, (3000, 3))])
distances = truth(points)

# %% [markdown]
# One hidden layer of random waves, and the best weights of its sum in the sense of least squares (A. Rahimi and B. Recht,
# *Random features for large-scale kernel machines*, 2007).

# %%
waves, phases = rng.normal(0, 3.0, (3, 300)), rng.uniform(0, 2 * np.pi, 300)


def features(at: np.ndarray) -> np.ndarray:
    return np.cos(at @ waves + phases)


seen = features(points)
weights = np.linalg.solve(seen.T @ seen + 1e-3 * np.eye(300), seen.T @ distances)


def network(at: np.ndarray) -> np.ndarray:
    return features(at) @ weights


print(f"off by {np.abs(network(points) - distances).mean():.4f} on average where it was trained")

# %% [markdown]
# Nothing is promised of the network, so its mesh is measured. What is known of it is a Lipschitz constant: a cosine changes by no
# more than its wave is long, so the sum by no more than the weights times the lengths. It is far too large to be of use here; a
# network that is trained to a slope of 1 would be proved under that promise.

# %%
learned = chordal.field(network, bounds=((-1.2, -1.2, -0.7), (1.2, 1.2, 0.7)))
mesh = learned.mesh(tol=0.08)
print(mesh.bound.sentence())
print("a Lipschitz constant:", round(float(np.abs(weights) @ np.linalg.norm(waves, axis=0)), 1))
assert mesh.bound.evidence == "measured" and mesh.is_watertight
mesh

# %% [markdown]
# How far is the learned surface from the true one? That is a question to `deviation`, whose answer is proved.

# %%
apart = mesh.deviation(truth.mesh(tol=0.01), relative=0.3)
print(apart.bound.sentence())
assert apart.bound.at_most < 0.3
