// The shelf: the name of the script, and a dialogue with the scripts that this browser keeps and the examples.
import type { ComponentChildren } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { type Bench, bench, isScript } from "./document";
import { EXAMPLES, PICTURE, example, pictureOf } from "./examples";
import { PANEL_TEXTS } from "./panel_texts";
import { type Kept, MOST, cleaned } from "./shelf";
import { type Saving, choose, remember, save, savesInPlace } from "./star_files";
import { TextField } from "./TextField";
import type { Page } from "./words";

/** A new script, which is a shape at once. */
const BLANK = "box(20, 10, 5)\n";
/** The limit of the shelf, as readers see it. */
const LIMIT = `${MOST / 1e6} MB`;

/** With the buttons that stand beside that of the shelf. */
export function ShelfBar({ page, children }: { page: Page; children: ComponentChildren }) {
  const { state, control, language } = page;
  const words = PANEL_TEXTS[language];
  const dialog = useRef<HTMLDialogElement>(null);
  const [saving, setSaving] = useState<Saving | null>(null);
  const shelf = control?.shelf ?? null;
  const { bench: current } = state;
  const kept = shelf?.of(current);
  const keep = (of: Bench) => {
    const next = shelf!.keep(of);
    if (of === control!.state.bench) control!.adopt(next);
    else control!.put(next);
  };

  const saveIt = async () => {
    if (!shelf || !control || !isScript(control.state.bench)) return;
    if (!shelf.of(control.state.bench)) keep(control.state.bench);
    const script = shelf.of(control.state.bench)!;
    const done = await save(script.id, script.name, script.text);
    setSaving(done);
    if (done === "in-place" || done === "download") shelf.savedToFile(script.id, script.text);
  };
  const saveNow = useRef(saveIt);
  saveNow.current = saveIt;
  useEffect(() => {
    const key = (event: KeyboardEvent) => {
      if (!(event.ctrlKey || event.metaKey) || event.shiftKey || event.altKey || event.key.toLowerCase() !== "s") return;
      event.preventDefault();
      void saveNow.current();
    };
    addEventListener("keydown", key);
    return () => removeEventListener("keydown", key);
  }, []);
  useEffect(() => setSaving(null), [kept?.id, kept?.text]);

  const place = kept ? (kept.saved === kept.text ? words.isSaved : words.isInBrowser) : words.isNotKept;
  return (
    <div class="shelf-bar">
      <div class="row tight">
        <button type="button" data-shelf="open" onClick={() => dialog.current?.showModal()}>
          {words.shelf}
        </button>
        {children}
      </div>
      {isScript(current) && (
        <div class="row tight shelf-script">
          {kept ? (
            <>
              <label class="field shelf-name">
                {words.scriptName}
                <TextField
                  value={kept.name}
                  maxLength={60}
                  enter={(name) => {
                    const renamed = shelf!.rename(kept.id, name);
                    if (renamed) control?.adopt(renamed);
                  }}
                />
              </label>
              <button type="button" data-shelf="save" title={savesInPlace() ? words.saveInPlace : words.saveDownload} onClick={() => void saveIt()}>
                {words.save}
              </button>
            </>
          ) : (
            <>
              <b class="shelf-name">{current.name}</b>
              <button type="button" data-shelf="keep" onClick={() => keep(current)}>
                {words.keep}
              </button>
            </>
          )}
          <p class="aside shelf-place" role="status">
            {kept && kept.saved !== kept.text && <span aria-hidden="true">● </span>}
            {saving === "refused" ? words.saveRefused : place}
          </p>
        </div>
      )}
      {shelf?.state.fault && (
        <p class="fault" role="alert">
          {words.shelfFaults[shelf.state.fault](LIMIT)}
        </p>
      )}
      <dialog ref={dialog} class="shelf" aria-label={words.shelf} onClick={(event) => event.target === event.currentTarget && event.currentTarget.close()}>
        <Contents page={page} close={() => dialog.current?.close()} keep={keep} />
      </dialog>
    </div>
  );
}

function Contents({ page, close, keep }: { page: Page; close(): void; keep(of: Bench): void }) {
  const { state, control, language, say } = page;
  const words = PANEL_TEXTS[language];
  const shelf = control?.shelf ?? null;
  const scripts = shelf?.state.scripts ?? [];
  const openId = state.bench.kept;
  const put = (next: Bench) => {
    control?.put(next);
    close();
  };
  const openFile = async () => {
    const chosen = await choose();
    if (chosen === undefined) return document.querySelector<HTMLInputElement>(".inputs input[type=file]")?.click();
    if (!chosen || !shelf) return;
    const text = await chosen.file.text();
    const name = `${cleaned(chosen.file.name) || "script"}.star`;
    const next = shelf.keep(bench(name, { [name]: new TextEncoder().encode(text) }), text);
    remember(next.kept!, chosen.handle);
    put(next);
  };
  return (
    <>
      <div class="row tight shelf-head">
        <h2>{words.shelf}</h2>
        <button type="button" onClick={close}>
          {words.close}
        </button>
      </div>
      <div class="row tight">
        <button
          type="button"
          data-shelf="new"
          onClick={() => {
            keep(bench("script.star", { "script.star": new TextEncoder().encode(BLANK) }));
            close();
          }}
        >
          {words.newScript}
        </button>
        <button type="button" onClick={() => void openFile()}>
          {words.openStar}
        </button>
      </div>
      {shelf?.state.deleted && (
        <p role="status">
          {words.deleted(shelf.state.deleted.script.name)}{" "}
          <button type="button" data-shelf="restore" onClick={() => shelf.restore()}>
            {words.restore}
          </button>
        </p>
      )}
      {scripts.length === 0 && <p class="aside">{words.empty}</p>}
      <ul class="shelf-scripts">
        {scripts.map((script: Kept) => (
          <li key={script.id} {...(script.id === openId ? { "aria-current": "true" as const } : {})}>
            <button type="button" class="shelf-title" onClick={() => put(shelf!.benchOf(script))}>
              <b>{script.name}</b>
              <span class="aside">
                {say.bytes(script.text.length)}
                {script.saved !== script.text && ` · ${words.inBrowserOnly}`}
              </span>
            </button>
            <button type="button" aria-label={words.duplicateOf(script.name)} onClick={() => keep(shelf!.benchOf(script))}>
              {words.duplicate}
            </button>
            <button type="button" aria-label={words.deleteOf(script.name)} onClick={() => shelf!.remove(script.id)}>
              {words.delete}
            </button>
          </li>
        ))}
      </ul>
      <p class="aside">{words.shelfLimit(LIMIT)}</p>
      <h2>{words.examplesTitle}</h2>
      <ul class="shelf-examples">
        {EXAMPLES.map((name) => (
          <li key={name}>
            <button type="button" data-example={name} onClick={() => put(example(name))}>
              <img src={pictureOf(name)} {...PICTURE} loading="lazy" alt="" />
              {words.examples[name]}
            </button>
          </li>
        ))}
      </ul>
    </>
  );
}
