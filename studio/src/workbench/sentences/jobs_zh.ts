// Why a job gave no result, in Chinese: meshing, repairing, combining, baking, levels of detail, exports. Settings that a sentence
// advises are spelled as options of the command, which stay as they are.
import type { Table } from "./match";

const REQUESTS: Table = {
  "a length is a number greater than 0, as in 0.1, 0.1mm or 0.05%": "长度须是大于 0 的数，如 0.1、0.1mm 或 0.05%。",
  "a length must be finite and greater than 0": "长度须有限且大于 0。",
  "units are um, mm, cm, m, km, in and ft": "可用的单位有 um、mm、cm、m、km、in 和 ft。",
  "the input's unit is not known: give {option}, or a length without a unit": "不知道输入的单位：请给出 {option}，或写不带单位的长度。",
  "it is not a finite length greater than 0 for this shape": "对这个形状来说，它不是大于 0 的有限长度。",
  "a pixel budget is a finite number greater than 0, not '{text}'": "像素预算须是大于 0 的有限的数，不能是“{text}”。",
  "a budget needs a length, pixels at a view, or a number of triangles": "预算须是长度、某视角下的像素，或三角形数。",
  "the shape has no size, so {length} of it is no length: give one in units": "形状没有大小，{length} 算不出长度：请直接给出长度。",
  "invalid value '{value}' for '{option}': {wWhy}": "{option}的值“{value}”不能用：{wWhy}",
  "invalid value '{value}' for '{option}'": "{option}的值“{value}”不能用。",
  "unexpected argument '{option}' found": "没有 {option} 这个选项。",
  "a value is required for '{option}' but none was supplied": "{option} 后面缺少值。",
  "the argument '{option}' cannot be used with '{other}'": "{option} 不能与 {other} 同用。",
  "the argument '{option}' cannot be used with: {others}": "{option} 不能与 {others} 同用。",
  "the following required arguments were not provided: {others}": "缺少必需的选项 {others}。",
  "the argument '{option}' cannot be used multiple times": "{option} 只能给一次。",
  "expected a share like 0.1": "须是 0.1 这样的比例。",
  "a whole number greater than 0": "须是大于 0 的整数。",
  "a whole number greater than 0, not '{text}'": "须是大于 0 的整数，不能是“{text}”。",
  "a whole number from 1 to {nMost}": "须是 1 到 {nMost} 的整数。",
  "a whole number from 0 on": "须是不小于 0 的整数。",
  "a setting reads like r=0.5, not '{text}'": "写法如 r=0.5，不能是“{text}”。",
  "a box reads like \"-1,-1,-1 1,1,1\", its lowest corner first": "盒子的写法如 \"-1,-1,-1 1,1,1\"，最低的角在前。",
  "the axis that is up is y or z": "朝上的轴是 y 或 z。",
  "'{text}': {wWhy}": "“{text}”：{wWhy}",
  "{option} is for volumes, and the input holds {kind}": "{option} 用于体数据，而输入不是。",
  "{option} is for masks": "{option} 用于掩膜。",
  "{option} is for polygon cages ({names}), and the input holds {kind}": "{option} 用于多边形的控制网格（{names}），而输入不是。",
  "only the polygons of an .obj or of USD can be a cage: {option} does not apply to {format}": "只有 .obj 或 USD 的多边形可以作控制网格：{option} 不适用于 {format}。",
  "only fonts set letters: {option} does not apply to {format}": "只有字体才能排文字：{option} 不适用于 {format}。",
  "only scripts have parameters: there is no '{name}' to set in {format}": "只有脚本才有参数：{format} 中没有“{name}”可设。",
  "only drawings and letters are raised to a height, and this is {kind}": "只有矢量图和文字可以拉伸，而输入不是。",
  "a whole number from 0 on, not '{text}'": "须是不小于 0 的整数，不能是“{text}”。",
  "a whole number from 1 to {nMost}, not '{text}'": "须是 1 到 {nMost} 的整数，不能是“{text}”。",
  "{name}: {wWhy}": "{name}：{wWhy}",
};

