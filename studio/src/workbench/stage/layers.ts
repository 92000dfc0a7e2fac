// The layers of a mesh that the command wrote: its surface with its colours and pictures, its edges, or its normals.
import { PAINT } from "../../exhibits/paint";
import type { Layer, Vec3 } from "../../viewer";
import type { Part } from "../glb";

export type Look = "shaded" | "wire" | "normals" | "culled";
/** Longer lists of normals hide the surface. */
const MOST_NORMALS = 4000;

/** Normals are as long as they look from that distance. */
export function layersOf(parts: readonly Part[], look: Look, marked: readonly Vec3[], distance: number): Layer[] {
  const layers = parts.flatMap((part, k): Layer[] => {
    const { positions, indices, normals, colors, groups, paints, uv, decoded } = part;
    const pictures = uv && decoded?.some(Boolean) && look !== "wire" ? { uv, of: decoded } : undefined;
    const paint = (color: string | undefined, k: number) => color ?? (pictures?.of[k] ? "#ffffff" : PAINT.front);
    const mesh: Layer = {
      kind: "mesh",
      id: `mesh-${k}`,
      positions,
      indices,
      ...(normals && look !== "wire" ? { normals } : {}),
      ...(colors && !pictures ? { colors } : {}),
      // With a single paint the triangles can share vertices, so no groups are needed.
      ...(paints.length > 1 || pictures ? { groups: { of: groups, paints: paints.map(paint) } } : {}),
      ...(pictures ? { pictures } : {}),
      paint: paint(paints[0], 0),
      back: PAINT.back,
      shading: normals && look !== "wire" ? "smooth" : "flat",
      sides: look === "culled" ? "front" : "both",
    };
    if (look === "wire") {
      return [mesh, { kind: "wire", id: `wire-${k}`, positions, indices, paint: "#1d232b", width: 1 }];
    }
    if (look === "normals" && normals) {
      const step = Math.max(1, Math.ceil(positions.length / 3 / MOST_NORMALS));
      const thinned = (rows: Float32Array) => rows.filter((_, i) => Math.floor(i / 3) % step === 0);
      return [
        mesh,
        { kind: "normals", id: `normals-${k}`, at: thinned(positions), directions: thinned(normals), length: distance / 60, paint: "#8a5a00", width: 1.5 },
      ];
    }
    return [mesh];
  });
  if (marked.length) {
    layers.push({ kind: "points", id: "marked", positions: Float32Array.from(marked.flat()), paint: "#c62a12", size: 14, isMark: true });
  }
  return layers;
}
