// Keeps what was visited for when there is no network. Files below assets/ have their contents in their name, so a kept one is
// never old; pages and the few other files come from the network as long as there is one.
//
// scripts/build.mjs writes the two lines below: a version that changes with any file, and the names of files in assets/.
const VERSION = "none";
const ASSETS = [];

const PREFIX = "chordal ";
const CACHE = PREFIX + VERSION;
/** Where the pages lie, on any host and below any path. */
const HOME = new URL("./", self.location.href);
const NAMES = new Set(ASSETS);
/** Scripts beside the pages, without a hash in their name. */
const BESIDE = ["language.js", "offline.js", "theme.js"];

/** A page that was not visited and cannot be had. */
const AWAY = `<!doctype html><meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>Chordal</title>
<p>There is no network, and this page was not visited before. <a href="index.html">The first page</a></p>
<p lang="zh-CN">没有网络，此页也未曾访问过。<a href="zh.html">首页</a></p>`;

/** An address without what a page keeps behind it; a folder is its index. Nothing for addresses of others. */
function fileOf(address) {
  const url = new URL(address, HOME);
  if (url.origin !== HOME.origin || !url.pathname.startsWith(HOME.pathname)) return undefined;
  const name = url.pathname.slice(HOME.pathname.length) || "index.html";
  // Some hosts leave the ending away.
  const file = /\./.test(name) ? name : `${name}.html`;
  return /^(?:assets\/)?[\w.-]+\.(?:html|js|css|wasm|bin|svg)$/.test(file) ? file : undefined;
}

const addressOf = (file) => new URL(file, HOME).href;
const isAsset = (file) => file.startsWith("assets/");

/** Whether it is whole, and the host lets it be kept. */
function mayBeKept({ ok, type, headers }) {
  return ok && (type === "basic" || type === "default") && !/no-store/i.test(headers.get("cache-control") ?? "");
}

/** The same answer twice: one for whoever asked, one that is kept by and by. */
function keep(file, response) {
  if (!mayBeKept(response)) return Promise.resolve();
  const { headers, status } = response;
  const copy = response.clone();
  const put = async () => {
    // Where a page is asked for, a redirected answer is refused.
    const kept = copy.redirected ? new Response(await copy.blob(), { headers, status }) : copy;
    await (await caches.open(CACHE)).put(addressOf(file), kept);
  };
  // Where there is no more room the page works as without this.
  return put().catch(() => undefined);
}

/** From the network, and kept; else what was kept. */
async function newest(request, file, meanwhile) {
  try {
    const response = await fetch(request);
    meanwhile(keep(file, response));
    return response;
  } catch (error) {
    const kept = await (await caches.open(CACHE)).match(addressOf(file));
    if (kept) return kept;
    if (request.mode !== "navigate") throw error;
    return new Response(AWAY, { status: 503, headers: { "content-type": "text/html; charset=utf-8" } });
  }
}

/** What was kept, be it by an older version, for the name says the contents; else from the network. */
async function same(request, file, meanwhile) {
  const kept = await (await caches.open(CACHE)).match(addressOf(file));
  if (kept) return kept;
  const response = (await caches.match(addressOf(file))) ?? (await fetch(request));
  meanwhile(keep(file, response));
  return response;
}

/**
 * Keeps a file and whatever it names, and that as well: a page's scripts, workers and styles. The modules that it loads are
 * named by the page alone: the worker of the exhibits names all of theirs.
 */
async function keepAll(file, done = new Set()) {
  if (done.has(file)) return;
  done.add(file);
  const keeping = [];
  const response = await (isAsset(file) ? same : newest)(new Request(addressOf(file)), file, (work) => keeping.push(work));
  if (/\.(?:html|js)$/.test(file) && response.ok) {
    const names = file.endsWith(".html") ? /[\w.-]+\.(?:js|css|wasm)\b/g : /[\w.-]+\.(?:js|css)\b/g;
    const words = new Set((await response.text()).match(names) ?? []);
    const named = [...words].flatMap((word) => (NAMES.has(word) ? `assets/${word}` : BESIDE.includes(word) ? word : []));
    keeping.push(...named.map((other) => keepAll(other, done)));
  }
  await Promise.all(keeping);
}

/** A new version keeps the pages of the one before, as they are now, and then nothing of it. */
async function takeOver() {
  const old = (await caches.keys()).filter((name) => name.startsWith(PREFIX) && name !== CACHE);
  for (const name of old) {
    const requests = await (await caches.open(name)).keys();
    const pages = requests.map(({ url }) => fileOf(url)).filter((file) => file?.endsWith(".html"));
    // What is the same is copied from the old cache, which is left where the network fails.
    const kept = await Promise.all(pages.map((file) => keepAll(file).then(() => true, () => false)));
    if (kept.every(Boolean)) await caches.delete(name);
  }
  await self.clients.claim();
}
self.addEventListener("activate", (event) => event.waitUntil(takeOver()));

/** The first page that one visits is there before this is: it says so. */
self.addEventListener("message", (event) => {
  const file = typeof event.data?.visited === "string" ? fileOf(event.data.visited) : undefined;
  if (file) event.waitUntil(keepAll(file).then(() => event.source?.postMessage({ kept: file }), () => undefined));
});

self.addEventListener("fetch", (event) => {
  const { request } = event;
  const file = request.method === "GET" ? fileOf(request.url) : undefined;
  if (!file || file === "service-worker.js") return;
  event.respondWith((isAsset(file) ? same : newest)(request, file, (work) => event.waitUntil(work)));
});
