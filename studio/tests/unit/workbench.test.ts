// The parts of the workbench that need no browser: lines, links, lanes, files, and the command itself.
import { execFileSync } from "node:child_process";
import { randomBytes } from "node:crypto";
import { existsSync, mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { beforeAll, describe, expect, test, vi } from "vitest";
import { type Outcome, Trapped, run } from "../../src/core/command";
import { Controller } from "../../src/workbench/controller";
import { bench, meshLine, python, quoted, reading, rust, shell, split, viewText, withText, without } from "../../src/workbench/document";
import { isFurther, openedBefore, withCause } from "../../src/workbench/faults";
import { boxOf, levels, parts, partToZUp } from "../../src/workbench/glb";
import { type PictureKind, besides, besideOf, pictureLine } from "../../src/workbench/pictures";
import { MESH_FORMATS, exportLine, exportMesh } from "../../src/workbench/exports";
import { Jobs, Stopped, type WorkerLike } from "../../src/core/jobs";
import { type Box, awayFrom, distanceOf, fillingDistance, pixelsOf, towards } from "../../src/workbench/pixels";
import type { Certificate } from "../../src/workbench/report";
import { roomFor } from "../../src/workbench/stage/framing";
import { projector } from "../../src/viewer/view";
import { pack, unpack } from "../../src/workbench/share";
import { faultOf, madeBy } from "../../src/workbench/outcome";
import type { LaneName } from "../../src/workbench/state";
import { byLines } from "../../src/workbench/Touching";
import { BenchSay } from "../../src/workbench/words";

// The tests' module is neither small nor fast.
vi.setConfig({ testTimeout: 180_000, hookTimeout: 60_000 });

const SCREEN = { width: 1366, height: 768, fovDeg: 28, distance: 12.3456789 };
const text = (of: string) => new TextEncoder().encode(of);
const block = bench("block.star", { "block.star": text("box(1, 2, 3)") });

describe("the line", () => {
  test("is the line that one would type", () => {
    expect(shell([meshLine(block, SCREEN, "block.glb")])).toBe("chordal mesh block.star --tol 0.5% -o block.glb");
    const set = { ...block, set: { "wall width": "2.5" }, options: `--iso 60 --text "A b"` };
    expect(shell([meshLine(set, SCREEN, "a.stl")])).toBe(
      "chordal mesh block.star --set 'wall width=2.5' --iso 60 --text 'A b' --tol 0.5% -o a.stl",
    );
    const px = { ...block, budget: { ...block.budget, by: "px" as const } };
    expect(shell([meshLine(px, SCREEN, "a.glb")])).toContain("--px 1 --view '1366x768 fov=28 dist=12.35'");
    expect(quoted("it's")).toBe("'it'\\''s'");
    expect(split(`a 'b c' d"e f"g`)).toEqual(["a", "b c", "de fg"]);
  });
  test("in Python and Rust has the same budget", () => {
    expect(python(block, SCREEN, "block.glb")).toContain('shape.mesh(rel="0.5%")');
    expect(python({ ...block, budget: { ...block.budget, tol: "0.1" } }, SCREEN, "b.glb")).toContain("shape.mesh(tol=0.1)");
    expect(python({ ...block, budget: { ...block.budget, by: "triangles" } }, SCREEN, "b.glb")).toContain("triangles=5000");
    expect(rust(block, SCREEN, "block.glb")).toContain('length: Some("0.5%".parse()?)');
    expect(viewText(SCREEN)).toBe("1366x768 fov=28 dist=12.35");
  });
});

describe("the link", () => {
  test("restores the script, the budget and the options", async () => {
    const of = { ...withText(block, "sphere(2)  # 球\n"), set: { r: "3" }, options: "--iso 1" };
    const back = await unpack((await pack(of))!);
    expect(back).toEqual(of);
  });
  test("of a script that reads files is that of the script alone", async () => {
    const reads = { ...block, files: { ...block.files, "font.ttf": new Uint8Array(randomBytes(900_000)) } };
    expect(await unpack((await pack(reads))!)).toEqual(block);
    expect(await pack(bench("a.obj", { "a.obj": text("v 0 0 0"), "a.mtl": text("newmtl a") }))).toBeNull();
  });
  test("restores a small file of any bytes", async () => {
    const marked = [0xef, 0xbb, 0xbf, 0x31];
    for (const bytes of [Uint8Array.of(0, 255, 254), new Uint8Array(60_000).fill(200), Uint8Array.from(marked)]) {
      const of = bench("a.stl", { "a.stl": bytes });
      expect(await unpack((await pack(of))!)).toEqual(of);
    }
  });
  test("does not exist for a large input", async () => {
    expect(await pack(bench("a.stl", { "a.stl": new Uint8Array(randomBytes(60_000)) }))).toBeNull();
    // Small when compressed, but larger than the limit when decompressed.
    expect(await pack(bench("a.stl", { "a.stl": new Uint8Array(300_000).fill(200) }))).toBeNull();
    const noise = randomBytes(60_000).toString("base64");
    expect(await pack(bench("a.obj", { "a.obj": text(noise) }))).toBeNull();
  });
  test("is refused if it is damaged, or decompresses to more than the limit", async () => {
    for (const coded of ["", "AAAA", "!!!", (await pack(block))!.slice(0, 20)]) expect(await unpack(coded)).toBeNull();
    const packed = async (value: unknown) => {
      const stream = new Blob([JSON.stringify(value)]).stream().pipeThrough(new CompressionStream("deflate-raw"));
      const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
      return btoa(String.fromCharCode(...bytes)).replace(/\+/g, "-").replace(/\//g, "_").replace(/=+$/, "");
    };
    expect(await unpack(await packed({ v: 1, name: "a.star", text: " ".repeat(2_000_000) }))).toBeNull();
    for (const name of ["../a", "a/b.star", ".hidden", ""]) {
      expect(await unpack(await packed({ v: 1, name, text: "x" }))).toBeNull();
    }
    expect((await unpack(await packed({ v: 1, name: "a.star", text: "x", budget: { by: "none", tol: 5 } })))?.budget).toEqual(block.budget);
  });
});

describe("lanes", () => {
  class Worker implements WorkerLike {
    static all: Worker[] = [];
    onmessage: WorkerLike["onmessage"] = null;
    onerror: WorkerLike["onerror"] = null;
    orders: { id: number }[] = [];
    isEnded = false;
    constructor() {
      Worker.all.push(this);
    }
    postMessage(order: { id: number }) {
      this.orders.push(order);
    }
    terminate() {
      this.isEnded = true;
    }
    reply(data: unknown) {
      this.onmessage?.({ data } as MessageEvent);
    }
  }
  const jobs = () => {
    Worker.all = [];
    return new Jobs<"a" | "b">(
      () => Promise.resolve({} as WebAssembly.Module),
      () => new Worker() as WorkerLike,
    );
  };
  const outcome = { exit: 0, stdout: "", stderr: "", outputs: {} };
  const nextTask = () => new Promise((done) => setTimeout(done, 0));

  test("run in parallel, and a newer run cancels an older one", async () => {
    const all = jobs();
    const old = all.run("a", ["x"], {});
    const other = all.run("b", ["y"], {});
    await nextTask();
    const young = all.run("a", ["z"], {});
    await expect(old).rejects.toMatchObject({ why: "newer" });
    expect(Worker.all.map(({ isEnded }) => isEnded)).toEqual([true, false, false]);
    await nextTask();
    Worker.all[1]!.reply({ id: Worker.all[1]!.orders[0]!.id, outcome, bytes: 1 });
    Worker.all[2]!.reply({ id: Worker.all[2]!.orders[0]!.id, outcome, bytes: 1 });
    expect(await other).toBe(outcome);
    expect(await young).toBe(outcome);
    // An idle worker is used again.
    void all.run("a", ["again"], {});
    await nextTask();
    expect(Worker.all.length).toBe(3);
  });

  test("are cancelled, and survive a trap", async () => {
    const all = jobs();
    const one = all.run("a", [], {});
    await nextTask();
    all.cancel("a");
    await expect(one).rejects.toBeInstanceOf(Stopped);
    expect(all.isRunning("a")).toBe(false);
    const two = all.run("a", [], {});
    await nextTask();
    const last = Worker.all.at(-1)!;
    last.reply({ id: last.orders[0]!.id, trapped: "unreachable" });
    await expect(two).rejects.toMatchObject({ why: "trapped", message: "unreachable" });
    expect(last.isEnded).toBe(true);
  });
});

const MODULE = new URL("../../wasm/command.wasm", import.meta.url).pathname;
const CHORDAL = process.env["CHORDAL"];
const EXAMPLES = new URL("../../../examples/", import.meta.url).pathname;

describe("the command as a module", () => {
  let module: WebAssembly.Module;
  beforeAll(async () => {
    expect(existsSync(MODULE), "make studio-page builds the module").toBe(true);
    module = await WebAssembly.compile(readFileSync(MODULE));
  });
  const files = (name: string) => ({ [name]: readFileSync(EXAMPLES + name) });
  const work = async (words: string[], of: Record<string, Uint8Array>) => run(module, words, of);

  test("makes a mesh, reports its bound, and does not change the input", async () => {
    const outcome = await work(["mesh", "block.star", "--tol", "1%", "-o", "block.glb", "--json"], files("block.star"));
    expect(outcome.exit).toBe(0);
    expect(Object.keys(outcome.outputs)).toEqual(["block.glb"]);
    expect(JSON.parse(outcome.stdout).certificate.bound.evidence).toBe("proved");
    const [part] = parts(outcome.outputs["block.glb"]!, JSON.parse(outcome.stdout).certificate.frame);
    expect(part!.indices.length).toBe(3 * JSON.parse(outcome.stdout).certificate.output.triangles);
    expect(part!.normals?.length).toBe(part!.positions.length);
  });

  test("gives triangles in the coordinates of the shape, for any up axis and unit", async () => {
    const words = ["teapot.bpt", "--unit", "mm"];
    for (const line of [["mesh", ...words, "--tol", "2%"], ["lod", ...words, "--px", "1"]]) {
      const outcome = await work([...line, "-o", "t.glb", "--json"], files("teapot.bpt"));
      const { frame } = JSON.parse(outcome.stdout).certificate;
      expect(frame).toEqual({ up: "z", metres_per_unit: 0.001 });
      const [low, high] = boxOf(line[0] === "lod" ? levels(outcome.outputs["t.glb"]!, frame)[0]! : parts(outcome.outputs["t.glb"]!, frame))!;
      // Newell's teapot stands on z = 0 and is 3.15 high.
      expect([low[2], high[2]]).toEqual([expect.closeTo(0, 2), expect.closeTo(3.15, 1)]);
      expect(high[0]).toBeCloseTo(3.43, 1);
    }
  });

  test("renders the pictures beside a mesh", async () => {
    const teapot = { ...bench("teapot.bpt", files("teapot.bpt")), options: "--unit mm" };
    const outcome = await work(["mesh", ...reading(teapot), "--tol", "2%", "-o", "t.glb", "--json"], teapot.files);
    const { certificate } = JSON.parse(outcome.stdout);
    const shown = parts(outcome.outputs["t.glb"]!, certificate.frame);
    const view = { azimuth: 30, elevation: 20, distance: 14, target: [0, 0, 1.5] as const };
    for (const up of ["y", "z"]) {
      const subject = { bench: teapot, parts: shown.map((part) => partToZUp(part, up)), up, atMost: certificate.bound.at_most };
      const report = async (what: PictureKind) => {
        const { line, files } = pictureLine(what, subject, view, { width: 120, height: 80 });
        const picture = await work([...line, "--json"], files);
        expect(picture.exit, picture.stderr).toBe(0);
        expect([...picture.outputs["picture.png"]!.subarray(1, 4)]).toEqual([..."PNG"].map((c) => c.charCodeAt(0)));
        return JSON.parse(picture.stdout).certificate;
      };
      // The distance matches the bound, so the two meshes were not rotated against each other.
      const { bound } = await report("distance");
      expect(bound.at_least).toBeLessThanOrEqual(certificate.bound.at_most);
      expect(bound.at_most).toBeGreaterThanOrEqual(certificate.bound.at_least);
      const { overshade } = await report("overshade");
      expect(overshade.in_view).toBe(certificate.output.triangles);
    }
  });

  test("reports mistakes in a sentence, with their place", async () => {
    const said = await work(["mesh", "a.star", "--tol", "1%", "-o", "a.glb", "--json"], { "a.star": text("box(1, 2") });
    expect(said.exit).toBe(3);
    expect(JSON.parse(said.stdout).error.messages[0]).toMatch(/^a\.star: line 1/);
    const bomb = await work(["inspect", "a.star", "--json"], { "a.star": text("def f(n):\n    return [f(n)]\nf(1)\nsphere(1)") });
    expect(bomb.exit).toBe(3);
    const usage = await work(["mesh"], {});
    expect(usage.exit).toBe(2);
    expect(usage.stderr).toContain("required");
  });

  test("refuses inputs that memory cannot hold, and does not trap", async () => {
    const refused = await work(["mesh", "block.star", "--tol", "1e-9", "-o", "b.glb", "--json"], files("block.star")).catch((error: unknown) => {
      if (error instanceof Trapped) throw new Error(`trapped: ${error.message}`);
      throw error;
    });
    expect(refused.exit).not.toBe(0);
    expect(JSON.parse(refused.stdout).error.messages[0]).toMatch(/^.{20,}/);
  });

  test("writes levels that can be read separately", async () => {
    const outcome = await work(["lod", "cube.obj", "--px", "1", "-o", "l.glb", "--json"], files("cube.obj"));
    const found = levels(outcome.outputs["l.glb"]!, JSON.parse(outcome.stdout).certificate.frame);
    const facts = JSON.parse(outcome.stdout).certificate.levels.levels as { triangles: number }[];
    expect(found.map((level) => level.reduce((sum, { indices }) => sum + indices.length / 3, 0))).toEqual(facts.map(({ triangles }) => triangles));
  });

  test("has the same pixels and distances of levels as the page", async () => {
    const bracket = files("bracket.star");
    const words = ["--px", "1", "--view", "553x321 fov=28", "-o", "l.glb", "--json"];
    const outcome = await work(["lod", "bracket.star", ...words], bracket);
    const { levels, shown } = JSON.parse(outcome.stdout).certificate.levels;
    const screen = (distance: number) => ({ width: 553, height: 321, fovDeg: 28, distance });
    for (const { at_most, distance } of levels) {
      expect(pixelsOf(at_most, screen(distance))).toBeCloseTo(1, 5);
      expect(distanceOf(at_most, 1, screen(NaN)) / distance).toBeCloseTo(1, 5);
    }
    for (const { distance, level, pixels } of shown) {
      expect(pixelsOf(levels[level].at_most, screen(distance)) / pixels).toBeCloseTo(1, 6);
    }
    expect(shown[0].pixels).toBeGreaterThan(3);
    expect(pixelsOf(1, screen(1))).toBe(Infinity);
    // By default the finest level is for a view in which the shape is as high as the picture.
    const inspected = await work(["inspect", "bracket.star", "--json"], bracket);
    const box = JSON.parse(inspected.stdout).inspection.box as Box;
    expect(fillingDistance(box, 28) / levels[0].distance).toBeCloseTo(1, 1);
  });

  test("gives the same bytes as the native command", async () => {
    expect(CHORDAL, "make test-studio names the command").toBeDefined();
    const folder = mkdtempSync(join(tmpdir(), "chordal-bench-"));
    for (const [name, words, output] of [
      ["bracket.star", ["mesh", "bracket.star", "--tol", "2%", "-o"], "x.glb"],
      ["bracket.star", ["mesh", "bracket.star", "--tol", "2%", "-o"], "x.3mf"],
      ["badge.star", ["mesh", "badge.star", "--tol", "2%", "-o"], "x.obj"],
      ["block.star", ["mesh", "block.star", "--tol", "2%", "--require", "estimated", "-o"], "x.ply"],
      ["block.star", ["bake", "block.star", "--cells", "16", "-o"], "x.nrrd"],
      ["cube.obj", ["lod", "cube.obj", "--px", "1", "-o"], "x-levels.glb"],
      ["teapot.bpt", ["render", "teapot.bpt", "--size", "160x120", "-o"], "x.png"],
      ["drawing.svg", ["mesh", "drawing.svg", "--tol", "0.25", "--extrude", "2", "-o"], "x.stl"],
    ] as const) {
      writeFileSync(join(folder, name), readFileSync(EXAMPLES + name));
      execFileSync(CHORDAL!, [...words, output, "--force", "-q"], { cwd: folder });
      const outcome = await work([...words, output], files(name));
      expect(outcome.exit, outcome.stderr).toBe(0);
      for (const [file, bytes] of Object.entries(outcome.outputs)) {
        expect(Buffer.compare(readFileSync(join(folder, file)), bytes), `${words.join(" ")} ${file}`).toBe(0);
      }
    }
  });
});

test("a link restores only known fields, and nothing that could run", async () => {
  const other = { ...block, files: { ...block.files, "b.stl": text("solid b") } };
  expect(await pack({ ...other, combine: { how: "minus", name: "b.stl" } })).toBeNull();
  expect(await pack({ ...block, before: [["mend", "a.stl", "-o", "block.star"]] })).toBeNull();
  expect(await pack({ ...block, options: "x".repeat(900) })).toBeNull();
  const coded = await pack({ ...block, set: { width: "2.5", hole: "__import__('os')" }, options: "--allow mesh" });
  expect(await unpack(coded!)).toEqual({ ...block, set: { width: "2.5" }, options: "--allow mesh" });
});

test("an option that meshing does not know is left out of the mesh, and the page says which", async () => {
  const certificate = { frame: { up: null, metres_per_unit: null }, bound: null, output: null, valid: null, budget: null, notes: [] };
  const jobs = {
    run: async (_: LaneName, words: string[]): Promise<Outcome> =>
      words.includes("--at")
        ? { exit: 2, stdout: "", stderr: "chordal: unexpected argument '--at' found\n", outputs: {} }
        : { exit: 0, stdout: JSON.stringify({ certificate, inspection: {} }), stderr: "", outputs: { "block.glb": scaledTriangle([1, 1, 1], [0, 0, 1]) } },
    isRunning: () => false,
    cancel: () => undefined,
  };
  const of = { ...block, options: "--at 47,8" };
  const control = new Controller(jobs as unknown as Jobs<LaneName>, of, () => undefined);
  control.start();
  await control.until(({ ended }) => ended === of);
  expect([control.state.fault, control.state.shown?.leftOut]).toEqual([null, ["--at"]]);
  expect(control.line()).toEqual(["mesh", "block.star", "--tol", "0.5%", "-o", "block.glb"]);
});

/** A controller whose command makes a triangle of this size from a script with that number. */
const sized = (of = block) => {
  const certificate = { frame: { up: null, metres_per_unit: null }, bound: null, output: null, valid: null, budget: null, notes: [] };
  const jobs = {
    run: async (_: LaneName, words: string[], files: Outcome["outputs"]): Promise<Outcome> => {
      const size = Number(new TextDecoder().decode(files[words[1]!]));
      const made = { [words[words.indexOf("-o") + 1]!]: scaledTriangle([size, size, size], [0, 0, 1]) };
      return { exit: 0, stdout: JSON.stringify({ certificate, inspection: {} }), stderr: "", outputs: made };
    },
    isRunning: () => false,
    cancel: () => undefined,
  };
  const control = new Controller(jobs as unknown as Jobs<LaneName>, withText(of, "1"), () => undefined);
  const write = async (size: string) => {
    control.write(size);
    await control.until(({ ended, bench: now }) => ended === now);
    return control.state;
  };
  return { control, write };
};

test("a view that was only turned follows the size of the shape, one from near stays, and fitting is about the shape that is shown", async () => {
  const { control, write } = sized();
  const first = await write("1");
  expect(first.view.distance).toBe(first.home.distance);
  control.look({ ...first.view, azimuth: 10 });
  const twice = await write("2");
  expect([twice.view.distance / first.view.distance, twice.view.azimuth]).toEqual([2, 10]);
  // A little larger: the growth is seen. Fitting it is possible all the same.
  const more = await write("2.2");
  expect([more.view.distance, more.home.distance / first.home.distance]).toEqual([twice.view.distance, expect.closeTo(2.2, 5)]);
  control.look({ ...more.view, distance: 0.1 });
  const near = await write("4");
  expect([near.view.distance, near.home.distance / first.home.distance]).toEqual([0.1, expect.closeTo(4, 5)]);
  expect((await write("100")).view.distance / first.view.distance).toBeCloseTo(100, 3);
});

test("a shape is fitted into what the panels leave, and the view stays while they open", async () => {
  const [whole, half] = [{ width: 1366, height: 768 }, { width: 600, height: 640 }];
  expect([roomFor(whole, { width: 1366, height: 768 }), roomFor(whole, { width: -60, height: 640 })]).toEqual([1, 1.5]);
  const room = roomFor(whole, half);
  // From that distance its diagonal is narrower than the part that is free.
  const diagonal = projector({ azimuth: 0, elevation: 0, distance: room * 2.4, target: [0, 0, 0] }, whole).scale(room * 2.4);
  expect([room > 1, diagonal < half.width, diagonal > 0.8 * half.width]).toEqual([true, true, true]);
  const { control, write } = sized();
  const { view, home } = await write("1");
  control.sight.makeRoom(room);
  expect(control.state.view).toBe(view);
  expect(control.state.home.distance / home.distance).toBeCloseTo(room, 10);
  expect((await write("2")).view.distance / view.distance).toBeCloseTo(2 * room, 10);
});

test("mistakes after the first are further ones, and an open bracket is named", () => {
  const paren = { text: "Parse error: unexpected identifier 'b', expected symbol ')'", line: 2 };
  expect(isFurther(paren, [{ ...paren }])).toBe(false);
  expect(isFurther({ ...paren, line: 1 }, [paren])).toBe(false);
  expect(isFurther({ ...paren, line: 4 }, [paren])).toBe(true);
  const unknown = { text: "Variable `a` not found", line: 1 };
  expect(isFurther(unknown, [paren])).toBe(true);
  const script = 'a = box(1, 2,  # (\nb = "(("\nc = [1)\n';
  expect([1, 2, 4].map((line) => openedBefore(script, line))).toEqual([undefined, 1, 1]);
  expect(withCause(paren, "a = box(1, 2\nb = 3")).toEqual({ ...paren, openedIn: 1 });
  expect(withCause(paren, "a = box(1, 2)\nb = 3")).toEqual(paren);
  expect(withCause({ text: "Variable `b` not found", line: 2 }, "a = box(1, 2\nb")).toEqual({ text: "Variable `b` not found", line: 2 });
});

test("places where the same parts touch are one finding, and each place is named once", () => {
  const lines = [1, 2] as const;
  const at = (x: number) => [x, 5, 0] as const;
  expect(byLines([{ kind: "flush", at: at(5), lines }, { kind: "flush", at: at(5 + 1e-9), lines }, { kind: "flush", at: at(7), lines }, { kind: "tangent", at: at(9) }])).toEqual([
    { lines, places: [at(5), at(7)] },
    { lines: undefined, places: [at(9)] },
  ]);
});

test("an option is removed from a line with its value, and nothing else", () => {
  const line = ["mend", "a.npy", "--iso", "-5", "--cap", "-o", "b.npy"];
  expect(without(line, "--iso")).toEqual(["mend", "a.npy", "--cap", "-o", "b.npy"]);
  expect(without(line, "--cap")).toEqual(["mend", "a.npy", "--iso", "-5", "-o", "b.npy"]);
  expect(without(["mend", "a.npy", "--iso=-5", "-o", "b"], "--iso")).toEqual(["mend", "a.npy", "-o", "b"]);
  expect(without(line, "--text")).toEqual(line);
});

test("lines in Python and Rust run the same as the page", () => {
  const named = { ...bench("球.star", {}), set: { width: "1e-3", "it's": "2" } };
  expect(python(named, SCREEN, "a.glb")).toContain('chordal.script(open("球.star").read(), **{"width": 1e-3, "it\'s": 2})');
  expect(python({ ...named, set: { width: "print(1)" } }, SCREEN, "a.glb")).toContain('"width": "print(1)"');
  const cut = { ...bench("a.stl", {}), combine: { how: "minus", name: "b.stl" } as const };
  expect(python(cut, SCREEN, "a.glb")).toContain('shape.combine(("difference", chordal.load("b.stl")), rel="0.5%")');
  // In Python a boolean accepts only a length; with a pixel budget it becomes a command line.
  expect(python({ ...cut, budget: { ...cut.budget, by: "px" } }, SCREEN, "a.glb")).toContain("subprocess.run");
  expect(rust(cut, SCREEN, "a.glb")).toBe(
    'std::process::Command::new("chordal").args(["mesh", "a.stl", "--minus", "b.stl", "--tol", "0.5%", "-o", "a.glb"]).status()?;',
  );
});

test("the pictures beside a shape are those that it can have", () => {
  const one = (name: string) => bench(name, {});
  expect(besides(one("a.star"))).not.toContain("distance");
  expect(besideOf(one("a.star"), "traced")).toBe("traced");
  expect(besideOf(one("a.ply"), "traced")).toBe("sliced");
  expect(besideOf(one("a.ply"), "distance")).toBe("distance");
  // A mesh less another solid cannot be compared with the whole mesh.
  expect(besides({ ...one("a.ply"), combine: { how: "minus", name: "b.star" } })).not.toContain("distance");
});

test("the view of the worst place is from its side, outside of the box", () => {
  const box: Box = [[-1, -1, -1], [1, 1, 1]];
  const diagonal = Math.hypot(2, 2, 2);
  const home = { azimuth: -56, elevation: 22, distance: 2.4 * diagonal, target: [0, 0, 0] as const };
  for (const at of [[1, 0.2, 0.3], [-1, 1, -1], [0, 0, 1], [0, 0, -1], [0.1, -0.1, 0], [0, 0, 0]] as const) {
    const view = towards(at, home, home);
    expect(view.target).toEqual(at);
    expect(awayFrom(box, view), String(at)).toBeGreaterThan(0.1);
  }
});

test("numbers of any size are short", () => {
  const [en, zh] = [new BenchSay("en"), new BenchSay("zh")];
  expect([3.37e-14, 0.0323, -2e-9, 0, 1234567, 5e20].map((value) => en.number(value))).toEqual([
    "3.4·10⁻¹⁴", "0.0323", "−2.0·10⁻⁹", "0", "1230000", "5.0·10²⁰",
  ]);
  expect(zh.number(3.37e-14)).toBe("3.4·10⁻¹⁴");
});

test("a file with y up is turned upright", () => {
  const part = { name: "", positions: Float32Array.from([1, 2, 3]), indices: new Uint32Array(), groups: new Uint32Array(), paints: [] };
  expect([...partToZUp(part, "y").positions]).toEqual([1, -3, 2]);
  expect(partToZUp(part, "z")).toBe(part);
});

/** A GLB with one triangle below a node of this scale, and one normal at all corners. */
function scaledTriangle(scale: readonly number[], normal: readonly number[]): Uint8Array {
  const numbers = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, ...normal, ...normal, ...normal]);
  const accessor = (byteOffset: number) => ({ bufferView: 0, byteOffset, componentType: 5126, count: 3, type: "VEC3" });
  const json = JSON.stringify({
    asset: { version: "2.0" },
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0, scale }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, NORMAL: 1 } }] }],
    accessors: [accessor(0), accessor(36)],
    bufferViews: [{ buffer: 0, byteLength: 72 }],
    buffers: [{ byteLength: 72 }],
  });
  const padded = json.padEnd(4 * Math.ceil(json.length / 4));
  const head = (...words: number[]) => new Uint8Array(new Uint32Array(words).buffer);
  const size = 12 + 8 + padded.length + 8 + 72;
  const chunks = [head(0x46546c67, 2, size, padded.length, 0x4e4f534a), text(padded), head(72, 0x004e4942), new Uint8Array(numbers.buffer)];
  return Uint8Array.from(chunks.flatMap((chunk) => [...chunk]));
}

