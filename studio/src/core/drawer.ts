// What this browser keeps for the pages of the studio by key: bytes of any length, for which local storage is no place. Nothing is
// sent anywhere.

/** The part of a database that is used. */
export interface Drawer {
  get(key: string): Promise<unknown>;
  set(key: string, value: unknown): Promise<void>;
  drop(key: string): Promise<void>;
}

/** A drawer of this browser. Its calls reject if the browser has none, as in some private windows, or no room. */
export function browserDrawer(database: string, store: string): Drawer {
  const ask = (mode: IDBTransactionMode, what: (of: IDBObjectStore) => IDBRequest) => request(database, store, mode, what);
  return {
    get: (key) => ask("readonly", (of) => of.get(key)),
    set: async (key, value) => void (await ask("readwrite", (of) => of.put(value, key))),
    drop: async (key) => void (await ask("readwrite", (of) => of.delete(key))),
  };
}

/** Asks the store, which is made if it is not there. */
async function request(name: string, store: string, mode: IDBTransactionMode, ask: (store: IDBObjectStore) => IDBRequest): Promise<unknown> {
  const opening = indexedDB.open(name, 1);
  opening.onupgradeneeded = () => opening.result.createObjectStore(store);
  const database = await new Promise<IDBDatabase>((resolve, reject) => {
    opening.onsuccess = () => resolve(opening.result);
    opening.onerror = opening.onblocked = () => reject(opening.error);
  });
  try {
    const transaction = database.transaction(store, mode);
    const asked = ask(transaction.objectStore(store));
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
