// A browser and a plain static host for the built page. The host serves it under a path of its own, sends no header that
// a simple host would not send, and lets a test replace a file.
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

/** Whether what `make test` leaves out is asked for. */
export const isLong = process.env["CHORDAL_LONG"] !== undefined;

const TYPES: Record<string, string> = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css" };
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

/** How a page is opened. */
export type Opening = BrowserContextOptions & {
  /** Before its first address. */
  prepare?: (page: Page) => Promise<unknown>;
  /** In a page without a history. */
  isFirst?: true;
};

export class Site {
  /** The visit of `at`, and whether any address can be visited in the same page. */
  private visited: Visit | undefined;
  private isShared = false;
  private constructor(
    readonly browser: Browser,
    private readonly server: Server,
    readonly base: string,
    /** What the host is changed to. */
    readonly instead: Instead,
    /** What every page is prepared with. */
    private readonly prepare: (page: Page) => Promise<unknown>,
  ) {}

  static async open(prepare: (page: Page) => Promise<unknown> = async () => undefined): Promise<Site> {
    const instead: Instead = { files: new Map(), headers: {} };
    const server = createServer((request, response) => void serve(request.url ?? "/", response, instead));
    await new Promise<void>((done) => server.listen(0, "127.0.0.1", done));
    const { port } = server.address() as AddressInfo;
    const executablePath = process.env["CHROMIUM"] ?? "/usr/bin/chromium";
    if (!existsSync(executablePath)) throw new Error(`there is no chromium at ${executablePath}`);
    const browser = await chromium.launch({ executablePath, args: FLAGS });
    return new Site(browser, server, `http://127.0.0.1:${port}/some/where/`, instead, prepare);
  }

  async close(): Promise<void> {
    await this.browser.close();
    this.server.close();
  }

  /** As if the host were not to be reached, until `up`. */
  async down(): Promise<void> {
    const closed = new Promise((done) => this.server.close(done));
    this.server.closeAllConnections();
    await closed;
  }

  async up(): Promise<void> {
    await new Promise<void>((done) => this.server.listen(Number(new URL(this.base).port), "127.0.0.1", done));
  }

  /** A page of its own. Whatever the page logs as an error, or throws, ends up in `errors`. */
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
   * The visit of one test after the other, once it is settled: in the page of the one before unless the browser has to be
   * another one, which takes as long as everything else. What pages store is forgotten.
   */
  async at(address = "", options: Opening = {}): Promise<Visit> {
    const { viewport: _, colorScheme: __, reducedMotion: ___, ...others } = options;
    const isShared = Object.keys(others).length === 0;
    if (this.visited && this.isShared && isShared) {
      const { page, errors } = this.visited;
      await page.evaluate(() => localStorage.clear());
      // Away from the address, for it may be the same but for its fragment.
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
   * As `at`, for what does not depend on how a page was loaded: where the file's page is open, its fragment takes the place of the
   * one before, and with it all of its state. What is tried again is opened.
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

/** Lets a page that was opened be seen in another way. */
export async function seen(page: Page, { viewport, colorScheme, reducedMotion }: Opening): Promise<void> {
  await page.setViewportSize(viewport ?? VIEWPORT);
  await page.emulateMedia({ media: null, colorScheme: colorScheme ?? "light", reducedMotion: reducedMotion ?? "no-preference" });
}

/** Of a page that is opened without further wishes. */
const VIEWPORT = { width: 1200, height: 900 };

export interface Visit {
  page: Page;
  errors: string[];
}

/** Files and headers of the host that are others than those that were built. */
export interface Instead {
  files: Map<string, string>;
  headers: Record<string, string>;
}

async function serve(url: string, response: import("node:http").ServerResponse, instead: Instead): Promise<void> {
  const path = new URL(url, "http://x").pathname.replace(/^\/some\/where\//, "");
  try {
    const body = instead.files.get(path) ?? (await readFile(join(DIST, path === "" ? "index.html" : path)));
    for (const [name, value] of Object.entries(instead.headers)) response.setHeader(name, value);
    // A host that has never heard of WebAssembly.
    response.setHeader("content-type", TYPES[extname(path || "index.html")] ?? "application/octet-stream");
    response.end(body);
  } catch {
    response.statusCode = 404;
    response.end();
  }
}

/** axe as it runs in a page. Its driver for Playwright opens a page of its own for each run, which takes four times as long. */
const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

/** What axe calls serious or critical, as one line each. */
export async function seriousFindings(page: Page): Promise<string[]> {
  if (!(await page.evaluate(() => "axe" in window))) await page.evaluate(AXE);
  return page.evaluate(async () => {
    const run = (window as unknown as { axe: typeof axe }).axe.run;
    const { violations } = await run({ resultTypes: ["violations"] });
    return violations
      .filter(({ impact }) => impact === "serious" || impact === "critical")
      .map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.target.join(" ")).join(", ")}`);
  });
}

/** The full digits behind a number that the page shows. */
export async function digits(page: Page, name: string): Promise<number> {
  return Number(await page.locator(`data[data-name="${name}"]`).first().getAttribute("value"));
}

/** Until the page has drawn the answer to its newest question, and has looked once more at its own size. */
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
