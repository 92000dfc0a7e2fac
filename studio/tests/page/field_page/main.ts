// Fields on the graphics card, for the tests that compare them with the core: values at points, and pictures.
import { type FieldLayer, type MeshLayer, type Section, type View, fieldProgram } from "../../../src/viewer";
import { Viewer } from "../../../src/viewer/viewer";

/** What is in the picture beside the field. */
interface Beside {
  section?: Section;
  /** The height of a blue square of half size 1 across z. */
  square?: number;
}

declare global {
  /** The field and its gradient at points: x, y, z, value of each. */
  var dualsAt: (source: string, points: number[]) => number[];
  /** The field alone at points. */
  var valuesAt: (source: string, points: number[]) => number[];
  /** Four numbers of an expression of `p`, at points. */
  var evaluated: (source: string, of: string, points: number[]) => number[];
  /** The bytes of a picture in base 64, since long arrays take seconds to the test; `null` if the field cannot be drawn. */
  var pictureOf: (source: string, view: View, light: FieldLayer["light"], beside?: Beside) => Promise<string | null>;
  /** The bytes of an encoded picture, both in base 64. */
  var pixelsOf: (png: string) => Promise<string>;
  /** Milliseconds from the call to the first picture, and the number of programs that three.js has. */
  var timed: (source: string, view: View) => Promise<{ ms: number; programs: number }>;
  /** Loses the graphics context, or restores it. */
  var context: (what: "lose" | "restore") => void;
  /** What the viewer said about the field, in order. */
  var said: boolean[];
}

/** Evaluates at points, one a pixel. */
globalThis.evaluated = (source, of, points) => {
  const canvas = document.createElement("canvas");
  const gl = canvas.getContext("webgl2")!;
  if (!gl.getExtension("EXT_color_buffer_float")) throw new Error("no float targets");
  const program = gl.createProgram();
  const add = (type: number, text: string) => {
    const shader = gl.createShader(type)!;
    gl.shaderSource(shader, `#version 300 es\nprecision highp float;\n${text}`);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(`${gl.getShaderInfoLog(shader)}\n${text}`);
    gl.attachShader(program, shader);
  };
  add(gl.VERTEX_SHADER, "in vec2 at; void main() { gl_Position = vec4(at, 0.0, 1.0); }");
  add(
    gl.FRAGMENT_SHADER,
    `uniform highp sampler2D points; out vec4 result;\n${source}
     void main() { vec3 p = texelFetch(points, ivec2(gl_FragCoord.xy), 0).xyz; result = ${of}; }`,
  );
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(String(gl.getProgramInfoLog(program)));
  const n = points.length / 3;
  const width = Math.min(n, 1024);
  const height = Math.ceil(n / width);
  const texels = new Float32Array(4 * width * height);
  for (let i = 0; i < n; i++) texels.set(points.slice(3 * i, 3 * i + 3), 4 * i);
  const texture = (data: Float32Array | null) => {
    const made = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, made);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, height, 0, gl.RGBA, gl.FLOAT, data);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    return made;
  };
  const target = texture(null);
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
  texture(texels);
  gl.viewport(0, 0, width, height);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, Float32Array.of(-1, -1, 3, -1, -1, 3), gl.STATIC_DRAW);
  gl.useProgram(program);
  gl.enableVertexAttribArray(0);
  gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  const read = new Float32Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, read);
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return [...read.subarray(0, 4 * n)];
};

const nameOf = (source: string) => /^const vec3 (\w+)_low/m.exec(source)![1]!;
globalThis.dualsAt = (source, points) => evaluated(source, `${nameOf(source)}_dual(p)`, points);
globalThis.valuesAt = (source, points) => evaluated(source, `vec4(${nameOf(source)}(p))`, points).filter((_, i) => i % 4 === 0);

const viewer = new Viewer(document.getElementById("view")!);
globalThis.said = [];

function square(z: number): MeshLayer {
  const positions = Float32Array.of(-1, -1, z, 1, -1, z, 1, 1, z, -1, 1, z);
  return { kind: "mesh", id: "square", positions, indices: Uint32Array.of(0, 1, 2, 0, 2, 3), paint: "#0000ff", shading: "none", sides: "both" };
}

function draw(source: string, view: View, light: FieldLayer["light"], { section, square: z }: Beside = {}): Promise<boolean> {
  viewer.look(view);
  return new Promise((resolve) => {
    const drawn = (isDrawn: boolean) => {
      said.push(isDrawn);
      resolve(isDrawn);
    };
    const field: FieldLayer = { kind: "field", id: "field", program: fieldProgram(source), paint: "#db8654", light: light ?? "plain", drawn };
    viewer.draw({ layers: z === undefined ? [field] : [field, square(z)], ...(section ? { section } : {}) });
  });
}

const inBase64 = (bytes: Uint8ClampedArray) => btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""));

globalThis.pictureOf = async (source, view, light, beside) => {
  if (!(await draw(source, view, light, beside))) return null;
  const drawn = viewer.now();
  const copy = Object.assign(document.createElement("canvas"), { width: drawn.width, height: drawn.height });
  const pencil = copy.getContext("2d")!;
  pencil.drawImage(drawn, 0, 0);
  return inBase64(pencil.getImageData(0, 0, drawn.width, drawn.height).data);
};

globalThis.pixelsOf = async (png) => {
  const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(png), (c) => c.charCodeAt(0))]), { premultiplyAlpha: "none", colorSpaceConversion: "none" });
  const copy = Object.assign(document.createElement("canvas"), { width: bitmap.width, height: bitmap.height });
  const pencil = copy.getContext("2d")!;
  pencil.drawImage(bitmap, 0, 0);
  return inBase64(pencil.getImageData(0, 0, bitmap.width, bitmap.height).data);
};

globalThis.timed = async (source, view) => {
  const begun = performance.now();
  await draw(source, view, "studio");
  return { ms: performance.now() - begun, programs: viewer.programs };
};

const lost = (viewer.canvas.getContext("webgl2") as WebGL2RenderingContext).getExtension("WEBGL_lose_context")!;
globalThis.context = (what) => (what === "lose" ? lost.loseContext() : lost.restoreContext());
