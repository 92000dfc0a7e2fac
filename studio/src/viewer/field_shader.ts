// A field in a picture: a triangle over the whole picture, whose fragments trace a ray each by the field's own program.
import {
  BufferAttribute,
  BufferGeometry,
  type Camera,
  type Color,
  GLSL3,
  type IUniform,
  Matrix4,
  Mesh,
  RawShaderMaterial,
  Vector3,
  Vector4,
} from "three";
import { LIGHT, hex, rampStops } from "./color";
import type { FieldLayer, Section } from "./layers";

/** The most values that a ray asks for. A ray along a face takes steps of half a pixel. */
const STEPS = 400;

/** Rays with so many steps are brightest, on a logarithmic scale. */
const BRIGHTEST = 120;

const VERTEX = `
in vec3 position;
out vec2 at;
void main() {
  at = position.xy;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}`;

/**
 * Sphere tracing: a step is the value over the field's Lipschitz constant, and at least half a pixel, until the sign changes;
 * the bracket is narrowed by false position and by halves in turn. The field is called in one place, since compilers copy it
 * into each.
 */
const FRAGMENT = `
precision highp float;
precision highp int;
uniform vec3 low, high, right, up, back;
// Points of the near plane, and the ways from there to the far plane: in the middle, and per unit to the right and upwards.
uniform vec3 from[3], way[3];
// The rows of the camera's matrix that give depth.
uniform vec4 deep[2];
// The size of a pixel at the near plane, and its growth per length.
uniform vec2 pixel;
uniform float slope;
uniform vec4 plane;
uniform int steps, light, isCut;
uniform vec3 front, rear, cut;
uniform vec4 sun;
in vec2 at;
out vec4 color;

FIELD

const float FAR = 3.0e38;

float encoded(float x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1.0 / 2.4) - 0.055; }

/** As the camera's projection has it. */
float depth(vec3 p) { return 0.5 + 0.5 * dot(deep[0], vec4(p, 1.0)) / dot(deep[1], vec4(p, 1.0)); }

/** The ramp of heat, in sRGB. */
vec3 heat(float share) {
  vec3 stops[8] = vec3[8](HEAT);
  float place = clamp(share, 0.0, 1.0) * 7.0;
  int k = min(int(place), 6);
  return mix(stops[k], stops[k + 1], place - float(k));
}

/** The light of the viewer's meshes: ambient, and a sun that turns with the eye. */
vec3 plain(vec3 paint, vec3 n, vec3 toEye) {
  vec3 l = normalize(right * sun.x + up * sun.y + back * sun.z);
  float cosine = max(dot(n, l), 0.0);
  vec3 h = normalize(l + toEye);
  vec3 glint = vec3(0.016) + vec3(0.984) * pow(1.0 - max(dot(toEye, h), 0.0), 5.0);
  // Blinn and Phong's highlight, as three.js has it, of exponent 40.
  vec3 shine = glint * 0.25 * 21.0 * pow(max(dot(n, h), 0.0), 40.0);
  return paint * (AMBIENT + sun.w * cosine) + shine * cosine * sun.w;
}

/** The light of the core's pictures without its shadows: a lamp over the left shoulder, a sky, a glaze. */
vec3 studio(vec3 paint, vec3 n, vec3 toEye) {
  vec3 level = back - vec3(0.0, 0.0, back.z);
  level = length(level) > 0.0 ? normalize(level) : -up;
  vec3 lamp = normalize(vec3(0.0, 0.0, 1.15) - 0.75 * right + 0.75 * level);
  vec3 lit = paint * (0.405 + 0.1 * n.z + 0.78 * max(dot(n, lamp), 0.0));
  vec3 mirrored = reflect(-toEye, n);
  float sky = 0.4 + (mirrored.z < 0.0 ? 0.14 : 0.16) * mirrored.z;
  float seen = sky + 3.2 * smoothstep(0.965, 0.992, dot(mirrored, lamp));
  float share = 0.04 + 0.56 * pow(1.0 - max(dot(toEye, n), 0.0), 5.0);
  return mix(lit, vec3(seen), share);
}

void main() {
  vec3 eye = from[0] + at.x * from[1] + at.y * from[2];
  vec3 d = way[0] + at.x * way[1] + at.y * way[2];
  float whole = length(d);
  d /= whole;
  // The part of the ray in the box, between near and far plane, and behind the section.
  vec3 inverse = 1.0 / d;
  vec3 a = (low - eye) * inverse, b = (high - eye) * inverse;
  vec3 near = min(a, b), far = max(a, b);
  float start = max(max(near.x, near.y), max(near.z, 0.0));
  float end = min(min(far.x, far.y), min(far.z, whole));
  bool isOnPlane = false;
  if (isCut == 1) {
    float height = plane.w - dot(plane.xyz, eye), rate = dot(plane.xyz, d);
    float cross = rate == 0.0 ? FAR : height / rate;
    if (rate >= 0.0) end = height < 0.0 ? -1.0 : min(end, cross);
    else if (cross > start) {
      start = cross;
      isOnPlane = true;
    }
  }
  if (start >= end) discard;

  float t = start, outer = start, above = 1.0, inner = start, below = 0.0, side = 1.0, value = 0.0;
  bool isBracket = false, isHit = false, isFlat = false;
  int narrowed = 0, taken = 0;
  for (int i = 0; i < steps; i++) {
    if (!isBracket) taken = i;
    value = field(eye + t * d);
    if (i == 0 && value < 0.0) {
      side = -1.0;
      if (isOnPlane) {
        isHit = isFlat = true;
        break;
      }
    }
    value *= side;
    if (!isBracket) {
      if (value < 0.0) {
        isBracket = true;
        inner = t;
        below = value;
        t = outer + (inner - outer) * clamp(above / (above - below), 0.05, 0.95);
        continue;
      }
      if (t >= end) break;
      outer = t;
      above = value;
      t = min(t + max(value / slope, 0.5 * (pixel.x + pixel.y * t)), end);
      continue;
    }
    if (value < 0.0) {
      inner = t;
      below = value;
    } else {
      outer = t;
      above = value;
    }
    if (++narrowed == 8) {
      isHit = true;
      break;
    }
    float share = narrowed % 2 == 0 ? above / (above - below) : 0.5;
    t = outer + (inner - outer) * clamp(share, 0.02, 0.98);
  }
  // Out of steps on a ray that grazes the surface.
  if (!isHit && (isBracket || (t < end && value < 0.5 * slope * (pixel.x + pixel.y * t)))) isHit = true;
  if (light == 3) {
    color = vec4(heat(log2(float(max(taken, 1))) / log2(MOST)), 1.0);
    gl_FragDepth = isHit ? depth(eye + t * d) : 1.0;
    return;
  }
  if (!isHit) discard;

  vec3 p = eye + t * d;
  vec3 paint = side > 0.0 ? front : rear;
  vec3 lit = cut;
  if (!isFlat) {
    // Within, where the value is not zero: a length has no gradient at zero, and rounding makes many hits exactly that.
    vec3 gradient = field_dual(isBracket ? eye + inner * d : p).xyz;
    float size = length(gradient);
    vec3 n = size > 0.0 ? side * gradient / size : -d;
    // Rounding may turn a normal of the outline away from the eye.
    if (dot(n, d) > 0.0) n = normalize(n - dot(n, d) * d);
    if (light == 2) {
      color = vec4(0.5 * n + 0.5, 1.0);
    } else {
      lit = light == 1 ? studio(paint, n, -d) : plain(paint, n, -d);
    }
  }
  if (isFlat || light != 2) color = vec4(encoded(lit.r), encoded(lit.g), encoded(lit.b), 1.0);
  gl_FragDepth = depth(p);
}`;

