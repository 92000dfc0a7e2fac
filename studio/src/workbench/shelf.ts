// The shelf: scripts that this browser keeps, and the one that is open. Everything here is text in local storage; nothing
// is sent anywhere.
import { BUDGET, type Bench, type Budget, bench, isScript, textOf } from "./document";

/** A script on the shelf. */
export interface Kept {
  id: string;
  /** Its name without the ending. */
  name: string;
  text: string;
  set: Readonly<Record<string, string>>;
  budget: Budget;
  options: string;
  /** The text as it was last saved to a file; `null` if it never was. */
  saved: string | null;
}

export interface ShelfState {
  scripts: readonly Kept[];
  /** The script that was on the bench last, if it is kept; it is there again after a reload. */
  open: string | null;
  /** What was deleted last, with its place, for its return. */
  deleted: { script: Kept; at: number } | null;
  /** Why the shelf could not be written, if so. */
  fault: "refused" | "full" | null;
}

/** Where the shelf stands. */
const KEY = "chordal.shelf";
/** Where the script is that was changed last and is not on it. */
const UNKEPT = "chordal.unkept";
/** The most characters of all scripts. Chosen: half of what browsers give one site, so that other pages have room, too. */
export const MOST = 2_000_000;

/** The part of `Storage` that the shelf uses. */
export type Store = Pick<Storage, "getItem" | "setItem">;

const isRecord = (value: unknown): value is Record<string, unknown> => typeof value === "object" && value !== null;

/** The scripts in the storage; none if it is empty, refused, or not the shelf's. */
function read(store: Store | null): { scripts: Kept[]; open: string | null } {
  try {
    const value: unknown = JSON.parse(store?.getItem(KEY) ?? "null");
    if (!isRecord(value) || value["v"] !== 1 || !Array.isArray(value["scripts"])) return { scripts: [], open: null };
    const scripts = value["scripts"].filter(
      (one): one is Kept => isRecord(one) && ["id", "name", "text", "options"].every((key) => typeof one[key] === "string") && isRecord(one["set"]),
    );
    const open = scripts.some(({ id }) => id === value["open"]) ? (value["open"] as string) : null;
    return { scripts: scripts.map((one) => ({ ...one, budget: { ...BUDGET, ...one.budget }, saved: one.saved ?? null })), open };
  } catch {
    return { scripts: [], open: null };
  }
}

/** The name of a file or script, as the shelf shows it. */
export const titleOf = (file: string): string => file.replace(/\.star$/i, "");

