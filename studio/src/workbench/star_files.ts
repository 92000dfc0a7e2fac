// Opens and saves `.star` files: in place where the browser gives a page a file (File System Access), else as a download.

/** The parts of the File System Access API that are used; TypeScript's library lacks the pickers. */
interface FileHandle {
  name: string;
  getFile(): Promise<File>;
  createWritable(): Promise<{ write(text: string): Promise<void>; close(): Promise<void> }>;
}
interface Pickers {
  showSaveFilePicker?(options: { suggestedName: string; types: readonly object[] }): Promise<FileHandle>;
  showOpenFilePicker?(options: { types: readonly object[] }): Promise<readonly FileHandle[]>;
}
const pickers = globalThis as Pickers;

const TYPES = [{ description: "Chordal", accept: { "text/plain": [".star"] } }];
/** Long enough for a browser to start the download. */
const KEPT_MS = 60_000;

/** The files of scripts on the shelf, by their id: as long as this page is open. */
const handles = new Map<string, FileHandle>();

export const savesInPlace = (): boolean => typeof pickers.showSaveFilePicker === "function";

/** Remembers the file of a script, so that saving overwrites it. */
export const remember = (id: string, handle: FileHandle | null): void => void (handle ? handles.set(id, handle) : handles.delete(id));

/** How a script was saved: into its file, as a download, not at all since the reader changed their mind, or not at all since the system refused. */
export type Saving = "in-place" | "download" | "left" | "refused";

/** Saves a text: into its file if it has one or the reader chooses one, else as a download. */
export async function save(id: string, name: string, text: string): Promise<Saving> {
  const file = `${name}.star`;
  if (!savesInPlace()) return download(file, text);
  try {
    const handle = handles.get(id) ?? (await pickers.showSaveFilePicker!({ suggestedName: file, types: TYPES }));
    const stream = await handle.createWritable();
    await stream.write(text);
    await stream.close();
    handles.set(id, handle);
    return "in-place";
  } catch (error) {
    if (error instanceof DOMException && error.name === "AbortError") return "left";
    handles.delete(id);
    return "refused";
  }
}

/** Asks for a script; `null` if none was chosen, and `undefined` if this browser has no such dialogue. */
export async function choose(): Promise<{ file: File; handle: FileHandle } | null | undefined> {
  if (!pickers.showOpenFilePicker) return undefined;
  try {
    const [handle] = await pickers.showOpenFilePicker({ types: TYPES });
    return handle ? { file: await handle.getFile(), handle } : null;
  } catch {
    return null;
  }
}

function download(name: string, text: string): "download" {
  const address = URL.createObjectURL(new Blob([text], { type: "text/plain" }));
  Object.assign(document.createElement("a"), { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), KEPT_MS);
  return "download";
}
