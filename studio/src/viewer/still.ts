// The same layers as flat SVG shapes, sorted from far to near: for the page before any script runs, for print, and for
// browsers without WebGL.
import { css, hex, lit, vertexColors, LIGHT, type Rgb } from "./color";
import { across, corners, edgesOf, segments, silhouette, strokes } from "./geometry";
import type { Layer, MeshLayer, Paint, Picture, Vec3, WireLayer } from "./layers";
import { type Projector, type Size, type View, axesOf, dot, minus, plus, projector, row, unit } from "./view";

/** A path or a dot. Colours are literal, or `var(--name)` if they follow the theme. */
export interface Shape {
  d: string;
  fill?: string;
  stroke?: string;
  width?: number;
  opacity?: number;
  depth: number;
}

/** How fine a still is: the smallest triangle, in square pixels, and the stroke that closes the gaps beside one. */
const PAGE = { leastArea: 0, seam: 0.6 };
// Chosen: a triangle of less than half a pixel, at a third of the size, and its width.
const THUMBNAIL = { leastArea: 4, seam: 2.5 };

/** More triangles than this have their corners in whole pixels, relative to the one before: half the bytes. */
const FEW = 300;
/** Steps of the light on so many triangles: fewer colours have half the bytes, and neighbours of one colour are one path. Chosen: the
 * eye sees no step. */
const TONES = 32;
/** The factor for the depth of lines and dots, so that they are drawn over the triangles on which they lie. */
const NEARER = 0.965;

/** A still is drawn in a page, or as a thumbnail at a third of its size, without what is too small to be seen there. */
export function still({ layers }: Picture, view: View, size: Size, isThumbnail = false): Shape[] {
  const at = projector(view, size);
  const light = lightOf(view);
  // A wire over triangles that are drawn becomes their outline: one shape each instead of two or three.
  const outlines = new Map<MeshLayer, WireLayer>();
  for (const wire of layers) {
    const below = wire.kind === "wire" && layers.find((layer) => layer.kind === "mesh" && hasSameTriangles(layer, wire));
    if (below) outlines.set(below as MeshLayer, wire);
  }
  const drawn = new Set<Layer>(outlines.values());
  const fineness = isThumbnail ? THUMBNAIL : PAGE;
  const shapes = layers.flatMap((layer) =>
    layer.kind === "mesh" ? faces(layer, at, light, { ...fineness, size }, outlines.get(layer)) : drawn.has(layer) ? [] : shapesOf(layer, at),
  );
  // Sorting is stable: of equal depth, a later layer is drawn over an earlier one.
  return joined(shapes.sort((a, b) => b.depth - a.depth));
}

/** Neighbours in the order that look alike, as one path each: a page has thousands of these shapes. */
function joined(shapes: readonly Shape[]): Shape[] {
  const paths: Shape[] = [];
  for (const shape of shapes) {
    const last = paths.at(-1);
    // Where both are transparent, their overlap is darker than either.
    const isAlike = last && shape.opacity === undefined && LOOKS.every((look) => last[look] === shape[look]);
    if (isAlike) last.d += shape.d;
    else paths.push({ ...shape });
  }
  return paths;
}
const LOOKS = ["fill", "stroke", "width", "opacity"] as const;

const hasSameTriangles = (mesh: Layer & { kind: "mesh" }, wire: WireLayer) =>
  mesh.positions === wire.positions && mesh.indices === wire.indices && mesh.opacity === undefined;

function lightOf(view: View): Vec3 {
  const [right, up, back] = axesOf(view);
  const [x, y, z] = LIGHT.from;
  return unit(plus(plus(plus([0, 0, 0], right, x), up, y), back, z));
}

export const painted = (paint: Paint) => (paint.startsWith("--") ? `var(${paint})` : paint);

function shapesOf(layer: Exclude<Layer, MeshLayer>, at: Projector): Shape[] {
  // Sorted by their middles, long lines beside the shape would cross it.
  const depthFactor = layer.isOnTop ? 1e-3 : layer.isUnder || layer.isWhole ? 1e3 : NEARER;
  switch (layer.kind) {
    // Only the graphics card draws it; a page that needs it without has a picture of the core.
    case "field":
      return [];
    case "lines":
      return lines(layer.positions, layer, at, depthFactor);
    case "wire": {
      const seen = segments(layer.positions, edgesOf(layer.positions, layer.indices));
      return lines(seen, layer, at, depthFactor);
    }
    case "silhouette":
      return lines(silhouette(layer.positions, layer.indices, edgesOf(layer.positions, layer.indices), at.eye), layer, at, depthFactor);
    case "normals":
      return lines(strokes(layer.at, layer.directions, layer.length), layer, at, depthFactor);
    case "points": {
      const dots: Shape[] = [];
      for (let i = 0; 3 * i < layer.positions.length; i++) {
        const [x, y, depth] = at.to(row(layer.positions, i));
        // A stroke of length zero with round ends is a dot.
        dots.push({ d: `M${px(x)} ${px(y)}h0`, stroke: painted(layer.paint), width: layer.size, depth: depth * depthFactor });
      }
      return dots;
    }
  }
}

