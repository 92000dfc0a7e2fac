# ---
# jupyter:
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---
# %% [markdown]
# # 从扫描体数据到网格，误差半毫米
#
# 扫描仪给出的是格点上的数，这里是一份头部的磁共振扫描；我们要的是曲面，以及它有多准。这里需要 nibabel，它读取这类文件，它的软件
# 包也自带这份扫描作为示例（`example4d.nii.gz`：穿过头部中段的 24 层，两个时刻，步长 2 × 2 × 2.2 毫米）。
#
# ## 扫描
#
# 这里取两个时刻中的第一个。只含一份体数据的文件只需一行：`scan = chordal.load("scan.nii.gz")`，装有 DICOM 切片的文件夹也一样。
# 单位、步长以及在扫描仪里倾斜的位置都会一并读入。

# %%
from pathlib import Path

import nibabel
import numpy as np
from nibabel.testing import data_path

import chordal

image = nibabel.load(Path(data_path) / "example4d.nii.gz").slicer[..., 0]
scan = chordal.volume(image)
scan

# %% [markdown]
# ## 按扫描本身的分辨率取曲面
#
# 信号越过 200 的地方就是脑。采样点之间扫描没有给出任何信息；那里以周围八个采样的三线性插值为准，下文所说的“曲面”就是指它。扫描
# 到边为止，网格在那里封口。
#
# 用移动立方体（marching cubes）得到的网格离这个曲面有多远？它在单元格内部抄了近路，Chordal 证明抄了多少。

# %%
plain = scan.mesh(iso=200)
print(f"{len(plain.faces):,} triangles, {plain.bound.sentence()}")
plain

# %% [markdown]
# ## 半毫米
#
# 普通的网格会差一个单元格，也就是 2 毫米以上。给出 `tol` 以后，网格在需要的地方变细，在可以的地方变粗，误差界重新证明。整份扫描
# 大约需要二十秒，所以这里只取一部分：后脑的右侧。如果三毫米就够用，只需很少的三角形。

# %%
part = chordal.volume(image.slicer[:64, :48])
mesh = part.mesh(iso=200, tol="0.5mm")
coarse = part.mesh(iso=200, tol="3mm")
for made in (mesh, coarse):
    print(f"{len(made.faces):6,} triangles, {made.bound.sentence()}")
assert mesh.bound.evidence == "proved" and mesh.bound.at_most <= 0.5 < plain.bound.at_most and mesh.is_watertight
assert coarse.bound.at_most <= 3 and len(coarse.faces) < len(mesh.faces) / 4
mesh.show(deviation=coarse)

# %% [markdown]
# 误差界说的是网格与采样之间的关系。它不包括扫描仪本身：噪声、畸变，以及为什么选 200。这个选择有多大影响，可以用同样的办法来问。

# %%
for iso in (150, 200, 250):
    print(f"iso {iso}: {scan.mesh(iso=iso).volume / 1000:.0f} cm³ in these 24 slices")

# %% [markdown]
# ## 内存装不下的扫描
#
# 逐块读取同一份扫描：每一块单独生成网格，合在一起与上面的普通网格逐位相同。

# %%
again = chordal.block_volume(image.dataobj, affine=image.affine, unit="mm").mesh(iso=200, block=32)
assert np.array_equal(again.vertices, plain.vertices) and np.array_equal(again.faces, plain.faces)
print(f"{len(again.faces):,} triangles, the same numbers")

# %% [markdown]
# ## 交给其他库
#
# `vertices` 和 `faces` 是 numpy 数组，以扫描仪的毫米坐标计。其他库可以得到它们自己的对象：`mesh.to_trimesh()`、
# `mesh.to_pyvista()`，采样数据则用 `scan.to_nibabel()`。

# %%
print(mesh.vertices.shape, mesh.vertices.dtype, mesh.faces.shape, mesh.faces.dtype)
print("from", mesh.bounds[0].round(1), "to", mesh.bounds[1].round(1), "mm")
