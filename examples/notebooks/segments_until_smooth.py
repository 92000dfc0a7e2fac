# ---
# jupyter: {kernelspec: {display_name: Python 3, language: python, name: python3}}
# ---
# %% [markdown]
# # How many segments until it looks smooth?
#
# Twice the segments, a quarter of the error: the gap between a chord and its curve falls with the square of their number.

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
# The question the other way round: how many does half a pixel take, where the drawing is 1000 pixels wide?

# %%
smooth = curve.flatten(pixels=0.5, view="1000x1000 height=1")
print(len(smooth.points) - 1, "segments;", smooth.bound.sentence())

# %% [markdown]
# The same for any shape: error against triangles, and the slope of the line.

# %%
found = chordal.plot_error(curve, rel=[0.01, 0.003, 0.001, 0.0003])
print("slope", round(found.slope, 2))
assert abs(found.slope + 2) < 0.2
found

# %% [markdown]
# ## One polynomial or many pieces
#
# Runge's function, 1 / (1 + 25 x²), at eleven points: one polynomial through all of them swings, a spline does not.


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
