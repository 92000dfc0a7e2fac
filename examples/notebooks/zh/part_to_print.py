# ---
# jupyter: {kernelspec: {display_name: Python 3, language: python, name: python3}}
# ---
# %% [markdown]
# # 用代码写零件，导出打印文件
#
# 一个搁板支架：两块板、一条加强筋、两个孔。尺寸由三个数决定，允许的误差再用一个数说明。

# %%
import tempfile
from pathlib import Path

import chordal
from chordal.shapes import box, cylinder, move, rotate_x, rounded_box, smooth_union


def bracket(width: float = 40, height: float = 50, thick: float = 5) -> chordal.Field:
    """A bracket that stands on its lower leg, in millimetres."""
    leg = move(rounded_box(width, height, thick, 1), 0, height / 2, thick / 2)
    wall = move(rounded_box(width, thick, height, 1), 0, thick / 2, height / 2)
    rib = move(rotate_x(box(thick, height, thick), 45), 0, height / 3, height / 3)
    hole = cylinder(2.2, 4 * thick)
    holes = move(hole, width / 4, height * 0.7, 0) | move(hole, -width / 4, height * 0.7, 0)
    return (smooth_union(leg, wall, radius=3) | rib) - holes


part = bracket()
part

# %% [markdown]
# 0.05 毫米，比打印机喷嘴的孔径还小。网格会说明自己偏差多少，而且这个界是已证明的。

# %%
mesh = part.mesh(tol=0.05)
print(mesh.bound.sentence())
print(f"{mesh.volume / 1000:.1f} cm³, watertight: {mesh.is_watertight}")
mesh

# %% [markdown]
# 切片软件适合用 3MF，它带有单位。报告说明文件里实际是什么，写入时的舍入也计算在内。

# %%
with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "bracket.3mf"
    report = chordal.Mesh(mesh.vertices, mesh.faces, unit="mm").export(path)
    again = chordal.load(path)
    assert isinstance(again, chordal.Mesh) and again.is_watertight
    print(path.name, report["run"]["bytes"], "bytes, off by", report["certificate"]["bound"]["at_most"], "more")

# %% [markdown]
# 误差减半，三角形要多多少？误差足够小以后，大约多一倍。

# %%
costs = {tol: len(part.mesh(tol=tol).faces) for tol in (0.2, 0.1, 0.05)}
print(costs)
assert costs[0.2] <= costs[0.1] <= costs[0.05]
