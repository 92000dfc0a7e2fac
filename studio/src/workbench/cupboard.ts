// The files that scripts read, such as fonts, kept in this browser: so that a script that is opened again, or a file that
// carries one, has them without asking. They are found by their contents, or by the script that they were given to.
import type { Files } from "../core/command";
import type { Drawer } from "../core/drawer";
import type { Bench } from "./document";
import { isFont } from "./lack";

/** What is kept, oldest first: the digest and the size of each file. */
type Index = readonly { digest: string; size: number }[];

/** The most bytes of all files; the oldest are dropped. Chosen: some hundred fonts, and little of what browsers give a site. */
export const MOST_KEPT = 64e6;

const INDEX = "index";
const fileKey = (digest: string) => `file ${digest}`;
const nameKey = (scope: string, path: string) => `name ${scope}\n${path}`;
/** A font is the same for all scripts that name it. */
const ANY = "*";

export class Cupboard {
  constructor(
    private readonly drawer: Drawer,
    private readonly digestOf: (bytes: Uint8Array) => Promise<string> = sha256,
  ) {}

  /** Keeps files that were given to a script. A browser that keeps nothing asks again next time. */
  async keep(bench: Bench, given: Files): Promise<void> {
    try {
      for (const [path, bytes] of Object.entries(given)) {
        if (path === bench.name || bytes.length > MOST_KEPT / 2) continue;
        const digest = await this.digestOf(bytes);
        const scopes = [...(bench.kept ? [bench.kept] : []), ...(isFont(path) ? [ANY] : [])];
        if (!scopes.length) continue;
        await this.drawer.set(fileKey(digest), bytes);
        for (const scope of scopes) await this.drawer.set(nameKey(scope, path), digest);
        await this.tidy({ digest, size: bytes.length });
      }
    } catch {
      // Then it is asked for.
    }
  }

  /** A file that a script reads: what it was given before, or the font of that name. */
  async find(bench: Bench, path: string): Promise<Uint8Array | null> {
    for (const scope of [...(bench.kept ? [bench.kept] : []), ...(isFont(path) ? [ANY] : [])]) {
      const digest = await this.read(nameKey(scope, path));
      const found = typeof digest === "string" ? await this.withDigest(digest) : null;
      if (found) return found;
    }
    return null;
  }

  /** The file with these contents. */
  async withDigest(digest: string): Promise<Uint8Array | null> {
    const found = await this.read(fileKey(digest));
    // A copy is as good as the file only if it is the file.
    return found instanceof Uint8Array && (await this.digestOf(found)) === digest ? found : null;
  }

  private read(key: string): Promise<unknown> {
    return this.drawer.get(key).catch(() => undefined);
  }

  /** Notes the newest file, and drops the oldest ones beyond the limit. */
  private async tidy(newest: Index[number]): Promise<void> {
    const known = ((await this.drawer.get(INDEX)) as Index | undefined) ?? [];
    const index = [...known.filter(({ digest }) => digest !== newest.digest), newest];
    let total = index.reduce((sum, { size }) => sum + size, 0);
    while (total > MOST_KEPT) {
      const { digest, size } = index.shift()!;
      await this.drawer.drop(fileKey(digest));
      total -= size;
    }
    await this.drawer.set(INDEX, index);
  }
}

async function sha256(bytes: Uint8Array): Promise<string> {
  const digest = new Uint8Array(await crypto.subtle.digest("SHA-256", bytes as BufferSource));
  return [...digest].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}
