// Runs the workbench: reads the address, loads the command when it is first needed, draws at most once a frame.
import { render } from "preact";
import { commandJobs } from "../core/command_module";
import { browserDrawer } from "../core/drawer";
import { keptShape } from "../core/kept_shape";
import { App } from "./App";
import { loadSentences } from "./command_zh";
import { Controller } from "./controller";
import { Cupboard } from "./cupboard";
import { example } from "./examples";
import { unpack } from "./share";
import { Shelf, storage } from "./shelf";
import { THREADED } from "./state";
import type { Language } from "./texts";

const root = document.getElementById("app")!;
const language: Language = document.documentElement.lang.startsWith("zh") ? "zh" : "en";

let control: Controller;
let shelf: Shelf;
let frame = 0;
let writtenLink: string | null = null;

function draw(): void {
  frame = 0;
  shelf.follow(control.state.bench);
  // What nobody has changed, such as an example, is found where it was.
  if (control.state.past.length > 0) shelf.note(control.state.bench);
  render(<App language={language} state={control.state} control={control} />, root);
  const { bench, ended, link, running, isWaiting } = control.state;
  // Until a new link is ready the address keeps the old one; a bench that is too large for a link clears it.
  if (link !== writtenLink && !isWaiting) {
    writtenLink = link;
    history.replaceState(null, "", location.pathname + location.search + (link ? `#s=${link}` : ""));
  }
  const html = document.documentElement;
  html.dataset["ready"] = "1";
  // For programs that drive the page.
  if (running.length === 0 && !isWaiting && ended === bench) html.dataset["settled"] = "1";
  else delete html.dataset["settled"];
}

/** The files that were given to `chordal studio FILE`, or the shape that the lesson keeps. */
async function filesOfAddress(): Promise<File[]> {
  const search = new URLSearchParams(location.search);
  const own = search.has("own") ? await keptShape() : null;
  // The shape comes first: the others are those to which it refers.
  if (own) return [own.name, ...Object.keys(own.files).filter((name) => name !== own.name)].map((name) => new File([own.files[name] as BlobPart], name));
  const names = search.getAll("open");
  const fetched = names.map(async (name, number) => {
    const response = await fetch(`opened/${number}`);
    return response.ok ? [new File([await response.blob()], name)] : [];
  });
  return (await Promise.all(fetched)).flat();
}

async function begin(): Promise<void> {
  // Without them errors stay English.
  const sentences = language === "zh" ? loadSentences().catch(() => undefined) : undefined;
  const encoded = /^#s=([\w-]+)$/.exec(location.hash)?.[1];
  const shared = encoded ? await unpack(encoded) : null;
  const opened = await filesOfAddress();
  await sentences;
  const redraw = () => {
    frame ||= requestAnimationFrame(draw);
  };
  shelf = new Shelf(storage(), redraw);
  // A shared script is shown and not kept, unless it is one of the shelf's, as after a reload.
  const first = shared ? shelf.known(shared) : (shelf.last() ?? shelf.unkept() ?? example("bracket"));
  control = new Controller(commandJobs(THREADED), first, redraw);
  control.shelf = shelf;
  control.cupboard = new Cupboard(browserDrawer("chordal", "files"));
  root.replaceChildren();
  // If the address has a link, it contains the changes since the command opened the file, so the link wins.
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
  const encoded = /^#s=([\w-]+)$/.exec(location.hash)?.[1];
  if (!encoded || encoded === writtenLink) return;
  void unpack(encoded).then((bench) => (bench ? control.put(bench) : control.say("damaged")));
});

void begin();
