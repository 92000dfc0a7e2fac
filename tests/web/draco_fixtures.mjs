// Makes the Draco streams of chordal-io's tests with Google's encoder, and their values with its decoder. It is run by
// hand, because its output is committed:
//
//   npm install --no-save draco3dgltf@1.5.7 && node draco_fixtures.mjs ../../crates/chordal-io/tests/data
import { writeFileSync } from "node:fs";
import draco from "draco3dgltf";

const encoder = await draco.createEncoderModule();
const decoder = await draco.createDecoderModule();
const base64 = (list) => Buffer.from(list.buffer, list.byteOffset, list.byteLength).toString("base64");

/** A wave over n by n points. */
function grid(n) {
  const mesh = { positions: [], normals: [], places: [], colors: [], faces: [] };
  for (let j = 0; j < n; j++) {
    for (let i = 0; i < n; i++) {
      const [u, v] = [i / (n - 1), j / (n - 1)];
      mesh.positions.push(u, v, 0.2 * Math.sin(3 * u) * Math.cos(2 * v));
      const slope = 0.6 * Math.cos(3 * u);
      const length = Math.hypot(slope, 1);
      mesh.normals.push(-slope / length, 0, 1 / length);
      mesh.places.push(u, 1 - v);
      mesh.colors.push((37 * i) % 256, (91 * j) % 256, (i * j * 13) % 256, 255);
    }
  }
  for (let j = 0; j + 1 < n; j++) {
    for (let i = 0; i + 1 < n; i++) {
      const a = j * n + i;
      mesh.faces.push(a, a + 1, a + n, a + 1, a + n + 1, a + n);
    }
  }
  return mesh;
}

/** A cube whose sides share no normals. */
function cube() {
  const mesh = { positions: [], normals: [], places: [], colors: [], faces: [] };
  for (let axis = 0; axis < 3; axis++) {
    for (const side of [-1, 1]) {
      const first = mesh.positions.length / 3;
      for (const [u, v] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
        const position = [0, 0, 0];
        position[axis] = side;
        position[(axis + 1) % 3] = side > 0 ? u : v;
        position[(axis + 2) % 3] = side > 0 ? v : u;
        mesh.positions.push(...position);
        const normal = [0, 0, 0];
        normal[axis] = side;
        mesh.normals.push(...normal);
        mesh.places.push((u + 1) / 2, (v + 1) / 2);
        mesh.colors.push(axis * 80, side > 0 ? 255 : 0, 90, 128);
      }
      mesh.faces.push(first, first + 1, first + 2, first, first + 2, first + 3);
    }
  }
  return mesh;
}

function encode({ positions, normals, places, colors, faces }, method, speed) {
  const [job, builder, mesh] = [new encoder.Encoder(), new encoder.MeshBuilder(), new encoder.Mesh()];
  const n = positions.length / 3;
  builder.AddFacesToMesh(mesh, faces.length / 3, new Uint32Array(faces));
  builder.AddFloatAttributeToMesh(mesh, encoder.POSITION, n, 3, new Float32Array(positions));
  builder.AddFloatAttributeToMesh(mesh, encoder.NORMAL, n, 3, new Float32Array(normals));
  builder.AddFloatAttributeToMesh(mesh, encoder.TEX_COORD, n, 2, new Float32Array(places));
  builder.AddUInt8Attribute(mesh, encoder.COLOR, n, 4, new Uint8Array(colors));
  job.SetAttributeQuantization(encoder.POSITION, 14);
  job.SetAttributeQuantization(encoder.NORMAL, 10);
  job.SetAttributeQuantization(encoder.TEX_COORD, 12);
  job.SetSpeedOptions(speed, speed);
  const sequential = method === "sequential";
  job.SetEncodingMethod(sequential ? encoder.MESH_SEQUENTIAL_ENCODING : encoder.MESH_EDGEBREAKER_ENCODING);
  const out = new encoder.DracoInt8Array();
  const length = job.EncodeMeshToDracoBuffer(mesh, out);
  return Uint8Array.from({ length }, (_, i) => out.GetValue(i));
}

/** The numbers that a call of the decoder writes. */
function written(List, n, fill) {
  const at = decoder._malloc(n * List.BYTES_PER_ELEMENT);
  fill(n * List.BYTES_PER_ELEMENT, at);
  const found = new List(decoder.HEAPF32.buffer, at, n).slice();
  decoder._free(at);
  return base64(found);
}

function decode(stream) {
  const [job, mesh] = [new decoder.Decoder(), new decoder.Mesh()];
  const status = job.DecodeArrayToMesh(stream, stream.length, mesh);
  if (!status.ok()) throw new Error(status.error_msg());
  const [n_faces, n_points] = [mesh.num_faces(), mesh.num_points()];
  const triangles = (n, at) => job.GetTrianglesUInt32Array(mesh, n, at);
  const found = { indices: written(Uint32Array, 3 * n_faces, triangles), n_points, attributes: {} };
  ["POSITION", "NORMAL", "TEXCOORD_0", "COLOR_0"].forEach((name, id) => {
    const attribute = job.GetAttributeByUniqueId(mesh, id);
    const [kind, List] = name === "COLOR_0" ? [decoder.DT_UINT8, Uint8Array] : [decoder.DT_FLOAT32, Float32Array];
    const get = (n, at) => job.GetAttributeDataArrayForAllPoints(mesh, attribute, kind, n, at);
    found.attributes[name] = { id, values: written(List, n_points * attribute.num_components(), get) };
  });
  return found;
}

// From the slowest, which predicts by valence, to the fastest.
const ways = [["edgebreaker", 0], ["edgebreaker", 7], ["edgebreaker", 10], ["sequential", 7]];
const rows = [["cube", cube()], ["grid", grid(7)]].flatMap(([name, mesh]) =>
  ways.map(([method, speed]) => {
    const stream = encode(mesh, method, speed);
    return { name: `${name} by ${method}, speed ${speed}`, stream: base64(stream), ...decode(stream) };
  }),
);
const text = rows.map((row) => JSON.stringify(row)).join(",\n");
writeFileSync(`${process.argv[2]}/draco_streams.json`, `[\n${text}\n]\n`);
