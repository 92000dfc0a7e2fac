# ---
# jupyter:
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---
# %% [markdown]
# # 为神经场准备训练样本，并给出误差
#
# 学习形状的网络，输入的是点及其有向距离。这里从网格生成这样的样本，并说明通常没人说的事：一个距离最多会错多少，哪里能确定内外。
# 图形需要 matplotlib。
#
# ## 曲面
#
# 茶壶由 32 个曲面片组成；长度用文件自己的单位，茶壶宽约六个单位。这里把它变成三角形，误差不超过对角线的 0.2 %，这一点是已证明的。

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
# ## 有向距离
#
# `to_field` 给出任意点到这些三角形的有向距离。茶壶并不是实体：壶把和壶嘴是开口的管子，末端在壶身里面，壶盖只是放在上面。所以一
# 个点在里面还是外面取决于一条约定，场会说明是哪一条。封闭且不自交的网格不需要约定。

# %%
field = mesh.to_field()
print(field.evidence)
print(*field.assumptions, *field.notes, sep="\n")

# %% [markdown]
# ## 样本
#
# 一半的点在包围盒里随机选取，另一半在曲面附近，那里是网络最需要学习的地方：先在三角形上均匀取点，再按标准差为 0.05 的正态分布移
# 动。

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
# ## 样本的误差
#
# 一个距离最多会错多少？除舍入外，到三角形的距离是精确的。三角形离曲面片不超过它的误差界，而曲面移动多少，任何点到它的距离至多就
# 变化多少。因此这一个数就是每个样本的误差。比它更靠近曲面的样本，连正负号也可能是错的。

# %%
error = mesh.bound.at_most
unsure = np.abs(distances) <= error
print(f"{len(points):,} samples, {np.mean(distances < 0):.0%} inside, each within {error:.4f} of the distance to the patches")
print(f"{np.mean(unsure):.1%} are so close that their sign is not certain; give those no weight, or a finer mesh")
assert np.isfinite(distances).all() and error < 0.02 and 0 < np.mean(distances < 0) < 1

# %% [markdown]
# 过正中的一个截面：每个像素处的距离，蓝色为内部；以及离截面不到十分之一的样本。

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
# ## 放进数据加载器
#
# 场可以直接传给工作进程，不需要原文件，在那里给出相同的数。样本可以用 `numpy.savez` 保存。

# %%
again = pickle.loads(pickle.dumps(field))
assert np.array_equal(again(points[:50]), distances[:50])
print("the copy of a worker gives the same 50 distances, bit for bit")
