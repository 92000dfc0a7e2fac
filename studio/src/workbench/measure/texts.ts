// The texts of measuring and of the section, in both languages.
import type { Language } from "../texts";
import type { Tool } from "./useMeasures";

export interface MeasureTexts {
  measure: string;
  tools: Record<Tool | "none", string>;
  /** What to press next, by how many points there are already. */
  ask: Record<Tool, readonly string[]>;
  wrong: Record<"edge" | "wall" | "radius" | "nothing", string>;
  /** What a result is called. */
  results: Record<Tool | "cylinder", string>;
  diameter(value: string): string;
  /** On what it was measured: two points of a mesh that is off by at most so much. */
  basis(bound: string, evidence: string): string;
  basisUnknown: string;
  /** For angles and radii, which a bound on distances does not bound. */
  basisAngle: string;
  clear: string;
  keys: string;
  building: string;
  cutTurn: string;
  cutTurned(azimuth: string, elevation: string): string;
  align: string;
  flip: string;
}

export const MEASURE_TEXTS: Record<Language, MeasureTexts> = {
  en: {
    measure: "Measure",
    tools: { none: "Nothing", distance: "Distance", edge: "Edge", angle: "Angle", wall: "Wall thickness", radius: "Radius" },
    ask: {
      distance: ["Press the first point.", "Press the second point."],
      edge: ["Press an edge."],
      angle: ["Press the first face.", "Press the second face."],
      wall: ["Press a face: the wall behind it is measured."],
      radius: ["Press a round face, or the first of three points of a circle.", "Press the second point.", "Press the third point."],
    },
    wrong: {
      edge: "There is no edge here.",
      wall: "There is no face here, or nothing behind it.",
      radius: "These three points are on a line.",
      nothing: "There is nothing here.",
    },
    results: { distance: "Distance", edge: "Edge", angle: "Angle between the faces", wall: "Wall", radius: "Radius of the circle", cylinder: "Radius of the cylinder" },
    diameter: (value) => `diameter ${value}`,
    basis: (bound, evidence) => `± is twice the error of the mesh, ${bound} (${evidence}).`,
    basisUnknown: "Measured on the mesh, whose error is not known.",
    basisAngle: "Angles, radii and bent edges are those of the mesh; its bound does not limit them.",
    clear: "Clear",
    keys: "Without a pointer: turn and shift the picture so that the place is under the cross, and press Enter.",
    building: "Getting ready to measure…",
    cutTurn: "Turn the section",
    cutTurned: (azimuth, elevation) => `${azimuth} around, ${elevation} up`,
    align: "Across",
    flip: "Flip",
  },
  zh: {
    measure: "测量",
    tools: { none: "不测量", distance: "距离", edge: "边长", angle: "角度", wall: "壁厚", radius: "半径" },
    ask: {
      distance: ["点选第一个点。", "点选第二个点。"],
      edge: ["点选一条边。"],
      angle: ["点选第一个面。", "点选第二个面。"],
      wall: ["点选一个面，量它背后的壁厚。"],
      radius: ["点选一个圆柱面，或圆上三点中的第一点。", "点选第二个点。", "点选第三个点。"],
    },
    wrong: {
      edge: "这里没有边。",
      wall: "这里没有面，或面后没有材料。",
      radius: "这三点在一条直线上。",
      nothing: "这里什么也没有。",
    },
    results: { distance: "距离", edge: "边长", angle: "两面夹角", wall: "壁厚", radius: "圆的半径", cylinder: "圆柱半径" },
    diameter: (value) => `直径 ${value}`,
    basis: (bound, evidence) => `± 为网格误差的两倍；网格误差至多 ${bound}（${evidence}）。`,
    basisUnknown: "在网格上量得，网格的误差未知。",
    basisAngle: "角度、半径和弯曲的边按网格本身量得，误差上界不约束它们。",
    clear: "清除",
    keys: "不用指针时：旋转、平移图形，使待测处位于十字下，再按回车。",
    building: "正在准备测量…",
    cutTurn: "转动剖切面",
    cutTurned: (azimuth, elevation) => `水平 ${azimuth}，仰角 ${elevation}`,
    align: "垂直于",
    flip: "换一侧",
  },
};
