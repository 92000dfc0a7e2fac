# ---
# jupyter: {kernelspec: {display_name: Python 3, language: python, name: python3}}
# ---
# %% [markdown]
# # 从学到的距离场到网格
#
# 一个小网络从采样值学习某个形状的有向距离；Chordal 把它的零等值面变成网格，并说明偏差多少。这里只需要 numpy；PyTorch 或 JAX
# 的网络用法相同，每次传入一个 n × 3 的数组。

# %%
import numpy as np

import chordal
from chordal.shapes import move, sphere, torus

truth = torus(0.6, 0.25) | move(sphere(0.35), 0.6, 0, 0)
rng = np.random.default_rng(1)

# %% [markdown]
# 训练样本：有向距离，其中一半取在表面附近。形状外部的值是精确距离；内部在两个部件重叠的地方只是距离的下界，
# `truth.distance` 会说明这一点。

# %%
print(truth.distance)
surface = truth.mesh(tol=0.02).vertices
near = surface[rng.integers(0, len(surface), 3000)] + rng.normal(0, 0.05, (3000, 3))
points = np.concatenate([near, rng.uniform(-1.2, 1.2, (3000, 3))])
distances = truth(points)

# %% [markdown]
# 一个由随机余弦波组成的隐藏层，输出权重由最小二乘法求得（A. Rahimi、B. Recht，*Random features for large-scale kernel
# machines*，2007）。

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
# 网络没有任何承诺，所以它的网格误差是实测的。已知的只有一个利普希茨常数：每个余弦的变化率不超过它的波矢长度，因此总和的
# 变化率不超过各权重与波矢长度乘积之和。在这里它大得没有用处；如果训练时把斜率约束在 1 以内，就可以在这个前提下给出证明。

# %%
learned = chordal.field(network, bounds=((-1.2, -1.2, -0.7), (1.2, 1.2, 0.7)))
mesh = learned.mesh(tol=0.08)
print(mesh.bound.sentence())
print("a Lipschitz constant:", round(float(np.abs(weights) @ np.linalg.norm(waves, axis=0)), 1))
assert mesh.bound.evidence == "measured" and mesh.is_watertight
mesh

# %% [markdown]
# 学到的曲面离真实曲面有多远？这个问题交给 `deviation`，它的答案是已证明的。

# %%
apart = mesh.deviation(truth.mesh(tol=0.01), relative=0.3)
print(apart.bound.sentence())
assert apart.bound.at_most < 0.3
