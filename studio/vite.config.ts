// How the page is built and tested. Nothing is inlined, so that a strict content security policy holds everywhere; all
// addresses are relative, so that the files work under any path of any host.
import type { Plugin } from "vite";
import { defineConfig } from "vitest/config";
import { teapot } from "./scripts/teapot.mjs";
import { thumbnails } from "./scripts/thumbnails.mjs";

/** Tests of a folder that drive a browser, so many files at a time. */
const inBrowser = (name: string, maxWorkers: number, retry = 0) => ({
  extends: true as const,
  test: {
    name,
    include: [`tests/${name}/*.test.ts`],
    maxWorkers,
    retry,
    testTimeout: 60_000,
    hookTimeout: 60_000,
    // What a page shows at once on a machine of its own.
    expect: { poll: { timeout: 20_000 } },
  },
});

/** What every page asks for: its colours before anything is drawn, and to be kept after everything else. */
const everywhere: Plugin = {
  name: "everywhere",
  transformIndexHtml: {
    order: "pre",
    handler: (html) => html.replace("<title>", '<script src="/theme.js"></script>\n    <script src="/offline.js" defer></script>\n    <title>'),
  },
};

export default defineConfig({
  base: "./",
  plugins: [everywhere, teapot(), thumbnails()],
  build: {
    outDir: "dist/page",
    emptyOutDir: true,
    target: "es2022",
    assetsInlineLimit: 0,
    modulePreload: false,
    reportCompressedSize: false,
    // three.js is 570 kB in one piece, and only figures in space load it.
    chunkSizeWarningLimit: 700,
    // exhibit.html, lesson.html and workbench.html are moulds: scripts/build.mjs writes a page for each exhibit and language.
    rollupOptions: { input: ["index.html", "zh.html", "exhibit.html", "lesson.html", "workbench.html"] },
  },
  worker: { format: "es" },
  test: {
    projects: [
      // Some ask the core for a second of work, which a busy machine makes ten of.
      { extends: true, test: { name: "unit", include: ["tests/unit/*.test.ts"], testTimeout: 30_000 } },
      // Two wait for frames and for hands at rest: three keep two cores busy. One that fails beside the others is tried once
      // more, which the report shows: hands and frames are late on a machine that others use.
      inBrowser("page", 3, 1),
      inBrowser("bench", 1),
    ],
  },
});