type Three = [Vector3, Vector3, Vector3];
const three = (): Three => [new Vector3(), new Vector3(), new Vector3()];
type Uniforms = Record<string, IUniform>;

/** The light of a field: that of the viewer's meshes, that of the core's pictures, the normal, or the steps of the ray. */
const LIGHTS = { plain: 0, studio: 1, normals: 2, steps: 3 } as const;

/** The object of a layer, invisible until its program is compiled. */
export function fieldMesh(layer: FieldLayer, color: (paint: string) => Color): Mesh {
  const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(Float32Array.of(-1, -1, 0, 3, -1, 0, -1, 3, 0), 3));
  const { x, y, z } = new Vector3(...LIGHT.from).normalize();
  const uniforms: Uniforms = {
    numbers: { value: vectors(layer.program.numbers) },
    low: { value: new Vector3() },
    high: { value: new Vector3() },
    slope: { value: 1 },
    right: { value: new Vector3() },
    up: { value: new Vector3() },
    back: { value: new Vector3() },
    from: { value: three() },
    way: { value: three() },
    deep: { value: [new Vector4(), new Vector4()] },
    pixel: { value: [0, 0] },
    plane: { value: new Vector4() },
    isCut: { value: 0 },
    steps: { value: STEPS },
    light: { value: LIGHTS[layer.light ?? "plain"] },
    front: { value: color(layer.paint) },
    rear: { value: color(layer.back ?? layer.paint) },
    cut: { value: color(layer.paint) },
    sun: { value: new Vector4(x, y, z, LIGHT.sun) },
  };
  const material = new RawShaderMaterial({
    glslVersion: GLSL3,
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT.replace("AMBIENT", LIGHT.ambient.toFixed(4))
      .replaceAll("MOST", BRIGHTEST.toFixed(1))
      .replace("HEAT", rampStops("heat").map((stop) => `vec3(${hex(stop).map((x) => x.toFixed(4))})`).join(", "))
      .replace("FIELD", () => layer.program.code),
    uniforms,
    depthTest: !layer.isOnTop,
  });
  const mesh = new Mesh(geometry, material);
  mesh.frustumCulled = false;
  mesh.visible = false;
  renumber(mesh, layer);
  return mesh;
}

