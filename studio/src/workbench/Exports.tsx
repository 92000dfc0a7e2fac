// Files to download, and the command, Python or Rust code that makes the same mesh elsewhere.
import { useState } from "preact/hooks";
import type { Files } from "../core/command";
import { Choice } from "../view/parts";
import { Working } from "./Certificate";
import { NO_SCREEN, isDrawing, meshLine, python, reading, readsFiles, rust, shell, stem } from "./document";
import { MESH_FORMATS, exportLine, exportMesh } from "./exports";
import { isBroken, isEmpty } from "./outdated";
import { FaultSaid } from "./Said";
import { PANEL_TEXTS } from "./panel_texts";
import type { Page } from "./words";

const LANGUAGES = ["shell", "python", "rust"] as const;

/** Long enough for a browser to start the download. */
const KEPT_MS = 60_000;

export function Exports({ page }: { page: Page }) {
  const { words, state, control } = page;
  const { bench } = state;
  const [language, setLanguage] = useState<(typeof LANGUAGES)[number]>("shell");
  const [isCopied, setCopied] = useState(false);
  const output = `${stem(bench.name)}.glb`;
  const line = control?.line(output) ?? meshLine(bench, NO_SCREEN, output);
  const screen = control?.sight.screen ?? NO_SCREEN;
  const shownName = line.at(-1)!;
  const text =
    language === "shell" ? shell([...bench.before, line]) : language === "python" ? python(bench, screen, shownName) : rust(bench, screen, shownName);
  // If the command cannot read the input, it cannot write a file either; the certificate shows the error.
  const isDisabled = isBroken(state) || isEmpty(state);
  const save = async (made: Promise<Files | null>, archiveName?: string) => {
    const files = await made;
    if (!files || !control) return;
    try {
      const bytes = await saveAll(files, archiveName);
      // An archive is smaller than what is in it.
      if (control.state.exported?.state === "written") control.change({ exported: { ...control.state.exported, bytes } });
    } catch {
      control.say("trapped");
    }
  };
  const name = stem(bench.name);
  return (
    <section class="export">
      <div class="panel">
        <h2>{words.export}</h2>
        <div class="row tight">
          {MESH_FORMATS.map((format) => (
            <button
              type="button"
              key={format}
              data-export={format}
              disabled={isDisabled}
              onClick={() => void save(exportMesh(control!, format))}
            >
              {format.toUpperCase()}
            </button>
          ))}
          <button
            type="button"
            data-export="tiles"
            disabled={isDisabled}
            onClick={() => void save(exportLine(control!, ["lod", ...reading(bench), "--px", "1", "-o", "tiles/"], `${name}-tiles.zip`), `${name}-tiles.zip`)}
          >
            3D Tiles (.zip)
          </button>
          {isDrawing(bench) && (
            <button
              type="button"
              data-export="svg"
              disabled={isDisabled}
              onClick={() => void save(exportLine(control!, ["convert", ...reading(bench), `${name}-out.svg`], `${name}-out.svg`))}
            >
              SVG
            </button>
          )}
          <button
            type="button"
            data-export="png"
            disabled={isDisabled}
            onClick={() => void save(exportLine(control!, control!.pictureLine(), `${name}.png`))}
          >
            PNG
          </button>
        </div>
        {isDisabled ? <p class="aside">{words.noExport}</p> : <Written page={page} />}
        <Working page={page} lanes={state.exported?.state === "waiting" ? ["export", "proof"] : ["export"]} />
      </div>
      <div class="panel line">
        <Choice
          name="language"
          legend={words.line}
          value={language}
          options={LANGUAGES.map((value) => ({ value, label: { shell: "Shell", python: "Python", rust: "Rust" }[value] }))}
          choose={(next) => setLanguage(next)}
        />
        <pre lang="en" tabIndex={0} aria-label={words.line}>
          <code>{text}</code>
        </pre>
        <button
          type="button"
          onClick={() =>
            void navigator.clipboard?.writeText(text).then(
              () => setCopied(true),
              () => undefined,
            )
          }
        >
          {isCopied ? words.copied : words.copy}
        </button>
        <p class="aside">{!state.link && !state.isWaiting && control ? words.noLink : readsFiles(bench) ? words.shareScript : words.share}</p>
      </div>
    </section>
  );
}

/** What exports are, and what became of the latest one. */
function Written({ page }: { page: Page }) {
  const { say, state, language } = page;
  const words = PANEL_TEXTS[language];
  const { exported } = state;
  if (!exported) return <p class="aside">{words.exportHint}</p>;
  const { name } = exported;
  if (exported.state === "waiting") return <p role="status">{words.exportWaiting(name)}</p>;
  if (exported.state === "written") return <p role="status">{words.exportWritten(name, say.bytes(exported.bytes))}</p>;
  return (
    <p class="fault" role="alert">
      <b>{words.exportFailed(name)}</b> {exported.fault ? <FaultSaid fault={exported.fault} language={language} /> : exported.isChanged ? words.exportChanged : words.exportNoProof}
    </p>
  );
}

/** Saves one file as it is, several or those of a folder in an archive. Returns how many bytes. Rejects if the archive does not fit into memory. */
async function saveAll(files: Files, archiveName?: string): Promise<number> {
  const names = Object.keys(files);
  if (!archiveName && names.length === 1) return save(names[0]!, files[names[0]!]!);
  const worker = new Worker(new URL("./archive.ts", import.meta.url), { type: "module" });
  try {
    const bytes = await new Promise<Uint8Array>((resolve, reject) => {
      worker.onmessage = ({ data }: MessageEvent<Uint8Array>) => resolve(data);
      worker.onerror = reject;
      worker.postMessage(files);
    });
    return save(archiveName ?? `${stem(names[0]!)}.zip`, bytes);
  } finally {
    worker.terminate();
  }
}

function save(name: string, bytes: Uint8Array): number {
  const address = URL.createObjectURL(new Blob([bytes as BlobPart]));
  const link = Object.assign(document.createElement("a"), { href: address, download: name.replace(/^.*\//, "") });
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), KEPT_MS);
  return bytes.length;
}
