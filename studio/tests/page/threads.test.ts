// The command on several threads, in a page whose host isolates it; and on one in a page whose host does not.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { readFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { extname, join } from "node:path";
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, test, vi } from "vitest";
import { build } from "vite";
import { ROOT, Site } from "./site";
import { PATIENCE, small } from "./workbench_page";

vi.setConfig(PATIENCE);

const BUILT = join(ROOT, "node_modules/.threads-page");
const EXAMPLES = join(ROOT, "../examples");
const COMMAND = process.env["CHORDAL"] ?? join(ROOT, "../target/release/chordal");
const TYPES: Record<string, string> = { ".html": "text/html", ".js": "text/javascript" };
/** What the server of `chordal studio` says. */
const ISOLATED = { "cross-origin-opener-policy": "same-origin", "cross-origin-embedder-policy": "require-corp" };

let site: Site;
let folder: string;
beforeAll(async () => {
  folder = mkdtempSync(join(tmpdir(), "chordal-threads-"));
  const root = join(ROOT, "tests/page/threads_page");
  await build({ root, configFile: false, base: "./", logLevel: "warn", worker: { format: "es" }, build: { outDir: BUILT, emptyOutDir: true, target: "es2022", modulePreload: false } });
  site = await Site.open();
}, 120_000);
afterAll(async () => {
  await site?.close();
  rmSync(folder, { recursive: true });
});

/** A page on a machine of so many cores. */
async function opened(cores: number, headers: Record<string, string>): Promise<Page> {
  const { page } = await site.visit("threads/index.html", {
    prepare: async (page) => {
      await page.addInitScript((cores) => Object.defineProperty(navigator, "hardwareConcurrency", { value: cores }), cores);
      await page.route("**/threads/**", async (route) => {
        const name = new URL(route.request().url()).pathname.split("/threads/")[1]!;
        await route.fulfill({ body: await readFile(join(BUILT, name)), contentType: TYPES[extname(name)] ?? "application/octet-stream", headers });
      });
    },
  });
  await page.waitForFunction(() => "ran" in window);
  return page;
}

const base64 = (name: string) => readFileSync(join(EXAMPLES, name), "base64");

/** A script to a mesh with its proof, levels, a volume, a mesh of that: lines whose last word is the file that they write, and which one may read after the other. */
const LINES = [
  ["mesh", "bracket.star", "--tol", "1%", "-o", "mesh.glb"],
  ["lod", "teapot.bpt", "--px", "4", "-o", "levels.glb"],
  ["bake", "block.star", "--cells", "24", "--bound", "-o", "volume.nrrd"],
  ["mesh", "volume.nrrd", "--iso", "0", "--tol", "4%", "-o", "volume.glb"],
];
const READ = ["bracket.star", "teapot.bpt", "block.star"];

/** The files that the command writes outside of a browser. */
function native(): Record<string, string> {
  for (const name of READ) writeFileSync(join(folder, name), readFileSync(join(EXAMPLES, name)));
  return Object.fromEntries(
    LINES.map((line) => {
      execFileSync(COMMAND, [...line, "--force", "-q"], { cwd: folder });
      return [line.at(-1)!, readFileSync(join(folder, line.at(-1)!), "base64")];
    }),
  );
}

describe("the same bytes as those of the command", () => {
  let wanted: Record<string, string>;
  beforeAll(() => {
    wanted = native();
  });
  // Of a job: its own and those that it started.
  test.each([
    { isolated: true, cores: 1, threads: 1 },
    { isolated: true, cores: 2, threads: 2 },
    { isolated: true, cores: 4, threads: 4 },
    { isolated: false, cores: 4, threads: 1 },
  ])("on $threads threads: isolated $isolated, cores $cores", async ({ isolated, cores, threads }) => {
    const page = await opened(cores, isolated ? ISOLATED : {});
    expect(await page.evaluate(() => crossOriginIsolated)).toBe(isolated);
    const files = Object.fromEntries(READ.map((name) => [name, base64(name)]));
    for (const line of LINES) {
      const output = line.at(-1)!;
      const { exit, stderr, stdout, outputs, started } = await page.evaluate(([line, files]) => ran([...line, "--json"], files), [line, files] as const);
      expect(exit, stderr).toBe(0);
      expect(JSON.parse(stdout).run.threads, output).toBe(threads);
      expect(started, output).toBe(threads - 1);
      // `toBe` of long texts takes seconds to say how they differ.
      expect(outputs[output] === wanted[output], output).toBe(true);
      files[output] = outputs[output]!;
    }
    await page.context().close();
  });
});

