// Makes the compressed fixtures of chordal-io's tests with meshoptimizer's encoder, an independent one: streams with
// their decoded values, and two files. It is run by hand, because its output is committed:
//
//   npm install --no-save meshoptimizer@1.3.0 && node meshopt_fixtures.mjs ../../crates/chordal-io/tests/data
import { writeFileSync } from "node:fs";
import { MeshoptEncoder as encoder } from "meshoptimizer/encoder";
import { MeshoptDecoder as decoder } from "meshoptimizer/decoder";

const folder = process.argv[2];
await Promise.all([encoder.ready, decoder.ready]);

/** A torus about y with radii 2 and 1, without a seam in its positions but with one in its coordinates. */
const [major, minor, around, across] = [2, 1, 18, 9];
const turn = 2 * Math.PI;
const vertices = [];
for (let i = 0; i <= around; i++) {
  for (let j = 0; j <= across; j++) {
    const [u, v] = [i / around, j / across];
    const [cu, su, cv, sv] = [Math.cos(turn * u), Math.sin(turn * u), Math.cos(turn * v), Math.sin(turn * v)];
    const normal = [cu * cv, sv, su * cv];
    const position = [cu * (major + minor * cv), minor * sv, su * (major + minor * cv)];
    vertices.push({ position, normal, uv: [u, v] });
  }
}
const corners = [];
for (let i = 0; i < around; i++) {
  for (let j = 0; j < across; j++) {
    const at = (a, b) => (i + a) * (across + 1) + j + b;
    corners.push(at(0, 0), at(0, 1), at(1, 0), at(1, 0), at(0, 1), at(1, 1));
  }
}
const [remap, n] = encoder.reorderMesh(new Uint32Array(corners), true, true);
const triangles = new Uint32Array(corners);
encoder.reorderMesh(triangles, true, true);
const order = new Array(n);
vertices.forEach((vertex, i) => (order[remap[i]] = vertex));

const bytes = (array) => new Uint8Array(array.buffer, array.byteOffset, array.byteLength);
const flat = (of) => new Float32Array(order.flatMap(of));
const padded = (of) => flat((v) => [...of(v), 1]);
const rows = (Type, width, of) => {
  const out = new Type(n * width);
  order.forEach((vertex, i) => out.set(of(vertex), i * width));
  return bytes(out);
};

// Sixteen bits over the box from -3 to 3, of which fourteen are used, as in gltfpack.
const steps = 16383;
const quantized = rows(Uint16Array, 4, ({ position }) => [...position.map((x) => Math.round(((x + 3) / 6) * steps)), 0]);
const halves = rows(Uint16Array, 2, ({ uv }) => uv.map((x) => Math.round(x * 4095)));
const floats = bytes(flat(({ position }) => position));
const short = (list) => bytes(new Uint16Array(list));
const color = (v) => [(v.normal[0] + 1) / 2, (v.normal[1] + 1) / 2, v.uv[0], v.uv[1]];
const colors = bytes(Uint8Array.from(flat(color), (x) => Math.round(x * 255)));
const wild = Uint8Array.from({ length: 40 * 12 }, (_, i) => (i * i * 31 + (i >> 3) * 77) & 255);
const wide = Uint8Array.from({ length: 40 * 256 }, (_, i) => ((i % 256) * 3 + Math.floor(i / 256) * (i % 7)) & 255);

// Signs and magnitudes that jump: best packed as differences, rotated so that signs come last.
const jumps = Float32Array.from({ length: 240 }, (_, i) => (i & 1 ? -1 : 1) * (1 + ((i * 7919) % 256) / 256));

const quaternions = new Float32Array(
  Array.from({ length: 24 }, (_, i) => {
    const [a, b] = [0.3 * i, 0.2 * i];
    return [Math.sin(a) * Math.cos(b), Math.sin(a) * Math.sin(b) * 0.6, Math.sin(a) * Math.sin(b) * 0.8, Math.cos(a)];
  }).flat(),
);
const lines = new Uint32Array(Array.from({ length: 70 }, (_, i) => (i % 2 ? 100_000 + i : 3 * i)));