const UNMET: Table = {
  "the budget was not met; the best reached is {kBound}": "预算未能满足；达到的最好结果是{kBound}。",
  "the budget was not met; the best reached is {kBound} with {n} triangles": "预算未能满足；达到的最好结果是{kBound}，{n} 个三角形。",
  "the budget was not met; the best reached is {kBound} with {n} triangles; {wRest}": "预算未能满足；达到的最好结果是{kBound}，{n} 个三角形。{wRest}",
  "the worst known place is about ({place})": "已知误差最大的地方约在 ({place})。",
  "{n} triangles are left and {nMost} are allowed: {wReason}": "还剩 {n} 个三角形，只允许 {nMost} 个：{wReason}",
  "no more can go within the length": "在这个长度之内不能再减。",
  "a count alone removes no separate piece and no handle, so that each keeps some triangles": "只限定数目时，不会去掉独立的块和环柄，每一块都留着一些三角形。",
  "a larger length lets more go": "放宽长度可以再减。",
  "a length in addition to the count removes pieces that it covers": "再给一个长度，就能去掉小于它的块。",
  "{n} piece: {rest}; {wNext}": "共 {n} 块：{rest}。{wNext}",
  "{n} pieces: {rest}; {wNext}": "共 {n} 块：{rest}。{wNext}",
  "{option} writes it": "用 {option} 可写出这个结果。",
  "{n} is less than what rounding to the single precision of {f} may cost here, {nCost}": "{n} 小于 {f} 的单精度在这里可能的舍入误差 {nCost}。",
  "{list} keep every digit": "能保留全部位数的格式有 {list}。",
  "the budget needs more than {n} triangles, which is the limit": "这样的预算需要的三角形超过 {n} 个的限制。",
  "the budget needs about {n} triangles; the limit is {nMost}": "这样的预算约需 {n} 个三角形，限制是 {nMost} 个。",
  "the budget needs more than {n} triangles; the limit is {nMost}": "这样的预算需要的三角形超过 {n} 个，限制是 {nMost} 个。",
  "the budget needs more than {n} triangles, the limit": "这样的预算需要的三角形超过 {n} 个的限制。",
  "the budget needs more than {n} MiB of memory, which is more than this job may have: allow a larger error, or more memory":
    "这样的预算需要 {n} MiB 以上的内存，超出限制：请放宽误差，或多给内存。",
  "the budget needs about {n} bytes of memory; the limit is {nMost}": "这样的预算约需 {n} 字节内存，限制是 {nMost}。",
  "the budget is so small that rounding hides whether it is met": "预算太小，舍入误差使人看不出是否满足。",
  "the budget needs about {n} segments; the limit is {nMost}": "这样的预算约需 {n} 条线段，限制是 {nMost} 条。",
  "{n} triangles are too few: the coarsest mesh that was found has {nFewest}": "{n} 个三角形太少：找到的最粗的网格有 {nFewest} 个。",
  "{n} triangles are too few for the shape": "{n} 个三角形不足以表示这个形状。",
  "no mesh of this surface has so few triangles": "这个曲面的网格不可能只有这么少的三角形。",
  "{n} is too little beside coordinates of {nLargest}, which have 16 digits: move the shape to the origin, or allow a larger length":
    "坐标达到 {nLargest}，只有 16 位有效数字，{n} 太小：请把形状移到原点附近，或放宽长度。",
  "the shape has details that are too small for the digits of its coordinates: move it to the origin if it is far from there; twist and repeat it less often":
    "形状的细节小到坐标的位数无法表示：若离原点太远，请移近；扭转和重复也请少一些。",
  "the budget in pixels leaves no length": "像素预算换算不出长度。",
  "an angle is no budget for fields in this version": "这个版本的场不能用角度作预算。",
  "the shape comes so close to the eye that there is no bound in pixels": "形状离视点太近，给不出以像素计的上界。",
  "the eye is too close to the shape near ({place}) for any bound in pixels; a camera can be given near=LENGTH":
    "视点在 ({place}) 处离形状太近，给不出以像素计的上界；可以给相机设 near=LENGTH。",
  "rounding near ({place}) alone can lose {n}, so no mesh in double precision can be proved to meet the budget":
    "({place}) 处单是舍入就可能损失 {n}，双精度的网格无法证明满足预算。",
};