/** Letters that a file's name must not have are left out. */
export const cleaned = (name: string): string => titleOf(name.replace(/[/\\:*?"<>|\u0000-\u001f]/g, "").trim().replace(/^[.-]+/, "")).slice(0, 60);

export class Shelf {
  state: ShelfState;

  constructor(
    private readonly store: Store | null,
    private readonly notify: () => void,
    private readonly newId: () => string = () => crypto.randomUUID(),
  ) {
    this.state = { ...read(store), deleted: null, fault: store ? null : "refused" };
  }

  /** The script that a bench is, if it is kept. */
  of({ kept }: Bench): Kept | undefined {
    return kept === undefined ? undefined : this.state.scripts.find(({ id }) => id === kept);
  }

  /** A script as an input of the bench. */
  benchOf({ id, name, text, set, budget, options }: Kept): Bench {
    const file = `${name}.star`;
    return { ...bench(file, { [file]: new TextEncoder().encode(text) }), set, budget, options, kept: id };
  }

  /** The script that was open last. */
  last(): Bench | null {
    const script = this.state.scripts.find(({ id }) => id === this.state.open);
    return script ? this.benchOf(script) : null;
  }

  /** The script that was changed last and not kept: it is there again if the page is opened without an address. */
  unkept(): Bench | null {
    try {
      const value: unknown = JSON.parse(this.store?.getItem(UNKEPT) ?? "null");
      if (!isRecord(value) || ![value["name"], value["text"], value["options"]].every((one) => typeof one === "string") || !isRecord(value["set"])) return null;
      const { name, text, set, budget, options } = value as unknown as Omit<Kept, "id" | "saved">;
      return { ...bench(name, { [name]: new TextEncoder().encode(text) }), set, budget: { ...BUDGET, ...budget }, options };
    } catch {
      return null;
    }
  }

  /** Notes a script that was changed and is not kept, in place of the one before. */
  note(now: Bench): void {
    if (!isScript(now) || this.noted === now) return;
    this.noted = now;
    const { name, set, budget, options } = now;
    try {
      this.store?.setItem(UNKEPT, now.kept === undefined ? JSON.stringify({ name, text: textOf(now), set, budget, options }) : "null");
    } catch {
      // Then the address alone has it.
    }
  }
  private noted: Bench | null = null;

  /** Puts a script on the shelf, under a name of its own. Returns its bench. */
  keep(of: Bench, saved: string | null = null): Bench {
    const { set, budget, options } = of;
    const name = this.free(cleaned(of.name) || "script");
    const script: Kept = { id: this.newId(), name, text: textOf(of), set, budget, options, saved };
    this.update({ scripts: [script, ...this.state.scripts] });
    return this.benchOf(script);
  }

  /** The bench changed: the script that it is does as well. */
  follow(now: Bench): void {
    const script = this.of(now);
    const open = script?.id ?? null;
    if (!script) return open === this.state.open ? undefined : this.update({ open });
    const { set, budget, options } = now;
    const text = textOf(now);
    const isSame = text === script.text && options === script.options && set === script.set && budget === script.budget;
    if (!isSame || open !== this.state.open) this.update({ scripts: this.with({ ...script, text, set, budget, options }), open });
  }

  /** A bench from an address, as the script that it is: the address has the last state of that after a reload. */
  known(now: Bench): Bench {
    const isSame = (one: Kept) => isScript(now) && one.text === textOf(now) && one.name === titleOf(now.name);
    const { scripts, open } = this.state;
    const found = scripts.find((one) => one.id === open && isSame(one)) ?? scripts.find(isSame);
    return found ? { ...now, kept: found.id } : now;
  }

  /** Renames a script. Returns its bench; `null` if that changes nothing. */
  rename(id: string, to: string): Bench | null {
    const script = this.state.scripts.find((one) => one.id === id);
    const wanted = cleaned(to);
    const name = script && wanted ? this.free(wanted, id) : "";
    if (!script || !name || name === script.name) return null;
    const renamed = { ...script, name };
    this.update({ scripts: this.with(renamed) });
    return this.benchOf(renamed);
  }

  remove(id: string): void {
    const { scripts } = this.state;
    const at = scripts.findIndex((one) => one.id === id);
    if (at < 0) return;
    this.update({ scripts: scripts.toSpliced(at, 1), deleted: { script: scripts[at]!, at } });
  }

  /** Puts the script that was deleted last back into its place. */
  restore(): void {
    const { deleted, scripts } = this.state;
    if (deleted) this.update({ scripts: scripts.toSpliced(deleted.at, 0, deleted.script), deleted: null });
  }

  /** A script was saved to a file with this text. */
  savedToFile(id: string, text: string): void {
    const script = this.state.scripts.find((one) => one.id === id);
    if (script) this.update({ scripts: this.with({ ...script, saved: text }) });
  }

  /** A name that no other script has. */
  private free(name: string, own = ""): string {
    const isTaken = (wanted: string) => this.state.scripts.some((one) => one.id !== own && one.name === wanted);
    if (!isTaken(name)) return name;
    const base = name.replace(/ \d+$/, "");
    for (let k = 2; ; k += 1) if (!isTaken(`${base} ${k}`)) return `${base} ${k}`;
  }

  /** All scripts, with a new version of one. */
  private with(script: Kept): readonly Kept[] {
    return this.state.scripts.map((one) => (one.id === script.id ? script : one));
  }

  private update(change: Partial<ShelfState>): void {
    this.state = { ...this.state, ...change };
    this.write();
    this.notify();
  }

  /** Writes the shelf. What is not written is still on the page, which says so. */
  private write(): void {
    const { scripts, open } = this.state;
    const text = JSON.stringify({ v: 1, scripts, open });
    let fault: ShelfState["fault"] = null;
    if (text.length > MOST) fault = "full";
    else
      try {
        if (this.store) this.store.setItem(KEY, text);
        else fault = "refused";
      } catch (error) {
        fault = error instanceof DOMException && error.name === "QuotaExceededError" ? "full" : "refused";
      }
    this.state = { ...this.state, fault };
  }
}

/** The storage of this browser; `null` if it refuses one, as in some private windows and frames. */
export function storage(): Store | null {
  try {
    localStorage.getItem(KEY);
    return localStorage;
  } catch {
    return null;
  }
}
