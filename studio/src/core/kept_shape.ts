// One shape with its files that this browser keeps for the pages of the studio.
import type { Files } from "./command";
import { browserDrawer } from "./drawer";

export interface KeptShape {
  /** The file's name. */
  name: string;
  /** All files by name, among them the shape's. */
  files: Files;
}

const drawer = browserDrawer("chordal.own", "shape");
/** There is one. */
const KEY = "the one";

/** Keeps a shape in place of the last one, or none. Returns whether the browser did. */
export const keepShape = (shape: KeptShape | null): Promise<boolean> =>
  (shape ? drawer.set(KEY, shape) : drawer.drop(KEY)).then(
    () => true,
    () => false,
  );

/** The shape that is kept; `null` if there is none, or the browser refuses. */
export const keptShape = (): Promise<KeptShape | null> =>
  drawer.get(KEY).then(
    (found) => (isShape(found) ? found : null),
    () => null,
  );

function isShape(value: unknown): value is KeptShape {
  const { name, files } = (value ?? {}) as Partial<KeptShape>;
  return typeof name === "string" && files?.[name] instanceof Uint8Array;
}
