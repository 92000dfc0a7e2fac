// The measurements of a picture: a tool, the points that were pressed so far, and the results.
import { useEffect, useRef, useState } from "preact/hooks";
import type { Part } from "../glb";
import type { Projector, Vec3 } from "../../viewer";
import { plus } from "../../viewer/view";
import { type Spot, angleBetween, chainOf, circleThrough, cylinderAt, distance, faceAt, spotAt, thickness } from "./measures";
import { type Solid, normalOf } from "./solid";

export const TOOLS = ["distance", "edge", "angle", "wall", "radius"] as const;
export type Tool = (typeof TOOLS)[number];

export interface Result {
  of: Tool | "cylinder";
  /** A length in the shape's unit, or an angle in degrees. */
  value: number;
  /** Whether it is the length between two points, which the mesh's bound limits. */
  isBounded: boolean;
  lines: readonly (readonly Vec3[])[];
  at: Vec3;
}

/** Points of a drawn circle. */
const DRAWN = 72;

export interface Measures {
  tool: Tool | null;
  choose(tool: Tool | null): void;
  spots: readonly Spot[];
  hovered: Spot | null;
  results: readonly Result[];
  wrong: "edge" | "wall" | "radius" | "nothing" | null;
  press(at: Projector, x: number, y: number): void;
  hover(at: Projector, x?: number, y?: number): void;
  /** Clears the points, else the results, else the tool. Returns whether there was something. */
  clear(): boolean;
}

export function useMeasures(solid: { readonly current: Solid | null }, parts: readonly Part[], isShown: (at: Vec3) => boolean, tolerance: number): Measures {
  const [tool, setTool] = useState<Tool | null>(null);
  const [spots, setSpots] = useState<readonly Spot[]>([]);
  const [hovered, setHovered] = useState<Spot | null>(null);
  const [results, setResults] = useState<readonly Result[]>([]);
  const [wrong, setWrong] = useState<Measures["wrong"]>(null);
  const frame = useRef(0);
  const forget = () => {
    setSpots([]);
    setHovered(null);
    setWrong(null);
  };
  // A measurement is of the mesh on which it was made.
  useEffect(() => {
    forget();
    setResults([]);
  }, [parts]);

  const finish = (result: Result | undefined, why: Measures["wrong"]) => {
    setSpots([]);
    setWrong(result ? null : why);
    if (result) setResults((old) => [...old, result]);
  };
  /** Faces are pressed where they are; a corner or an edge belongs to several. */
  const find = (of: Solid, at: Projector, x: number, y: number) =>
    tool === "wall" || tool === "angle" ? faceAt(of, at, x, y, isShown) : spotAt(of, at, x, y, isShown);
  const press = (at: Projector, x: number, y: number) => {
    const of = solid.current;
    if (!tool || !of) return;
    const spot = find(of, at, x, y);
    if (!spot) return setWrong("nothing");
    setWrong(null);
    const all = [...spots, spot];
    const answer = measure(of, tool, all, tolerance);
    if (answer === "more") setSpots(all);
    else finish(answer, tool === "edge" || tool === "wall" || tool === "radius" ? tool : null);
  };
  const hover = (at: Projector, x?: number, y?: number) => {
    cancelAnimationFrame(frame.current);
    if (!tool || x === undefined || y === undefined) return setHovered(null);
    frame.current = requestAnimationFrame(() => setHovered((solid.current && find(solid.current, at, x, y)) ?? null));
  };
  const choose = (next: Tool | null) => {
    forget();
    setTool(next);
  };
  const clear = () => {
    if (spots.length || wrong) forget();
    else if (results.length) setResults([]);
    else if (tool) choose(null);
    else return false;
    return true;
  };
  return { tool, choose, spots, hovered, results, wrong, press, hover, clear };
}

/** The result of a tool, or that it needs one more point. */
function measure(solid: Solid, tool: Tool, spots: readonly Spot[], tolerance: number): Result | undefined | "more" {
  const [a, b, c] = spots as [Spot, Spot?, Spot?];
  switch (tool) {
    case "distance":
      if (!b) return "more";
      return { of: tool, value: distance(a.at, b.at), isBounded: true, lines: [[a.at, b.at]], at: middleOf(a.at, b.at) };
    case "edge": {
      if (a.edge === undefined) return undefined;
      const { points, length, isClosed } = chainOf(solid, a.edge);
      // Along a bent edge the errors of its points may add up.
      const isStraight = !isClosed && Math.abs(length - distance(points[0]!, points.at(-1)!)) <= 1e-6 * length;
      return { of: tool, value: length, isBounded: isStraight, lines: [points], at: isStraight ? middleOf(points[0]!, points.at(-1)!) : points[points.length >> 1]! };
    }
    case "angle": {
      if (!b) return "more";
      if (a.face === undefined || b.face === undefined) return undefined;
      const value = angleBetween(normalOf(solid, a.face), normalOf(solid, b.face));
      return { of: tool, value, isBounded: false, lines: [[a.at, b.at]], at: middleOf(a.at, b.at) };
    }
    case "wall": {
      const found = a.face === undefined ? undefined : thickness(solid, a.at, a.face);
      return found && { of: tool, value: found.size, isBounded: true, lines: [[a.at, found.to]], at: middleOf(a.at, found.to) };
    }
    case "radius": {
      const cylinder = spots.length === 1 && a.face !== undefined ? cylinderAt(solid, a.face, 2 * tolerance) : undefined;
      if (cylinder) return circle("cylinder", cylinder);
      if (!b || !c) return "more";
      const found = circleThrough(a.at, b.at, c.at);
      return found && circle("radius", found);
    }
  }
}

function circle(of: Result["of"], { centre, radius, axis }: { centre: Vec3; radius: number; axis: Vec3 }): Result {
  // Any direction across the axis, from the axis of space that is farthest from it.
  const least = axis.map(Math.abs).indexOf(Math.min(...axis.map(Math.abs)));
  const other = [0, 0, 0].map((_, k) => Number(k === least)) as unknown as Vec3;
  const u = unitAcross(axis, other);
  const v: Vec3 = [axis[1] * u[2] - axis[2] * u[1], axis[2] * u[0] - axis[0] * u[2], axis[0] * u[1] - axis[1] * u[0]];
  const at = (turn: number) => plus(plus(centre, u, radius * Math.cos(turn)), v, radius * Math.sin(turn));
  const round = Array.from({ length: DRAWN + 1 }, (_, i) => at((2 * Math.PI * i) / DRAWN));
  return { of, value: radius, isBounded: false, lines: [round, [centre, round[0]!]], at: middleOf(centre, round[0]!) };
}

function unitAcross(axis: Vec3, other: Vec3): Vec3 {
  const along = axis[0] * other[0] + axis[1] * other[1] + axis[2] * other[2];
  const across = plus(other, axis, -along);
  const length = Math.hypot(...across);
  return [across[0] / length, across[1] / length, across[2] / length];
}

const middleOf = (a: Vec3, b: Vec3): Vec3 => plus(a, plus(b, a, -1), 0.5);
