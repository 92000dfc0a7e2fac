// The text of a field in GLSL, as `chordal convert part.star part.glsl` writes it, prepared for a shader: its numbers become
// uniforms, so that a script with other numbers and the same operations needs no new program.

export interface FieldProgram {
  /** The functions `field` and `field_dual`, which read `numbers`. */
  code: string;
  /** The numbers of both functions in the order of the text, padded to a multiple of 4. */
  numbers: Float32Array;
  /** The lower and the upper corner of the box, and the Lipschitz constant. */
  box: Float32Array;
}

/** A number of the expression: with a point or an exponent; in parentheses if it is negative. */
const NUMBER = /\(-(?:\d+\.\d+(?:e-?\d+)?|\d+e-?\d+)\)|(?<![\w.])(?:\d+\.\d+(?:e-?\d+)?|\d+e-?\d+)/g;

/** Every graphics card has this many vectors of uniforms; some are for the camera and the light. */
const FEWEST_VECTORS = 224 - 32;

/** Reads the text. With more numbers than there are uniforms (`vectors`, each of four) they stay in the code. */
export function fieldProgram(text: string, vectors = FEWEST_VECTORS): FieldProgram {
  const name = /^const vec3 (\w+)_low = /m.exec(text)?.[1];
  if (!name) throw new Error("not a field in GLSL");
  const constant = (end: string) => {
    const line = new RegExp(`^const \\w+ ${name}_${end} = (.*);$`, "m").exec(text);
    return (line?.[1]!.replace(/^vec3/, "").match(/-?\d[\d.]*(?:e-?\d+)?/g) ?? []).map(Number);
  };
  const box = Float32Array.from([...constant("low"), ...constant("high"), ...constant("slope")]);
  if (box.length !== 7) throw new Error("a field in GLSL without its box");
  const numbers: number[] = [];
  const lifted = (body: string) =>
    body.replace(NUMBER, (number) => {
      const k = numbers.push(Number(number.replace(/[()]/g, ""))) - 1;
      return `numbers[${k >> 2}].${"xyzw"[k & 3]}`;
    });
  const main = new RegExp(`^(?:float ${name}|vec4 ${name}_dual)\\(vec3 p\\) \\{\\n[^}]*\\}`, "gm");
  const functions = text.replace(/^const .*\n/gm, "").replace(/^\/\/.*\n/gm, "");
  const changed = functions.replace(main, lifted);
  const isLifted = numbers.length <= 4 * vectors;
  const rows = Math.max(Math.ceil(numbers.length / 4), 1);
  const code = (isLifted ? changed : functions).replace(new RegExp(`\\b${name}(_dual)?\\(`, "g"), "field$1(");
  return {
    code: isLifted ? `uniform vec4 numbers[${rows}];\n${code}` : code,
    numbers: isLifted ? Float32Array.from({ length: 4 * rows }, (_, k) => numbers[k] ?? 0) : new Float32Array(0),
    box,
  };
}
