// Brings the workbench to life: reads the address, loads the command when it is first needed, draws at most once a frame.
import { render } from "preact";
import { App } from "./App";
import { Controller } from "./controller";
import { example } from "./examples";
import { Jobs, type WorkerLike } from "./jobs";
import { unpack } from "./share";
import type { Language } from "./texts";

const file = new URL("../../wasm/command.wasm", import.meta.url);
const root = document.getElementById("app")!;
const language: Language = document.documentElement.lang.startsWith("zh") ? "zh" : "en";

let compiled: Promise<WebAssembly.Module> | undefined;
/** Compiled once; a failure is not remembered, so that a next try may succeed. */
function module(): Promise<WebAssembly.Module> {
  compiled ??= fetch(file).then(async (response) => {
    if (!response.ok) throw new Error(`${response.status}`);
    // Not compileStreaming: that insists on a media type which some hosts do not send.
    return WebAssembly.compile(await response.arrayBuffer());
  });
  compiled.catch(() => (compiled = undefined));
  return compiled;
}

const worker = (): WorkerLike => new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });

let control: Controller;
let frame = 0;
let written: string | null = null;

function draw(): void {
  frame = 0;
  render(<App language={language} state={control.state} control={control} />, root);
  const { bench, ended, link, running, isWaiting } = control.state;
  // While a link is made the old one stays; what has none leaves none.
  if (link !== written && !isWaiting) {
    written = link;
    history.replaceState(null, "", location.pathname + location.search + (link ? `#s=${link}` : ""));
  }
  const html = document.documentElement;
  html.dataset["ready"] = "1";
  // For whoever drives the page by program.
  if (running.length === 0 && !isWaiting && ended === bench) html.dataset["settled"] = "1";
  else delete html.dataset["settled"];
}

/** What `chordal studio FILE` has put on the bench. */
async function filesOfCommand(): Promise<File[]> {
  const names = new URLSearchParams(location.search).getAll("open");
  const fetched = names.map(async (name, number) => {
    const response = await fetch(`opened/${number}`);
    return response.ok ? [new File([await response.blob()], name)] : [];
  });
  return (await Promise.all(fetched)).flat();
}

async function begin(): Promise<void> {
  const coded = /^#s=([\w-]+)$/.exec(location.hash)?.[1];
  const shared = coded ? await unpack(coded) : null;
  const opened = await filesOfCommand();
  control = new Controller(new Jobs(module, worker), shared ?? example("bracket"), () => {
    frame ||= requestAnimationFrame(draw);
  });
  root.replaceChildren();
  // What was changed since the command opened a file is in the address.
  const isOpen = opened.length > 0 && !shared && (await control.open(opened));
  if (!isOpen) {
    const { notice } = control.state;
    control.start();
    if (notice) control.say(notice);
  }
  if (location.hash && !shared) control.say("damaged");
  draw();
}

addEventListener("hashchange", () => {
  const coded = /^#s=([\w-]+)$/.exec(location.hash)?.[1];
  if (!coded || coded === written) return;
  void unpack(coded).then((bench) => (bench ? control.put(bench) : control.say("damaged")));
});

void begin();