test("unequal scales keep normals upright, and a mirror keeps the front of a triangle", () => {
  const frame = { up: null, metres_per_unit: null };
  const [stretched] = parts(scaledTriangle([2, 1, 1], [1, 1, 0]), frame as never);
  const [nx, ny] = stretched!.normals!;
  expect(nx! / ny!).toBe(1 / 2);
  expect([...stretched!.indices]).toEqual([0, 1, 2]);
  const [mirrored] = parts(scaledTriangle([-1, 1, 1], [0, 0, 1]), frame as never);
  expect([...mirrored!.indices]).toEqual([0, 2, 1]);
  expect(mirrored!.normals![2]).toBe(1);
});

/** A part whose tiles once ended as an archive with a lock file alone. */
const DATA = process.env["CHORDAL_DATA"] ?? new URL("../../../../shared/data", import.meta.url).pathname;
const EMPTY_TILES = join(DATA, "repro3/parts/tiles_empty_zip.star");

test("whether a run has made its files is said by its exit code, not by what it left behind", async () => {
  const left = { "tiles/.chordal.lock": new Uint8Array() };
  for (const exit of [1, 2, 3, 4, 5, 6, 130]) expect(madeBy({ exit, stdout: "", stderr: "", outputs: left }, ["lod"]), String(exit)).toBeNull();
  expect(madeBy({ exit: 5, stdout: "", stderr: "", outputs: left }, ["mesh", "--keep-best"])).toBeNull();
  const best = { "block.glb": text("best") };
  expect(madeBy({ exit: 5, stdout: "", stderr: "", outputs: best }, ["mesh", "--keep-best"])).toBe(best);
  expect(madeBy({ exit: 0, stdout: "", stderr: "", outputs: {} }, ["lod"])).toBeNull();
  if (!existsSync(EMPTY_TILES)) return console.warn(`SKIPPED: the tiles of ${EMPTY_TILES}, which is not here`);
  const module = await WebAssembly.compile(readFileSync(new URL("../../wasm/command.wasm", import.meta.url)));
  const words = ["lod", "part.star", "--px", "1", "-o", "tiles/"];
  const outcome = await run(module, words, { "part.star": readFileSync(EMPTY_TILES) });
  const made = madeBy(outcome, words);
  if (outcome.exit === 0) expect(Object.keys(made!).filter((name) => /tileset\.json$/.test(name)).length).toBeGreaterThan(0);
  else expect([made, faultOf(outcome).text.length > 0]).toEqual([null, true]);
});

