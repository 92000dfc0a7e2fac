// One shape with its files that this browser keeps for the pages of the studio: bytes of any length, for which local storage is
// no place. Nothing is sent anywhere.
import type { Files } from "./command";

export interface KeptShape {
  /** The file's name. */
  name: string;
  /** All files by name, among them the shape's. */
  files: Files;
}

const DATABASE = "chordal.own";
const STORE = "shape";
/** There is one. */
const KEY = "the one";

/** Keeps a shape in place of the last one, or none. Returns whether the browser did. */
export const keepShape = (shape: KeptShape | null): Promise<boolean> =>
  request("readwrite", (store) => (shape ? store.put(shape, KEY) : store.delete(KEY))).then(
    () => true,
    () => false,
  );

/** The shape that is kept; `null` if there is none, or the browser refuses. */
export const keptShape = (): Promise<KeptShape | null> =>
  request("readonly", (store) => store.get(KEY)).then(
    (found) => (isShape(found) ? found : null),
    () => null,
  );

function isShape(value: unknown): value is KeptShape {
  const { name, files } = (value ?? {}) as Partial<KeptShape>;
  return typeof name === "string" && files?.[name] instanceof Uint8Array;
}

/** Asks the store, which is made if it is not there. Rejects if the browser has none, as in some private windows, or no room. */
async function request(mode: IDBTransactionMode, ask: (store: IDBObjectStore) => IDBRequest): Promise<unknown> {
  const opening = indexedDB.open(DATABASE, 1);
  opening.onupgradeneeded = () => opening.result.createObjectStore(STORE);
  const database = await new Promise<IDBDatabase>((resolve, reject) => {
    opening.onsuccess = () => resolve(opening.result);
    opening.onerror = opening.onblocked = () => reject(opening.error);
  });
  try {
    const transaction = database.transaction(STORE, mode);
    const asked = ask(transaction.objectStore(STORE));
    await new Promise((resolve, reject) => {
      // Only then it is on the disk.
      transaction.oncomplete = resolve;
      transaction.onerror = transaction.onabort = () => reject(transaction.error);
    });
    return asked.result;
  } finally {
    database.close();
  }
}
