# ---
# jupyter: {kernelspec: {display_name: Python 3, language: python, name: python3}}
# ---
# %% [markdown]
# # 从控制网格到细节层次，任何距离下误差都不超过一个像素
#
# 十个多边形代表一个光滑曲面。每一层的误差界都直接针对这个极限曲面来证明，而不是针对上一层。

# %%
import tempfile
from pathlib import Path

import chordal

corners = [(x, y, z) for z in (0, 1, 3) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
sides = [(4 * k + a, 4 * k + (a + 1) % 4, 4 * k + 4 + (a + 1) % 4, 4 * k + 4 + a) for k in (0, 1) for a in range(4)]
cage = chordal.Cage(corners, [(3, 2, 1, 0), *sides, (8, 9, 10, 11)], creases=[(0, 1, 2), (1, 2, 2), (2, 3, 2), (0, 3, 2)])
smooth = cage.shape(unit="m")
cage

# %%
levels = smooth.lod(pixels=1, view="1920x1080 fov=60", rel=0.002)
for k, level in enumerate(levels):
    print(f"level {k}: {len(level.mesh.faces):6d} triangles, off by {level.bound.at_most:.4f}, from {level.distance:.1f} m on")
assert all(level.bound.evidence == "proved" for level in levels)

# %% [markdown]
# 显示最精细的一层，颜色表示最粗的一层与它的距离。

# %%
levels[len(levels) - 1].mesh.show(deviation=levels[0].mesh, wire=True)

# %%
with tempfile.TemporaryDirectory() as folder:
    report = levels.export(Path(folder) / "cage.glb")
    print(report["run"]["bytes"], "bytes for all levels in one glTF")
