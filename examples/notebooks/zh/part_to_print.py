# ---
# jupyter:
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---
# %% [markdown]
# # 用代码写零件，导出打印文件
#
# 用几行 Python 写一个搁板支架：两块板、一条加强筋、四个螺丝孔。Chordal 把它变成三角形，与精确形状的距离处处不超过二十分之一毫米，
# 并证明这一点，然后写出切片软件能打开的 3MF 文件。
#
# ## 零件
#
# 形状是点的函数，在内部为负。`|` 把形状合在一起，`-` 从一个形状里切去另一个，`&` 保留两者共有的部分。这些词本身没有单位；这里的
# 长度都以毫米计。

# %%
import tempfile
from pathlib import Path

import chordal
from chordal.shapes import box, cylinder, move, plane, rotate_x, rounded_box, symmetric


def bracket(width: float = 40, height: float = 50, thick: float = 5) -> chordal.Field:
    """A bracket whose leg lies on the plane z = 0 and whose wall stands on y = 0, in millimetres."""
    half = height / 2
    leg = move(box(width, height, thick), 0, half, thick / 2)
    wall = move(box(width, thick, height), 0, thick / 2, half)
    rib = move(box(thick, height, height), 0, half, half) & plane((0, 1, 1), 0.6 * height)
    edges = move(rounded_box(width, height, height, 1), 0, half, half)
    screw = cylinder(2.2, 4 * thick)
    in_leg = move(screw, width / 4, 0.7 * height, 0)
    in_wall = move(rotate_x(screw, 90), width / 4, 0, 0.7 * height)
    return ((leg | wall | rib) & edges) - symmetric(in_leg | in_wall, 1, 0)


part = bracket()
inside, above = part([(0, 25, 2), (0, 40, 30)])
print(f"in the leg {inside:.1f}, above it {above:.1f}")
part.render(size=(640, 480), view="640x480 fov=30 eye=80,150,100 target=0,20,20")

# %% [markdown]
# ## 三角形及其误差界
#
# `tol` 是允许的误差：0.05 毫米，约为常用喷嘴孔径的八分之一。`bound` 是实际的误差，介于两个数之间，其中上限是已证明的：网格上没
# 有一点离精确形状更远，形状上也没有一点离网格更远。

# %%
mesh = part.mesh(tol=0.05)
print(mesh.bound.sentence())
print(f"{mesh.volume / 1000:.1f} cm³, watertight: {mesh.is_watertight}")
assert mesh.bound.evidence == "proved" and mesh.is_watertight
mesh.show(wire=True)

# %% [markdown]
# 少用一些三角形，误差会怎样？平面无论用多少三角形都是精确的；变细的是圆角和孔。

# %%
coarse = part.mesh(tol=0.2)
print(f"within 0.2 mm: {len(coarse.faces):,} triangles; within 0.05 mm: {len(mesh.faces):,}")

# %% [markdown]
# ## 文件
#
# 3MF 带有单位，毫米就在这一步写进去。报告说的是实际写出的文件：`valid` 是切片软件要求的条件，误差界是写入时的损失，`history` 里的
# `total` 则是文件与零件本身的距离。这些都写在文件里，`verify` 会重新证明它们。要真正打印，请换成一个不会被删除的文件夹。

# %%
with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "bracket.3mf"
    report = chordal.scene({"bracket": mesh}, unit="mm", up="z").export(path)
    printed = chordal.load(path)
    verified = chordal.verify(path, [mesh, part])

assert isinstance(printed, chordal.Mesh) and printed.is_watertight and printed.unit == "mm"
print("its size in millimetres:", printed.extents)
total = report["certificate"]["history"]["total"]
print(f"the file is within {total['at_most']:.4f} mm of the part, {total['evidence']}; {verified['verdict']}")
assert total["at_most"] < 0.05 + 1e-9 and verified["verdict"] == "re-proved"
report
