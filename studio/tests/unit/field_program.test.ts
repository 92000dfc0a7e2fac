// A field's text as a program: its numbers become uniforms, and its names those of the shader.
import { describe, expect, test } from "vitest";
import { fieldProgram } from "../../src/viewer";

const source = (width: number, radius: number) => `// block: a shape
const vec3 block_low = vec3((-1.5), (-1.5), (-1e-7));
const vec3 block_high = vec3(1.5, 1.5, 0.5);
const float block_slope = 1.0000001;

float block_round(float a) { return sign(a) * floor(abs(a) + 0.5); }
float block(vec3 p) {
    float t0 = abs(p.x) - ${width};
    float t1e5 = block_round(t0) * (-2.5);
    return max(t1e5, sqrt((p.x * p.x) + (p.y * p.y)) - ${radius});
}

// The gradient in xyz, the value in w.
vec4 block_max(vec4 u, vec4 v) { return u.w > v.w ? u : v; }
vec4 block_dual(vec3 p) {
    vec4 t0 = block_abs(vec4(1, 0, 0, p.x)) - vec4(0, 0, 0, ${width});
    vec4 t1e5 = block_round(t0) * (-2.5);
    return block_max(t1e5, block_length(p) - vec4(0, 0, 0, ${radius}));
}
`;

describe("a program", () => {
  test("has the numbers of both functions, and the box", () => {
    const { code, numbers, box } = fieldProgram(source(1.25, 1e-3));
    const three = [1.25, -2.5, Math.fround(1e-3)];
    expect([...numbers]).toEqual([...three, ...three, 0, 0]);
    expect([...box].map((x) => Number(x.toPrecision(6)))).toEqual([-1.5, -1.5, -1e-7, 1.5, 1.5, 0.5, 1]);
    expect(code).toContain("uniform vec4 numbers[2];");
    expect(code).toContain("float field(vec3 p) {");
    expect(code).toContain("float t1e5 = block_round(t0) * numbers[0].y;");
    expect(code).toContain("vec4 t0 = block_abs(vec4(1, 0, 0, p.x)) - vec4(0, 0, 0, numbers[0].w);");
    // Helpers keep theirs.
    expect(code).toContain("floor(abs(a) + 0.5)");
    expect(code).not.toContain("const");
  });

  test("is the same for other numbers", () => {
    expect(fieldProgram(source(1.25, 0.4)).code).toBe(fieldProgram(source(7.5, 12.5)).code);
  });

  test("keeps its numbers if there are too many for uniforms", () => {
    const { code, numbers } = fieldProgram(source(1.25, 0.4), 0);
    expect(numbers.length).toBe(0);
    expect(code).toContain("abs(p.x) - 1.25");
  });

  test("is refused if the text is none", () => {
    expect(() => fieldProgram("void main() {}")).toThrow("not a field");
  });
});
