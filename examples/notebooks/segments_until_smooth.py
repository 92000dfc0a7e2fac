# ---
# jupyter:
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---
# %% [markdown]
# # How many segments until it looks smooth?
#
# A screen draws straight lines. This notebook asks how far they are from a curve, how many of them are enough, and why one
# polynomial of a high degree is no way to draw a curve. It needs matplotlib for its pictures.
#
# ## Twice the segments, a quarter of the error
#
# The gap between a chord and its curve falls with the square of the number of chords. Each number below is proved: no point of
# the curve is farther from the segments.

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
# ## How many are enough?
#
# The question the other way round: the curve is drawn on 1000 × 1000 pixels that show a square of height 1, and half a pixel
# may be lost. What comes is a number of segments that is enough, and what was lost, in units of the curve and in pixels.

# %%
smooth = curve.flatten(pixels=0.5, view="1000x1000 height=1")
print(len(smooth.points) - 1, "segments:", smooth.bound.sentence())

# %% [markdown]
# `plot_error` asks the same for any shape, at several budgets (shares of its diagonal): error against the number of pieces,
# both by decades, and the slope of the line through them. It is -2 for curves and -1 for surfaces, which need triangles in two
# directions.

# %%
found = chordal.plot_error(curve, rel=[0.01, 0.003, 0.001, 0.0003])
assert abs(found.slope + 2) < 0.2
found

# %% [markdown]
# ## One polynomial, or many pieces
#
# More is not always better. Runge's function, 1 / (1 + 25 x²), at eleven places: the polynomial of degree ten through all of
# them swings near the ends, and with more places it gets worse (C. Runge, *Über empirische Funktionen und die Interpolation
# zwischen äquidistanten Ordinaten*, 1901). A spline, of many cubic pieces, stays with it.


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
