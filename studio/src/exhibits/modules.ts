// Which module answers which exhibit: the table is modules.json, from which scripts/link.mjs links them.
import { Core } from "../core/module";
import type { ExhibitQuestion } from "../core/types";
import table from "./modules.json";

/** The module of an exhibit, by its name in the table. */
export function moduleOf(id: string): string {
  const found = Object.entries(table).find(([, ids]) => ids.includes(id));
  if (!found) throw new Error(`modules.json names no module for the exhibit '${id}'`);
  return found[0];
}

/** The cores of exhibits, each loaded when the first of its exhibits asks. */
export class ExhibitCores {
  private readonly loading = new Map<string, Promise<Core>>();
  constructor(private readonly read: (module: string) => Promise<BufferSource>) {}

  async ask(question: ExhibitQuestion): Promise<unknown> {
    return (await this.load(question.exhibit)).ask("exhibit", question);
  }

  /** The core that answers an exhibit. */
  load(id: string): Promise<Core> {
    const module = moduleOf(id);
    const core = this.loading.get(module) ?? this.read(module).then((bytes) => Core.load(bytes));
    this.loading.set(module, core);
    return core;
  }
}
