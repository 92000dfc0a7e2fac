# ---
# jupyter:
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---
# %% [markdown]
# # 从控制网格到细节层次，任何距离下误差都不超过一个像素
#
# 控制网格用少量多边形代表一个光滑曲面。从远处看，这个曲面只需很少的三角形；从近处看则需要很多。这里生成供查看器切换的各个层次，
# 无论用哪一层、何时切换，看到的误差都不超过一个像素；每一层的误差界都直接针对光滑曲面本身来证明。
#
# ## 控制网格
#
# 两个叠放的方盒：十个多边形，坐标以米计。`creases` 让底部的四条边在前两步细分中保持尖锐，之后与其他边一样变光滑（Catmull–Clark）。

# %%
import tempfile
from pathlib import Path

import chordal

corners = [(x, y, z) for z in (0, 1, 3) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
sides = [(4 * k + a, 4 * k + (a + 1) % 4, 4 * k + 4 + (a + 1) % 4, 4 * k + 4 + a) for k in (0, 1) for a in range(4)]
cage = chordal.Cage(corners, [(3, 2, 1, 0), *sides, (8, 9, 10, 11)], creases=[(0, 1, 2), (1, 2, 2), (2, 3, 2), (0, 3, 2)])
smooth = cage.shape(unit="m")
smooth.render(size=(640, 480))

# %% [markdown]
# ## 层次
#
# `view` 是屏幕：以像素计的大小，以及以度计的竖直视角。每一层从某个距离起可用，在那个距离上它的误差正好是一个像素；距离减半，允
# 许的误差也减半。`rel` 是最精细一层的误差，占对角线的比例。

# %%
levels = smooth.lod(pixels=1, view="1920x1080 fov=60", rel=0.002)
for k, level in enumerate(levels):
    off = f"off by at most {1000 * level.bound.at_most:2.0f} mm"
    print(f"level {k}: {len(level.mesh.faces):5,} triangles, {off}, from {level.distance:5.1f} m on")
assert all(level.bound.evidence == "proved" for level in levels)
print(f"at 50 m a viewer takes the level with {len(levels.at(50).mesh.faces):,} triangles")

# %% [markdown]
# 下面是最粗的一层，可以用手转动，带有边线，颜色表示它的顶点离最精细的一层有多远。

# %%
levels[-1].mesh.show(deviation=levels[0].mesh, wire=True)

# %% [markdown]
# ## 文件
#
# 一个 glTF 文件包含所有层次，以及查看器切换时所依据的屏幕占比。把文件名换成文件夹，得到的就是 3D Tiles。

# %%
with tempfile.TemporaryDirectory() as folder:
    report = levels.export(Path(folder) / "cage.glb")
    print(f"{report['run']['bytes']:,} bytes for {len(levels)} levels in one glTF")
