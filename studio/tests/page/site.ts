// A browser and a plain static host for the built page. The host serves it below a path, sends no header that a simple host
// would not send, and lets a test replace a file.
import type axe from "axe-core";
import { existsSync, readFileSync } from "node:fs";
import { readFile } from "node:fs/promises";
import { createServer, type Server } from "node:http";
import { createRequire } from "node:module";
import type { AddressInfo } from "node:net";
import { extname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { type Browser, type BrowserContextOptions, type Page, chromium } from "playwright-core";
import { getCurrentTest } from "vitest/suite";

export const ROOT = fileURLToPath(new URL("../..", import.meta.url));
export const DIST = join(ROOT, "dist/page");
export const WASM = join(ROOT, "wasm/chordal.wasm");
export const EXHIBITS_WASM = join(ROOT, "wasm/exhibits.wasm");

/** Whether the cases that `make test` leaves out are run. */
export const isLong = process.env["CHORDAL_LONG"] !== undefined;

const TYPES: Record<string, string> = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml" };
const FLAGS = [
  "--headless",
  "--no-sandbox",
  "--disable-gpu",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  "--enable-unsafe-swiftshader",
];

/** `CHROMIUM_FLAGS` has what a browser needs besides to find its card, such as `--use-angle=vulkan`. */
const WITH_CARD = ["--enable-gpu", "--ignore-gpu-blocklist", "--disable-gpu-vsync", "--disable-frame-rate-limit", ...(process.env["CHROMIUM_FLAGS"]?.split(" ") ?? [])];

/** How a page is opened. */
export type Opening = BrowserContextOptions & {
  /** Prepares the page before its first address. */
  prepare?: (page: Page) => Promise<unknown>;
  /** Opens a page without a history. */
  isFirst?: true;
};

export class Site {
  /** The current visit of `at`, and whether further addresses can be opened in the same page. */
  private visited: Visit | undefined;
  private isShared = false;
  private constructor(
    readonly browser: Browser,
    private readonly server: Server,
    readonly base: string,
    /** Changes to the host. */
    readonly instead: Instead,
    /** Prepares every page. */
    private readonly prepare: (page: Page) => Promise<unknown>,
  ) {}

  /** `hasCard` lets the browser use a graphics card, as many frames a second as that draws; without one the processor draws. */
  static async open(prepare: (page: Page) => Promise<unknown> = async () => undefined, { hasCard = false } = {}): Promise<Site> {
    const instead: Instead = { files: new Map(), headers: {} };
    const server = createServer((request, response) => void serve(request.url ?? "/", response, instead));
    await new Promise<void>((done) => server.listen(0, "127.0.0.1", done));
    const { port } = server.address() as AddressInfo;
    const executablePath = process.env["CHROMIUM"] ?? "/usr/bin/chromium";
    if (!existsSync(executablePath)) throw new Error(`there is no chromium at ${executablePath}`);
    const browser = await chromium.launch({ executablePath, args: hasCard ? [...FLAGS.filter((flag) => flag !== "--disable-gpu"), ...WITH_CARD] : FLAGS });
    return new Site(browser, server, `http://127.0.0.1:${port}/some/where/`, instead, prepare);
  }

  async close(): Promise<void> {
    await this.browser.close();
    this.server.close();
  }

  /** Makes the host unreachable, until `up`. */
  async down(): Promise<void> {
    const closed = new Promise((done) => this.server.close(done));
    this.server.closeAllConnections();
    await closed;
  }

  async up(): Promise<void> {
    await new Promise<void>((done) => this.server.listen(Number(new URL(this.base).port), "127.0.0.1", done));
  }

  /** Opens a new page. Errors that it logs or throws are added to `errors`. */
  async visit(address = "", options: Opening = {}): Promise<Visit> {
    const { prepare, isFirst: _, ...context } = options;
    const opened = await this.browser.newContext({ viewport: VIEWPORT, locale: "en-GB", bypassCSP: false, serviceWorkers: "block", ...context });
    const page = await opened.newPage();
    const errors: string[] = [];
    page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
    page.on("pageerror", (error) => errors.push(String(error)));
    await this.prepare(page);
    await prepare?.(page);
    await page.goto(this.base + address);
    return { page, errors };
  }

  async ready(address = "", options: Opening = {}): Promise<Visit> {
    const visit = await this.visit(address, options);
    await visit.page.waitForSelector("html[data-ready]");
    return visit;
  }

  /**
   * Opens an address for a test and waits until it is settled: in the page of the previous test unless the browser's settings
   * differ, because a new one takes as long as the rest of a test. The page's storage is cleared.
   */
  async at(address = "", options: Opening = {}): Promise<Visit> {
    const { viewport: _, colorScheme: __, reducedMotion: ___, ...others } = options;
    const isShared = Object.keys(others).length === 0;
    if (this.visited && this.isShared && isShared) {
      const { page, errors } = this.visited;
      await page.evaluate(() => localStorage.clear());
      // Leave the page first: the address may differ only in its fragment.
      await page.goto("about:blank");
      await seen(page, options);
      errors.length = 0;
      await page.goto(this.base + address);
    } else {
      await this.visited?.page.context().close();
      this.visited = undefined;
      this.visited = await this.visit(address, options);
      this.isShared = isShared;
    }
    await this.visited.page.waitForSelector("html[data-ready]");
    await settled(this.visited.page);
    return this.visited;
  }

  /**
   * As `at`, for tests that do not depend on how a page was loaded: if the file's page is open, only its fragment is replaced,
   * and with it its whole state. A retried test opens the page again.
   */
  async on(file: string, fragment: string, options: Opening = {}): Promise<Visit> {
    const { visited } = this;
    const isAgain = (getCurrentTest()?.result?.retryCount ?? 0) > 0;
    const isOpen = visited && this.isShared && new URL(visited.page.url()).href.split("#")[0] === this.base + file;
    if (!isOpen || isAgain) return this.at(file + fragment, options);
    const { page, errors } = visited;
    await seen(page, options);
    errors.length = 0;
    await page.evaluate(async (hash) => {
      if (document.activeElement instanceof HTMLElement) document.activeElement.blur();
      scrollTo(0, 0);
      if (location.hash === hash) return;
      const changed = new Promise((done) => addEventListener("hashchange", done, { once: true }));
      location.hash = hash;
      await changed;
    }, fragment);
    await settled(page);
    return visited;
  }
}

/** Changes the media settings of an open page. */
export async function seen(page: Page, { viewport, colorScheme, reducedMotion }: Opening): Promise<void> {
  await page.setViewportSize(viewport ?? VIEWPORT);
  await page.emulateMedia({ media: null, colorScheme: colorScheme ?? "light", reducedMotion: reducedMotion ?? "no-preference" });
}

/** The settings of a page that is opened without any. */
const VIEWPORT = { width: 1200, height: 900 };

export interface Visit {
  page: Page;
  errors: string[];
}

/** Files and headers of the host that differ from the build. */
export interface Instead {
  files: Map<string, string>;
  headers: Record<string, string>;
}

async function serve(url: string, response: import("node:http").ServerResponse, instead: Instead): Promise<void> {
  const path = new URL(url, "http://x").pathname.replace(/^\/some\/where\//, "");
  try {
    const body = instead.files.get(path) ?? (await readFile(join(DIST, path === "" ? "index.html" : path)));
    for (const [name, value] of Object.entries(instead.headers)) response.setHeader(name, value);
    // As on a host that does not know WebAssembly's media type.
    response.setHeader("content-type", TYPES[extname(path || "index.html")] ?? "application/octet-stream");
    response.end(body);
  } catch {
    response.statusCode = 404;
    response.end();
  }
}

/** Runs axe in the page. Its driver for Playwright opens a new page for each run, which takes four times as long. */
const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

/** The findings of axe, one line each; also whether names of buttons contain what is written on them. */
export async function axeFindings(page: Page): Promise<string[]> {
  if (!(await page.evaluate(() => "axe" in window))) await page.evaluate(AXE);
  return page.evaluate(async () => {
    const run = (window as unknown as { axe: typeof axe }).axe.run;
    const rules = { "label-content-name-mismatch": { enabled: true } };
    const { violations } = await run({ resultTypes: ["violations"], rules });
    return violations.map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.target.join(" ")).join(", ")}`);
  });
}

/** The full digits behind a number that the page shows. */
export async function digits(page: Page, name: string): Promise<number> {
  return Number(await page.locator(`data[data-name="${name}"]`).first().getAttribute("value"));
}

/** Waits until the page shows the answer to its newest question and has measured itself again. */
export async function settled(page: Page): Promise<void> {
  await page.evaluate(async () => {
    const frame = () => new Promise(requestAnimationFrame);
    for (let i = 0; i < 2; i++) {
      await frame();
      do await frame();
      while (!document.documentElement.dataset["settled"]);
    }
  });
}
