// A mesh in a notebook: the studio's viewer in its own frame, without network access. python/chordal/_notebook.py writes the
// page; this file is built into python/chordal/viewer.js.
import { type View, control, rampStops } from "../viewer";
import type { Layer, Vec3 } from "../viewer";
import { Viewer } from "../viewer/viewer";

/** The mesh as JSON in the page. Arrays are little-endian, in base64. */
interface Shown {
  positions: string;
  faces: string;
  normals: string | null;
  values: string | null;
  /** Red, green and blue of each vertex, if it has colours. */
  colors: string | null;
  /** The group of each triangle, and the colour of each group. */
  groups: string | null;
  paints: string[];
  /** The triangles whose edges are drawn, if `faces` is a refinement of them. */
  edges: { positions: string; faces: string } | null;
  /** The ends of the scale of `values`, and the scale's label. */
  range: [number, number];
  what: string;
  wire: boolean;
}

const bytes = (text: string) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
const floats = (text: string) => new Float32Array(bytes(text));

/** The colours of the page. */
const PAINT = { face: "#9fb4cf", back: "#c98f6b", wire: "#2b3a4d" } as const;

function boxOf(positions: Float32Array): { middle: Vec3; size: number } {
  const [low, high] = [
    [Infinity, Infinity, Infinity],
    [-Infinity, -Infinity, -Infinity],
  ];
  for (let i = 0; i < positions.length; i++) {
    const k = i % 3;
    low![k] = Math.min(low![k]!, positions[i]!);
    high![k] = Math.max(high![k]!, positions[i]!);
  }
  const middle = [0, 1, 2].map((k) => (low![k]! + high![k]!) / 2) as unknown as Vec3;
  return { middle, size: Math.hypot(...[0, 1, 2].map((k) => high![k]! - low![k]!)) || 1 };
}

function layers(shown: Shown, hasWire: boolean): Layer[] {
  const [positions, indices] = [floats(shown.positions), new Uint32Array(bytes(shown.faces))];
  const values = shown.values === null ? undefined : floats(shown.values);
  const normals = shown.normals === null ? undefined : floats(shown.normals);
  const mesh: Layer = {
    kind: "mesh",
    id: "mesh",
    positions,
    indices,
    ...(normals ? { normals } : {}),
    ...(values ? { values: { of: values, range: shown.range, ramp: "deviation" as const } } : {}),
    ...(shown.colors ? { colors: floats(shown.colors) } : {}),
    ...(shown.groups ? { groups: { of: new Uint32Array(bytes(shown.groups)), paints: shown.paints } } : {}),
    paint: PAINT.face,
    back: PAINT.back,
    shading: normals ? "smooth" : "flat",
    sides: "both",
  };
  const edges = shown.edges
    ? { positions: floats(shown.edges.positions), indices: new Uint32Array(bytes(shown.edges.faces)) }
    : { positions, indices };
  return hasWire ? [mesh, { kind: "wire", id: "wire", ...edges, paint: PAINT.wire, width: 1 }] : [mesh];
}

function start(): void {
  const shown = JSON.parse(document.getElementById("mesh")!.textContent) as Shown;
  const root = document.getElementById("view")!;
  const { middle, size } = boxOf(floats(shown.positions));
  // At this distance the ball around the box fills the viewer's field of view of 28 degrees: 0.5 / sin 14° = 2.07.
  const home: View = { azimuth: -60, elevation: 22, distance: 2.07 * size, target: middle };
  let view = home;
  let viewer: Viewer;
  try {
    viewer = new Viewer(root);
  } catch {
    root.textContent = "This browser has no WebGL 2, which shows meshes. mesh.render() makes a picture without it.";
    return;
  }
  const wire = document.getElementById("wire") as HTMLInputElement;
  const draw = () => viewer.draw({ layers: layers(shown, wire.checked) });
  wire.checked = shown.wire;
  wire.addEventListener("change", draw);
  const look = (next: View) => {
    view = next;
    viewer.look(next);
  };
  control(root, { view: () => view, size: () => ({ width: root.clientWidth, height: root.clientHeight }), home, look });
  const scale = document.getElementById("scale");
  if (scale) scale.style.background = `linear-gradient(to right, ${rampStops("deviation").join(", ")})`;
  draw();
  look(home);
  document.documentElement.dataset["settled"] = String(shown.positions.length > 0);
}

start();
