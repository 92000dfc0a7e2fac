# ---
# jupyter:
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---
# %% [markdown]
# # 多少条线段看起来才光滑？
#
# 屏幕画的是直线。这里要问：直线离曲线有多远，多少条就够了，以及为什么不该用一个高次多项式来画曲线。图形需要 matplotlib。
#
# ## 线段数加倍，误差降到四分之一
#
# 弦与曲线之间的误差与弦数的平方成反比。下面每个数都是已证明的：曲线上没有一点离这些线段更远。

# %%
import numpy as np
from matplotlib import pyplot

import chordal
from chordal.shapes import bezier, spline

curve = bezier([(0, 0), (0, 1), (1, 1), (1, 0)])
counts = 2 ** np.arange(1, 8)
gaps = np.array([curve.flatten(segments=int(n), spacing="even").bound.at_most for n in counts])
for n, gap, times in zip(counts[1:], gaps[1:], gaps[:-1] / gaps[1:]):
    print(f"{n:4d} segments: off by {gap:.2e}, {times:.2f} times less")
assert abs(gaps[-2] / gaps[-1] - 4) < 0.05

# %% [markdown]
# ## 多少条才够？
#
# 反过来问：曲线画在 1000 × 1000 像素上，画面高度为 1，误差不超过半个像素。得到的是够用的线段数，以及实际的误差，分别以曲线
# 的单位和像素计。

# %%
smooth = curve.flatten(pixels=0.5, view="1000x1000 height=1")
print(len(smooth.points) - 1, "segments:", smooth.bound.sentence())

# %% [markdown]
# `plot_error` 对任何形状都能这样问，一次用几个允许误差（占形状对角线的比例）：误差随段数怎样变化，两轴都用对数，直线的斜率是多
# 少。曲线的斜率是 -2；曲面要在两个方向上细分，斜率是 -1。

# %%
found = chordal.plot_error(curve, rel=[0.01, 0.003, 0.001, 0.0003])
assert abs(found.slope + 2) < 0.2
found

# %% [markdown]
# ## 一个高次多项式，还是许多段三次曲线
#
# 并非越多越好。龙格函数 1 / (1 + 25 x²)，取十一个点：穿过所有点的十次多项式在两端剧烈摆动，点取得越多摆动越大（C. Runge，
# *Über empirische Funktionen und die Interpolation zwischen äquidistanten Ordinaten*，1901）。由许多段三次曲线组成的样条则始终
# 贴近。


# %%
def runge(x: np.ndarray) -> np.ndarray:
    return 1 / (1 + 25 * x**2)


nodes = np.linspace(-1, 1, 11)
between = np.linspace(-1, 1, 401)
polynomial = np.polynomial.Polynomial.fit(nodes, runge(nodes), len(nodes) - 1)
pieces = spline(np.column_stack([nodes, runge(nodes)])).flatten(tol=1e-4)
drawn = np.interp(between, pieces.points[:, 0], pieces.points[:, 1])
swings = np.abs(polynomial(between) - runge(between)).max()
stays = np.abs(drawn - runge(between)).max()
print(f"polynomial off by {swings:.2f}, spline by {stays:.3f}")
assert swings > 1.5 and stays < 0.05

figure, axes = pyplot.subplots(figsize=(6.4, 4))
axes.plot(between, runge(between), "k", lw=3, alpha=0.3, label="Runge's function")
axes.plot(between, polynomial(between), "C3", label="one polynomial")
axes.plot(*pieces.points.T, "C0--", label="a spline")
axes.plot(nodes, runge(nodes), "ko", ms=4)
axes.legend(loc="upper center")
pyplot.show()