/**
 * A module whose first thread starts another and waits for ever, and whose other thread traps:
 *
 *   (import "wasi" "thread-spawn" (func $spawn (param i32) (result i32)))
 *   (import "env" "memory" (memory 1 65536 shared))
 *   (func (export "_start") (drop (call $spawn (i32.const 0)))
 *     (drop (memory.atomic.wait32 (i32.const 0) (i32.const 0) (i64.const -1))))
 *   (func (export "wasi_thread_start") (param i32 i32) unreachable)
 */
function trappingThread(): Buffer {
  const name = (of: string) => [of.length, ...Buffer.from(of)];
  const section = (id: number, ...content: number[]) => [id, content.length, ...content];
  return Buffer.from([
    ...[0, 0x61, 0x73, 0x6d, 1, 0, 0, 0],
    ...section(1, 3, ...[0x60, 1, 0x7f, 1, 0x7f], ...[0x60, 0, 0], ...[0x60, 2, 0x7f, 0x7f, 0]),
    ...section(2, 2, ...name("wasi"), ...name("thread-spawn"), 0, 0, ...name("env"), ...name("memory"), 2, 3, 1, 0x80, 0x80, 4),
    ...section(3, 2, 1, 2),
    ...section(7, 3, ...name("_start"), 0, 1, ...name("wasi_thread_start"), 0, 2, ...name("memory"), 2, 0),
    ...section(10, 2, ...[18, 0, 0x41, 0, 0x10, 0, 0x1a, 0x41, 0, 0x41, 0, 0x42, 0x7f, 0xfe, 1, 2, 0, 0x1a, 0x0b], ...[3, 0, 0, 0x0b]),
  ]);
}

test("a thread that traps ends its run as a failure, though the run waits for it", async () => {
  const page = await opened(2, ISOLATED);
  expect(await page.evaluate((module) => ended(module), trappingThread().toString("base64"))).toMatch(/^trapped: .*unreachable/);
  await page.context().close();
});

test("a run is cancelled with its threads, and the next one has new ones", async () => {
  const page = await opened(2, ISOLATED);
  const files = { "bracket.star": base64("bracket.star") };
  expect(await page.evaluate((files) => cancelled(["mesh", "bracket.star", "--tol", "0.1%", "-o", "a.glb", "--json"], files), files)).toBe("cancelled");
  const { exit, started } = await page.evaluate((files) => ran(["mesh", "bracket.star", "--tol", "2%", "-o", "a.glb", "--json"], files), files);
  expect([exit, started]).toEqual([0, 1]);
  await page.context().close();
});

test.each([
  { isolated: true, threads: 3 },
  { isolated: false, threads: 0 },
])("the workbench proves with $threads threads beside a run's own: isolated $isolated", async ({ isolated, threads }) => {
  // For every file, the workers' own among them.
  site.instead.headers = isolated ? ISOLATED : {};
  const { page, errors } = await site.visit(await small(), {
    prepare: (page) =>
      page.addInitScript(() => {
        Object.defineProperty(navigator, "hardwareConcurrency", { value: 4 });
        const lent: Record<string, number> = {};
        Object.assign(window, { lent });
        const { postMessage } = Worker.prototype;
        Worker.prototype.postMessage = function (order: { words?: string[]; crew?: { count: number } }) {
          if (order.words) lent[order.words[0]!] = Math.max(lent[order.words[0]!] ?? 0, order.crew?.count ?? 0);
          return postMessage.call(this, order);
        };
      }),
  });
  await page.locator(".certificate .big.proved").waitFor({ state: "attached" });
  expect(await page.evaluate(() => (window as unknown as { lent: Record<string, number> }).lent["mesh"])).toBe(threads);
  expect(errors).toEqual([]);
  await page.context().close();
});