describe("an export", () => {
  /** A controller whose command only ends like this. */
  const controller = (outcome: Outcome) =>
    new Controller({ run: async () => outcome, isRunning: () => false, cancel: () => undefined } as unknown as Jobs<LaneName>, block, () => undefined);
  const ended = (exit: number, outputs: Outcome["outputs"]): Outcome => ({ exit, stdout: "", stderr: "chordal: block.star: no levels of this\n", outputs });

  test("has the command's outputs if it succeeded", async () => {
    const outputs = { "tiles/tileset.json": text("{}") };
    const control = controller(ended(0, outputs));
    expect(await exportLine(control, ["lod", "block.star", "-o", "tiles/"], "tiles.zip")).toBe(outputs);
    expect(control.state.exported).toEqual({ state: "written", name: "tiles.zip", bytes: 2 });
  });
  test("ignores the outputs of a failed run, and shows the command's message", async () => {
    for (const exit of [1, 2, 3, 4, 5]) {
      const control = controller(ended(exit, { "tiles/.chordal.lock": new Uint8Array() }));
      expect(await exportLine(control, ["lod", "block.star", "-o", "tiles/"], "tiles.zip")).toBeNull();
      expect(control.state.exported).toMatchObject({ state: "failed", fault: { text: expect.stringContaining("no levels of this") } });
    }
  });
  /** A controller whose mesh is proved. */
  const proved = (outcome: Outcome, frame = { up: null, metres_per_unit: null } as Certificate["frame"]) => {
    const lines: string[][] = [];
    const jobs = { run: async (_: LaneName, words: string[]) => (lines.push(words), outcome), isRunning: () => false, cancel: () => undefined };
    const control = new Controller(jobs as unknown as Jobs<LaneName>, block, () => undefined);
    const certificate = { frame, bound: null, output: null, valid: null, budget: null, notes: [] };
    const shown = { bench: block, parts: [], certificate, bytes: text("glTF"), seconds: 1, isDraft: false, isShort: false, leftOut: [] };
    control.store.state = { ...control.state, shown, ended: block };
    return { control, lines };
  };

  test("of the mesh is that mesh, and is converted from it for other formats", async () => {
    const { control, lines } = proved(ended(0, { "block.stl": text("solid") }));
    expect(await exportMesh(control, "glb")).toEqual({ "block.glb": text("glTF") });
    expect(lines).toEqual([]);
    expect(await exportMesh(control, "stl")).toEqual({ "block.stl": text("solid") });
    expect(lines).toEqual([["convert", "block.glb", "block.stl", "--keep-certificate"]]);
    // In a GLB such a shape is turned and scaled, so it is meshed for the format.
    const other = proved(ended(0, { "block.stl": text("solid") }), { up: "z", metres_per_unit: 0.001 });
    await exportMesh(other.control, "stl");
    expect(other.lines[0]!.slice(0, 2)).toEqual(["mesh", "block.star"]);
  });
  test("of the mesh is a sentence and no file if the command fails, writes nothing, or writes an empty file", async () => {
    for (const format of MESH_FORMATS.filter((one) => one !== "glb")) {
      const bad = [1, 2, 3, 4, 5].map((exit) => ended(exit, { [`block.${format}`]: text("half") }));
      for (const outcome of [...bad, ended(0, {}), ended(0, { [`block.${format}`]: new Uint8Array() })]) {
        const { control } = proved(outcome);
        expect(await exportMesh(control, format)).toBeNull();
        expect(control.state.exported).toMatchObject({ state: "failed", name: `block.${format}`, fault: { text: expect.stringMatching(/.{10}/) } });
      }
    }
  });
  test("without a proved mesh says so", async () => {
    const { control } = proved(ended(0, {}));
    control.store.state = { ...control.state, shown: { ...control.state.shown!, isDraft: true } };
    expect(await exportMesh(control, "glb")).toBeNull();
    expect(control.state.exported).toEqual({ state: "failed", name: "block.glb", fault: null });
  });
  test("of a shape that changes before it is proved says that, and writes nothing", async () => {
    const { control } = proved(ended(0, {}));
    control.store.state = { ...control.state, shown: null, ended: null };
    const made = exportMesh(control, "stl");
    control.put(withText(block, "sphere(1)"));
    expect(await made).toBeNull();
    expect(control.state.exported).toEqual({ state: "failed", name: "block.stl", fault: null, isChanged: true });
  });
  test("is the best mesh for a missed budget only if the line asks for it", async () => {
    const outputs = { "block.glb": text("best") };
    const line = ["mesh", "block.star", "-o", "block.glb", "--keep-best"];
    expect(await exportLine(controller(ended(5, outputs)), line, "block.glb")).toBe(outputs);
    expect(await exportLine(controller(ended(4, outputs)), line, "block.glb")).toBeNull();
    expect(await exportLine(controller(ended(5, outputs)), line.slice(0, -1), "block.glb")).toBeNull();
  });
});