const streams = [];
/** Packs rows, and records their decoded values: the rows themselves unless there is a filter. */
function pack(name, mode, stride, source, { filter = "NONE", version = 0, level = 2 } = {}) {
  const count = source.length / stride;
  const stream =
    mode === "ATTRIBUTES"
      ? encoder.encodeVertexBufferLevel(source, count, stride, level, version)
      : encoder.encodeGltfBuffer(source, count, stride, mode, version);
  const decoded = new Uint8Array(source.length);
  decoder.decodeGltfBuffer(decoded, count, stride, stream, mode, filter);
  const text = (list) => Buffer.from(list).toString("base64");
  streams.push({ name, mode, filter, stride, count, stream: text(stream), decoded: text(decoded) });
  return { mode, filter, stride, count, stream: new Uint8Array(stream), length: source.length };
}

/** The views of a file, by the version of the vertex codec. */
function views(version) {
  const v = `v${version}`;
  const own = { version };
  const octahedral = (bits, stride) => encoder.encodeFilterOct(padded((x) => x.normal), n, stride, bits);
  const list = {
    positions: pack(`positions ${v}`, "ATTRIBUTES", 8, quantized, own),
    normals: pack(`normals ${v}`, "ATTRIBUTES", 4, octahedral(8, 4), { ...own, filter: "OCTAHEDRAL" }),
    texcoords: pack(`texcoords ${v}`, "ATTRIBUTES", 4, halves, own),
    indices: pack(`triangles ${v}`, "TRIANGLES", 2, short(triangles), own),
    times: pack(`times ${v}`, "ATTRIBUTES", 4, bytes(Float32Array.from({ length: 24 }, (_, i) => i / 8)), own),
    turns: pack(`turns ${v}`, "ATTRIBUTES", 8, encoder.encodeFilterQuat(quaternions, 24, 8, 12), {
      ...own,
      filter: "QUATERNION",
    }),
    places: pack(
      `places ${v}`,
      "ATTRIBUTES",
      12,
      encoder.encodeFilterExp(Float32Array.from({ length: 72 }, (_, i) => (i % 3 === 0 ? 5 * i : i / 7 - 3)), 24, 12, 15),
      { ...own, filter: "EXPONENTIAL" },
    ),
  };
  if (version === 1) {
    const packed = encoder.encodeFilterColor(flat(color), n, 4, 7);
    list.colors = pack("colours of 7 bits", "ATTRIBUTES", 4, packed, { ...own, filter: "COLOR" });
  } else {
    list.colors = pack("colours v0", "ATTRIBUTES", 4, colors, own);
  }
  return list;
}

const files = [0, 1].map(views);
pack("floats", "ATTRIBUTES", 12, floats, { version: 1, level: 3 });
for (const version of [0, 1]) pack(`wild v${version}`, "ATTRIBUTES", 12, wild, { version, level: 0 });
pack("jumps", "ATTRIBUTES", 4, bytes(jumps), { version: 1, level: 3 });
pack("wide", "ATTRIBUTES", 256, wide.subarray(0, 33 * 256), { version: 1, level: 3 });
const half = 60;
const some = (list) => list.slice(0, 4 * half);
const normals16 = encoder.encodeFilterOct(some(padded((x) => x.normal)), half, 8, 11);
pack("normals of 11 bits", "ATTRIBUTES", 8, normals16, { filter: "OCTAHEDRAL" });
const colors16 = encoder.encodeFilterColor(some(flat(color)), half, 8, 12);
pack("colours of 12 bits", "ATTRIBUTES", 8, colors16, { version: 1, filter: "COLOR" });
pack("lines", "INDICES", 4, bytes(lines));
pack("short lines", "INDICES", 2, short(lines.map((x) => x % 65_000)));
pack("triangles of 4 bytes", "TRIANGLES", 4, bytes(triangles.slice(0, 150)));
writeFileSync(`${folder}/meshopt_streams.json`, `[\n${streams.map((row) => JSON.stringify(row)).join(",\n")}\n]\n`);

