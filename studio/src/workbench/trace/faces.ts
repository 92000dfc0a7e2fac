// The triangles of the shadow mesh by the call that made them.
import type { Layer, Vec3 } from "../../viewer";
import { across, corners } from "../../viewer/geometry";
import { cross, dot, minus, plus, unit } from "../../viewer/view";
import type { Part } from "../glb";
import type { Bench } from "../document";
import { type CallSite, siteOfPaint } from "./shadow";

export interface Trace {
  bench: Bench;
  sites: readonly CallSite[];
  parts: readonly Part[];
}

/** The call whose triangles are nearest to a point of the mesh, among those that face the same way. */
export function siteAt({ sites, parts }: Trace, at: Vec3, normal: Vec3): CallSite | undefined {
  let [best, nearest] = [0, Infinity];
  for (const { positions, indices, groups, paints } of parts) {
    for (let face = 0; 3 * face < indices.length; face++) {
      const triangle = corners(positions, indices, face);
      // A coarse mesh turns less finely than the one that was pressed.
      if (dot(unit(across(triangle)), normal) < 0.3) continue;
      const away = distanceSq(at, triangle);
      if (away < nearest) [best, nearest] = [siteOfPaint(paints[groups[face] ?? 0]), away];
    }
  }
  return sites[best - 1];
}

/** The faces of some calls, drawn over the mesh. */
export function facesOf({ parts, sites }: Trace, of: readonly CallSite[], paint: string): Layer[] {
  const numbers = new Set(of.map((site) => sites.indexOf(site) + 1));
  return parts.flatMap(({ positions, indices, groups, paints }, k): Layer[] => {
    const isOf = paints.map((one) => numbers.has(siteOfPaint(one)));
    const chosen = indices.filter((_, i) => isOf[groups[Math.floor(i / 3)] ?? 0]);
    if (!chosen.length) return [];
    return [{ kind: "mesh", id: `site-${k}`, positions, indices: chosen, paint, shading: "none", sides: "front", opacity: 0.4, isOnTop: true }];
  });
}

/** The squared distance from a point to a triangle. */
function distanceSq(p: Vec3, [a, b, c]: readonly [Vec3, Vec3, Vec3]): number {
  const normal = cross(minus(b, a), minus(c, a));
  const size = dot(normal, normal);
  const edges = [[a, b], [b, c], [c, a]] as const;
  if (size > 0 && edges.every(([from, to]) => dot(cross(minus(to, from), minus(p, from)), normal) >= 0)) return dot(minus(p, a), normal) ** 2 / size;
  return Math.min(
    ...edges.map(([from, to]) => {
      const along = minus(to, from);
      const share = Math.min(Math.max(dot(minus(p, from), along) / (dot(along, along) || 1), 0), 1);
      const away = minus(p, plus(from, along, share));
      return dot(away, away);
    }),
  );
}