const vectors = (numbers: Float32Array) => Array.from({ length: numbers.length / 4 }, (_, k) => new Vector4().fromArray(numbers, 4 * k));

const uniformsOf = (mesh: Mesh): Uniforms => (mesh.material as RawShaderMaterial).uniforms;

/** Takes the numbers of a layer with the same code. */
export function renumber(mesh: Mesh, { program: { numbers, box } }: FieldLayer): void {
  const { numbers: rows, low, high, slope } = uniformsOf(mesh);
  rows!.value = vectors(numbers);
  (low!.value as Vector3).fromArray(box, 0);
  (high!.value as Vector3).fromArray(box, 3);
  slope!.value = box[6];
}

/** Takes the camera, whose matrices are current, the size of the picture in device pixels, and the section. */
export function aim(mesh: Mesh, camera: Camera, widthPx: number, section?: { of: Section; color: Color }): void {
  const uniforms = uniformsOf(mesh);
  // Points of a plane of constant depth are linear in those of the picture, for every camera of three.js. In doubles: the far
  // plane is where single precision ends.
  const plane = (z: number) => [new Vector3(0, 0, z), new Vector3(1, 0, z), new Vector3(0, 1, z)].map((at) => at.unproject(camera)) as Three;
  const [near, far] = [plane(-1), plane(1)];
  const steps = (of: Three): Three => [of[0], of[1].sub(of[0]), of[2].sub(of[0])];
  const [from, ends] = [steps(near), steps(far)];
  const way = ends.map((end, k) => end.clone().sub(from[k]!)) as Three;
  const [narrow, wide] = [from[1], ends[1]].map((row) => (2 * row.length()) / widthPx) as [number, number];
  uniforms["from"]!.value = from;
  uniforms["way"]!.value = way;
  uniforms["pixel"]!.value = [narrow, (wide - narrow) / way[0].length()];
  const clip = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).elements;
  uniforms["deep"]!.value = [2, 3].map((row) => new Vector4(...[0, 4, 8, 12].map((column) => clip[row + column]!)));
  camera.matrixWorld.extractBasis(uniforms["right"]!.value as Vector3, uniforms["up"]!.value as Vector3, uniforms["back"]!.value as Vector3);
  uniforms["isCut"]!.value = section ? 1 : 0;
  if (!section) return;
  uniforms["plane"]!.value = new Vector4(...section.of.normal, section.of.offset);
  uniforms["cut"]!.value = section.color;
}