/** Whether a triangle is seen in no shape of the figure: on a phone it is higher than the still, which is then shown with its surroundings. */
const isOutside = (places: readonly Vec3[], { width, height }: Size) =>
  [width, height].some((side, k) => places.every((p) => p[k]! < -side / 6) || places.every((p) => p[k]! > side + side / 6));

function faces(layer: MeshLayer, at: Projector, light: Vec3, { leastArea, seam, size }: typeof PAGE & { size: Size }, outline: WireLayer | undefined): Shape[] {
  const { positions, indices } = layer;
  const colors = vertexColors(layer);
  const isFine = indices.length < 3 * FEW;
  const shapes: Shape[] = [];
  for (let face = 0; 3 * face < indices.length; face++) {
    const triangle = corners(positions, indices, face);
    const normal = unit(across(triangle));
    const isFront = dot(normal, minus(at.eye, triangle[0])) > 0;
    if (!isFront && layer.sides === "front") continue;
    const places = triangle.map((p) => {
      const [x, y, depth] = at.to(p);
      return isFine ? [x, y, depth] : [Math.round(x), Math.round(y), depth];
    }) as unknown as [Vec3, Vec3, Vec3];
    // In whole pixels some triangles are none.
    if (areaOf(places) < leastArea || (!isFine && areaOf(places) === 0) || isOutside(places, size)) continue;
    const depth = (places[0][2] + places[1][2] + places[2][2]) / 3;
    const paint = !isFront && layer.back ? layer.back : layer.groups ? layer.groups.paints[layer.groups.of[face]!]! : layer.paint;
    const color = colors ? mean(colors, indices, face) : paint.startsWith("#") ? hex(paint) : undefined;
    const normals = layer.shading === "smooth" ? layer.normals : undefined;
    const towards = normals ? unit(mean(normals, indices, face)) : normal;
    // A back is lit like the front of the triangle with the opposite winding.
    const exact = (isFront ? 1 : -1) * dot(towards, light);
    const cosine = isFine ? exact : Math.round(exact * TONES) / TONES;
    const fill = !color ? painted(paint) : css(layer.shading === "none" ? color : lit(color, cosine));
    const d = closed(places, isFine);
    // A thin stroke of the same colour closes the antialiasing seams between neighbours.
    const shape: Shape = outline
      ? { d, fill, stroke: painted(outline.paint), width: outline.width, depth }
      : { d, fill, stroke: fill, width: seam, depth };
    shapes.push(layer.opacity === undefined ? shape : { ...shape, opacity: layer.opacity });
  }
  return shapes;
}

const areaOf = ([[ax, ay], [bx, by], [cx, cy]]: readonly [Vec3, Vec3, Vec3]) =>
  Math.abs((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) / 2;

function closed(places: readonly Vec3[], isFine: boolean): string {
  if (isFine) return `M${places.map(([x, y]) => `${px(x)} ${px(y)}`).join("L")}z`;
  const [first, ...others] = places.map(([x, y]) => [Math.round(x), Math.round(y)] as const);
  let last = first!;
  const steps = others.map((to) => {
    const step = `${to[0] - last[0]} ${to[1] - last[1]}`;
    last = to;
    return step;
  });
  return `M${first![0]} ${first![1]}l${steps.join(" ")}z`;
}

function mean(of: Float32Array, indices: Uint32Array, face: number): Rgb {
  const rows = [0, 1, 2].map((k) => row(of, indices[3 * face + k]!));
  return [0, 1, 2].map((k) => (rows[0]![k]! + rows[1]![k]! + rows[2]![k]!) / 3) as unknown as Rgb;
}

function lines(
  positions: Float32Array,
  { paint, width }: { paint: Paint; width: number },
  at: Projector,
  depthFactor: number,
): Shape[] {
  const shapes: Shape[] = [];
  const isFine = positions.length < 6 * FEW;
  for (let i = 0; 6 * i < positions.length; i++) {
    const [a, b] = [at.to(row(positions, 2 * i)), at.to(row(positions, 2 * i + 1))];
    const d = isFine ? `M${px(a[0])} ${px(a[1])}L${px(b[0])} ${px(b[1])}` : closed([a, b], false);
    shapes.push({ d, stroke: painted(paint), width, depth: depthFactor * 0.5 * (a[2] + b[2]) });
  }
  return shapes;
}

/** Rounded to a tenth of a pixel. */
const px = (value: number) => String(Math.round(value * 10) / 10);