const SURFACES: Table = {
  "there is no surface to mesh: the box of the shape is empty": "没有曲面可以网格化：形状的包围盒是空的。",
  "the shape has no finite bounds: cut it off with a box": "形状没有尽头：请用一个长方体与它求交。",
  "there is no surface to mesh: no sample is inside. The field is known only at its samples, which are a 42nd of the longest side of its bounds apart, or less along short sides: tighter bounds or a Lipschitz constant may reveal a surface":
    "没有曲面可以网格化：没有样本在内部。场只在样本处已知，样本间距是最长边的 1/42，短边方向更密；收紧边界或给出利普希茨常数，也许能找到曲面。",
  "there is no surface to mesh: nothing is inside, the field is nowhere negative within the box of the shape": "没有曲面可以网格化：内部什么也没有，场在包围盒中处处不为负。",
  "no surface was found with as many cells as this job may have: more memory or tighter bounds may reveal one": "以允许的单元数没有找到曲面：多给内存或收紧边界，也许能找到。",
  "the box of the shape has no size": "形状的包围盒没有大小。",
  "the box of the shape has no finite size": "形状的包围盒没有尽头。",
  "a draft found nothing inside: the shape is empty, or thinner than the cells of a draft": "草稿在内部什么也没找到：形状是空的，或比草稿的单元还薄。",
  "there is no shape": "没有形状。",
  "the shape has no end in some direction: cut it off at a box ({option}, in Python within())":
    "形状在某个方向没有尽头：请在脚本里与 box(x, y, z) 求交，或用盒子截断（{option}）。",
  "the shape is flat, a figure of the plane without a height: extrude(shape, height) makes a solid of it, or {option}, in Python within() cuts it off":
    "形状是平的，是没有高度的平面图形：extrude(shape, height) 可拉伸成实体，{option} 可截断它。",
  "the shape reaches to {n}, and squares of coordinates beyond {nMost} are no numbers any more: scale it down": "形状伸到 {n}，坐标的平方超出 {nMost} 就不再是数：请缩小它。",
  "there is no surface: nothing of the shape is within its box": "没有曲面：形状没有任何部分在盒子里。",
  "there is no surface: no sample is inside": "没有曲面：没有样本在内部。",
  "there is no surface: no sample of the lattice is inside": "没有曲面：没有格点样本在内部。",
  "there is no surface: the triangles of the mesh are not known": "没有曲面：网格的三角形未知。",
  "a function without known ranges cannot be meshed together with triangles": "取值范围未知的函数不能与三角形一起网格化。",
  "cells that small need {n} bytes; the limit is {nMost}": "这么小的单元要占 {n} 字节，限制是 {nMost} 字节。",
  "the tolerance is so small that the shape is {n} cells wide": "公差太小，形状要宽 {n} 个单元。",
  "the floating-point environment flushes subnormal numbers, so that nothing can be proved": "浮点环境把极小的数变成零，什么也证明不了。",
  "samples lie between {n} and {nHigh}, and the level of the surface is not known: {option} LEVEL sets it; {nBest} separates them best":
    "样本在 {n} 与 {nHigh} 之间，还不知道等值面取哪个值：用 {option} 设定，{nBest} 分得最开。",
  "level {n} is not among the samples, which lie between {nLow} and {nHigh}: there is no surface": "样本在 {nLow} 与 {nHigh} 之间，取不到 {n}：没有曲面。",
  "all samples are {n}, so that there is no surface at any level": "样本全是 {n}，取什么值都没有曲面。",
  "no sample is a finite number, so that there is no surface": "没有一个样本是有限的数，因此没有曲面。",
  "the drawing fills nothing: its lines can be written as polylines, to {list}": "图中没有填充的区域：线条可以写成折线，格式为 {list}。",
  "no triangles are left: all filled regions of the drawing are thinner than the bound": "没有剩下三角形：图中填充的区域都比误差上界还窄。",
  "a solid over outlines has a height above 0 and below {nMost}, not {n}": "由轮廓拉伸的实体，高度须大于 0 且小于 {nMost}，不能是 {n}。",
  "a bevel is wider than 0 and narrower than half of the height {n}, not {nGiven}": "倒角须大于 0 且小于高度 {n} 的一半，不能是 {nGiven}。",
  "a bevel needs a solid, and the drawing is not raised to one": "倒角需要实体，而图形没有拉伸成实体。",
};

/** Of files that cannot be read the most frequent; of others the code is translated. */
const READING: Table = {
  "the file is empty": "文件是空的。",
  "the file is empty: {n} bytes, none of them more than space": "文件是空的：{n} 字节，没有一个不是空白。",
  "the content is of no known format; {option} names the format: formats that can be read are {list}": "内容不是已知的格式。能读取的格式有 {list}；可用 {option} 指定。",
  "the name does not tell the format; add {option} with one of {list}": "从名称看不出格式：请加上 {option}，可取 {list}。",
  "'{text}' is not a number": "“{text}”不是数。",
  "index '{text}' is out of range: the file has {n} vertices": "索引“{text}”超出范围：文件有 {n} 个顶点。",
  "{n} bytes are no STL: binary needs 84 or more, and text starts with 'solid'": "{n} 字节不是 STL：二进制至少 84 字节，文本以 solid 开头。",
  "byte {n}: {wWhy}": "第 {n} 字节：{wWhy}",
  "line {n}, column {nColumn}: {wWhy}": "第 {n} 行第 {nColumn} 列：{wWhy}",
  "\"{name}\" cannot be read: {wWhy}": "“{name}”无法读取：{wWhy}",
  "this is a PNG picture, which is not read: a picture is no shape": "这是 PNG 图片，图片不是形状。",
  "this is STEP, which is not read: {advice}": "这是 STEP 文件，不能直接读取：请从 CAD 软件导出 3MF、STL 或 glTF 的三角形，误差按需要设定。",
  "the list of tables of a font is cut off or wrong": "字体的表目录不完整或有误。",
  "the file ends before {rest}": "文件不完整，数据没有写完。",
  "only triangles can be {done}, not {kind}: mesh them first": "只有三角形可以这样处理：请先网格化。",
  "{f} does not hold triangles; {list} do": "{f} 不能存放三角形，能存放的有 {list}。",
  "the field has no finite box; give a region to look in, as in -1,-1,-1 to 1,1,1": "场没有尽头：请给出一个区域，如从 -1,-1,-1 到 1,1,1。",
};

