// After everything else: asks for the worker that keeps what was visited for when there is no network. Not in a frame, and not
// where the host wants nothing kept, as `chordal studio` does: its pages are for who holds the cookie, as long as it runs.
(async () => {
  const { serviceWorker } = navigator;
  const isFrame = window !== window.top || new URLSearchParams(location.search).get("embed") === "1";
  if (!serviceWorker || !window.isSecureContext || isFrame) return;
  if (document.readyState !== "complete") await new Promise((done) => addEventListener("load", done, { once: true }));
  const file = "service-worker.js";
  const said = await fetch(file);
  if (!said.ok || /no-store/i.test(said.headers.get("cache-control") ?? "")) return;
  serviceWorker.addEventListener("message", ({ data }) => {
    // For whoever drives the page by program: it would be here without a network.
    if (data?.kept) document.documentElement.dataset.offline = "1";
  });
  serviceWorker.startMessages();
  await serviceWorker.register(file, { updateViaCache: "none" });
  (await serviceWorker.ready).active.postMessage({ visited: location.href });
})().catch(() => undefined);