/** A file as gltfpack writes it, with only compressed views, and with several instances of its mesh. */
function glb(name, list) {
  const [bufferViews, parts] = [[], []];
  let [packed, plain] = [0, 0];
  for (const view of Object.values(list)) {
    const { stream, length, mode, filter, stride, count } = view;
    const extension = { buffer: 0, byteOffset: packed, byteLength: stream.length, byteStride: stride, mode, count };
    if (filter !== "NONE") extension.filter = filter;
    const hasStride = mode === "ATTRIBUTES" && count > 24;
    bufferViews.push({
      buffer: 1,
      byteOffset: plain,
      byteLength: length,
      ...(hasStride ? { byteStride: stride } : {}),
      extensions: { [name]: extension },
    });
    const fill = -stream.length & 3;
    parts.push(stream, new Uint8Array(fill));
    packed += stream.length + fill;
    plain += length + (-length & 3);
  }
  const at = Object.keys(list).reduce((all, key, i) => ({ ...all, [key]: i }), {});
  const accessor = (key, componentType, type, count, more = {}) => ({ bufferView: at[key], componentType, type, count, ...more });
  const used = [name, "KHR_mesh_quantization", "KHR_texture_transform", "EXT_mesh_gpu_instancing"];
  const q = (x) => Math.round(((x + 3) / 6) * steps);
  const bounds = (pick) => [0, 1, 2].map((k) => pick(...order.map(({ position }) => q(position[k]))));
  const transform = { scale: [65535 / 4095, 65535 / 4095] };
  const json = {
    asset: { version: "2.0" },
    extensionsUsed: used,
    extensionsRequired: [name, "KHR_mesh_quantization", "EXT_mesh_gpu_instancing"],
    buffers: [{ byteLength: packed }, { byteLength: plain, extensions: { [name]: { fallback: true } } }],
    bufferViews,
    accessors: [
      accessor("positions", 5123, "VEC3", n, { min: bounds(Math.min), max: bounds(Math.max) }),
      accessor("normals", 5120, "VEC3", n, { normalized: true }),
      accessor("texcoords", 5123, "VEC2", n, { normalized: true }),
      accessor("colors", 5121, "VEC4", n, { normalized: true }),
      accessor("indices", 5123, "SCALAR", triangles.length),
      accessor("times", 5126, "SCALAR", 24, { min: [0], max: [23 / 8] }),
      accessor("turns", 5122, "VEC4", 24, { normalized: true }),
      accessor("places", 5126, "VEC3", 24),
    ],
    images: [{ uri: "torus.png" }],
    textures: [{ source: 0 }],
    materials: [
      { name: "skin", pbrMetallicRoughness: { baseColorTexture: { index: 0, extensions: { KHR_texture_transform: transform } } } },
    ],
    meshes: [
      {
        name: "torus",
        primitives: [{ attributes: { POSITION: 0, NORMAL: 1, TEXCOORD_0: 2, COLOR_0: 3 }, indices: 4, material: 0 }],
      },
    ],
    nodes: [
      { name: "one", children: [1], translation: [0, 0, 10] },
      { mesh: 0, translation: [-3, -3, -3], scale: [6 / steps, 6 / steps, 6 / steps] },
      { name: "many", children: [3] },
      {
        name: "crowd",
        mesh: 0,
        extensions: { EXT_mesh_gpu_instancing: { attributes: { TRANSLATION: 7, ROTATION: 6 } } },
      },
    ],
    animations: [
      {
        channels: [{ sampler: 0, target: { node: 0, path: "rotation" } }],
        samplers: [{ input: 5, output: 6 }],
      },
    ],
    scenes: [{ nodes: [0, 2] }],
    scene: 0,
  };
  const text = Buffer.from(JSON.stringify(json));
  const chunk = (kind, data, filler) => {
    const body = Buffer.concat([data, Buffer.alloc(-data.length & 3, filler)]);
    const head = Buffer.alloc(8);
    head.writeUInt32LE(body.length, 0);
    head.write(kind, 4, "latin1");
    return Buffer.concat([head, body]);
  };
  const chunks = Buffer.concat([chunk("JSON", text, 0x20), chunk("BIN\0", Buffer.concat(parts), 0)]);
  const head = Buffer.alloc(12);
  head.write("glTF", 0, "latin1");
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(12 + chunks.length, 8);
  return Buffer.concat([head, chunks]);
}

writeFileSync(`${folder}/torus_ext_meshopt.glb`, glb("EXT_meshopt_compression", files[0]));
writeFileSync(`${folder}/torus_khr_meshopt.glb`, glb("KHR_meshopt_compression", files[1]));
