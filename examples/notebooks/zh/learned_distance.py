# ---
# jupyter:
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---
# %% [markdown]
# # 从学到的距离场到网格
#
# 一个小网络从采样值学习某个形状的有向距离：训练部分只有二十行 numpy。Chordal 把它的零等值面变成三角形，并说明三角形离网络的曲面
# 有多远：先是实测，再是在一个前提下的证明，而这个前提由网络自身的权重来保证。
#
# ## 样本
#
# 真实形状是互相重叠的一个圆环和一个球，宽约两个单位。一半样本在它的表面附近，另一半在一个盒子里随机选取。形状外部的值是精确距离；
# 内部在两个部件重叠的地方只是距离的下界，`truth.distance` 会说明这一点。

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
# ## 网络
#
# 三层，3 → 32 → 32 → 1，激活函数是 `abs`。距离的斜率处处为 1，所以网络也不该陡得太多。矩阵把向量拉长的倍数不超过它的谱范数，
# `abs` 则完全不拉长，因此三个谱范数的乘积就是网络的一个利普希茨常数：两点处的值之差不超过它乘以两点的距离。每一步之后把三个谱范
# 数分别截到 1.5、1 和 1，这个常数就是 1.5。正弦或 softplus 会把斜率压低，`abs` 则保持斜率，所以这么多就足以学会这个形状（C.
# Anil、J. Lucas、R. Grosse，*Sorting out Lipschitz function approximation*，2019）。训练用 Adam（D. Kingma、J. Ba，2015），目
# 标是平方误差。

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
# 用 PyTorch 时，各层写成 `torch.nn.Linear(32, 32)`，每一步之后照这里的做法，用 `torch.linalg.matrix_norm(w, 2)` 算出范数并缩放权重。
# `torch.nn.utils.parametrizations.spectral_norm` 守不住下面证明所需的前提：它用幂迭代从下方估计范数，所以一层的实际斜率可能比它
# 声称的更大。下面只有一行不同：`torch.nn.Module` 可以直接传入，即 `chordal.field(model, bounds=box)`。
#
# ## 网格，实测
#
# 函数在两点之间取什么值，谁也不知道。所以这个网格的误差是实测的：在三角形旁边、网络曲面上的若干点处测量，其中最远的距离就是误差
# 界的下限。没有上限。

# %%
bounds = tuple(map(tuple, box))
measured = chordal.field(network, bounds=bounds).mesh(tol=0.04)
print(len(measured.faces), "triangles,", measured.bound.sentence())
assert measured.bound.evidence == "measured" and measured.bound.at_most is None

# %% [markdown]
# ## 网格，在前提成立时已证明
#
# 利普希茨常数正是证明所需要的：值为 0.3 的地方，0.3 / 1.5 以内不会有曲面。Chordal 不检查这个前提，并在结论里写明。在这里前提是
# 成立的，只差网络自身运算的舍入。如果不截谱范数，它就没有用处：照常训练的正弦网络乘积达到 19，两分钟还完不成证明。

# %%
mesh = chordal.field(network, bounds=bounds, lipschitz=lipschitz).mesh(tol=0.04)
print(len(mesh.faces), "triangles,", mesh.bound.sentence())
print(f"{mesh.report['run']['evaluations']:,} values of the network")
assert mesh.bound.evidence == "proved-if" and mesh.bound.at_most <= 0.04 and mesh.is_watertight

# %% [markdown]
# ## 离真实形状有多远？
#
# 上面两个误差界说的都是网络的曲面。这个曲面离所学的真实形状有多远，是另一个问题，训练本身很难回答：前面的平均误差并不说明最坏的
# 地方。两个网格之间的距离是已证明的；加上真实形状的网格自身的 0.01，就是对真实形状的证明。颜色显示差在哪里。

# %%
exact = truth.mesh(tol=0.01)
apart = mesh.deviation(exact, relative=0.3).bound
print(apart.sentence())
print(f"so no more than {apart.at_most + exact.bound.at_most:.3f} from the truth")
assert apart.at_most < 0.3
mesh.show(deviation=exact)
