# ---
# jupyter: {kernelspec: {display_name: Python 3, language: python, name: python3}}
# ---
# %% [markdown]
# # 为神经场准备训练样本，并给出误差
#
# 任意点到网格的有向距离；内外判断是否可靠；网格本身离它所代表的形状有多远。所有对象都可以在进程之间传递，供数据加载器使用。

# %%
import pickle

import numpy as np

import chordal

shape = chordal.load("examples/teapot.bpt")
mesh = shape.mesh(rel=0.002)
print(mesh.bound.sentence())
mesh

# %% [markdown]
# 茶壶的曲面片并不封闭，所以一个点在里面还是外面取决于一条约定，场会说明是哪一条。

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
# 距离最多会错多少？网格的偏差不超过它的误差界，而曲面移动多少，距离至多就变化多少。

# %%
error = mesh.bound.at_most
print(f"{len(points):,} samples, {np.mean(distances < 0):.0%} inside, each within {error:.4f} of the distance to the patches")
assert np.isfinite(distances).all() and error < 0.02 and 0 < np.mean(distances < 0) < 1

# %% [markdown]
# 场可以直接传给工作进程，不需要原文件。

# %%
again = pickle.loads(pickle.dumps(field))
assert np.array_equal(again(points[:50]), distances[:50])