const LEAVES: Table = {
  "a leaf contradicts itself: a value lies outside of the range that it gave for a box around the point, two calls gave different values for one point, or it is negative outside of the bounds that it was given":
    "场的一个部分自相矛盾：某点的值超出它为周围盒子给出的范围，或同一点两次求值不同，或在所给边界之外为负。",
  "about {n} triangles: {wWhy}": "约需 {n} 个三角形：{wWhy}",
};

const STEPS: Table = {
  "the meshes could not be cut along each other: {why}": "两个网格无法互相切开：{why}。",
  "combining {n} triangles needs about {nBytes} bytes; the limit is {nMost}": "组合 {n} 个三角形约需 {nBytes} 字节，限制是 {nMost} 字节。",
  "operand {n} bounds no solid: some edge has unequal numbers of faces in its two directions": "第 {n} 个网格围不成实体：有的边两个方向的面数不等。",
  "operand {n} bounds no solid: {nEdges} edges have one triangle only": "第 {n} 个网格围不成实体：有 {nEdges} 条边只有一个三角形。",
  "the result has {n} triangles; the limit is {nMost}": "结果有 {n} 个三角形，限制是 {nMost} 个。",
  "nothing would be left: no point is inside the result": "什么也不会剩下：结果中没有内部的点。",
  "{p}: it bounds no solid, since {wReason}: mend it ({option}), or give a length, within which its surface is rebuilt by winding numbers":
    "{p} 围不成实体：{wReason}请先修复（{option}），或给出长度，在此之内按环绕数重建曲面。",
  "neighbours are wound against each other": "相邻三角形的环绕方向相反；",
  "{n} edges have one triangle only": "有 {n} 条边只有一个三角形；",
  "{p}: {kind} bound no solid": "{p} 围不成实体。",
  "no repair is requested": "没有指定修复。",
  "nothing would be left: there are no triangles, only points": "什么也不会剩下：没有三角形，只有点。",
  "mending needs about {n} bytes; the limit is {nMost}": "修复约需 {n} 字节，限制是 {nMost} 字节。",
  "there is no triangle to simplify": "没有可以简化的三角形。",
  "there is no triangle to show": "没有可以显示的三角形。",
  "levels of detail are for surfaces, and these are curves": "细节层次用于曲面，而这些是曲线。",
  "there are no triangles to build levels from": "没有三角形，无法生成细节层次。",
  "the budget has no length": "预算中没有长度。",
  "the shape has no size, or the eye is so close that no length is small enough": "形状没有大小，或视点太近，多小的长度都不够。",
  "the shape has no size that cells could divide": "形状没有大小，无法划分单元。",
  "{n} samples need {nBytes} bytes; the limit is {nMost}": "{n} 个样本要占 {nBytes} 字节，限制是 {nMost} 字节。",
  "there are no triangles to measure distances to": "没有三角形，无从测量距离。",
  "there is nothing to measure distances to": "没有可以测量距离的对象。",
  "{kind} bound no solid to measure distances to": "它围不成实体，无从测量有向距离。",
  "a number of cells is from 1 to {nMost}, not '{text}'": "单元数须在 1 到 {nMost} 之间，不能是“{text}”。",
  "there is no lattice with {n} cells along the shape's longest side": "最长边方向 {n} 个单元的格点不存在。",
  "there are no triangles to check: mesh the shape first": "没有三角形可以检查：请先网格化。",
  "a part of the field is no expression, which a shader needs: a mesh, samples, a function of a program, or an outline that crosses itself":
    "场有一部分不是表达式，不能写成着色器：网格、样本、程序的函数，或自相交的轮廓。",
  "out of memory or stack overflow: set a lower --max-memory, so that the job ends with the best result so far": "内存或栈已耗尽。",
  "the transforms of the scene take its coordinates out of range": "场景的变换使坐标超出范围。",
  "no such file or directory": "没有这个文件。",
};

export const JOB_SENTENCES: Table = { ...REQUESTS, ...UNMET, ...SURFACES, ...READING, ...LEAVES, ...STEPS };
