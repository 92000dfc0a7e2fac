# ---
# jupyter: {kernelspec: {display_name: Python 3, language: python, name: python3}}
# ---
# %% [markdown]
# # 多少条线段看起来才光滑？
#
# 线段数加倍，误差降到四分之一：弦高误差与线段数的平方成反比。

# %%
import numpy as np

import chordal
from chordal.shapes import bezier, spline

curve = bezier([(0, 0), (0, 1), (1, 1), (1, 0)])
counts = 2 ** np.arange(1, 8)
gaps = np.array([curve.flatten(segments=int(n), spacing="even").bound.at_most for n in counts])
for n, gap, times in zip(counts[1:], gaps[1:], gaps[:-1] / gaps[1:]):
    print(f"{n:4d} segments: {gap:.2e}, {times:.2f} times less")
assert abs(gaps[-2] / gaps[-1] - 4) < 0.05

# %% [markdown]
# 反过来问：图形宽 1000 像素，误差不超过半个像素，需要多少条线段？

# %%
smooth = curve.flatten(pixels=0.5, view="1000x1000 height=1")
print(len(smooth.points) - 1, "segments;", smooth.bound.sentence())

# %% [markdown]
# 任何形状都可以这样看：误差随三角形数（曲线则随线段数）怎样变化，对数坐标下直线的斜率是多少。

# %%
found = chordal.plot_error(curve, rel=[0.01, 0.003, 0.001, 0.0003])
print("slope", round(found.slope, 2))
assert abs(found.slope + 2) < 0.2
found

# %% [markdown]
# ## 一个高次多项式，还是许多段三次曲线
#
# 龙格函数 1 / (1 + 25 x²)，取十一个点：用一个多项式穿过所有点，两端会剧烈摆动；样条则不会。


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
