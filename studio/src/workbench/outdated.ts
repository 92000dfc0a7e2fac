// Whether the mesh that is shown belongs to the current input.
import type { State } from "./state";

/** The mesh is of an older input and will stay, because the run for the current one failed or was cancelled. */
export const isOutdated = ({ bench, shown, fault, ended }: State): boolean =>
  shown !== null && shown.bench !== bench && (fault !== null || ended === bench);

/** No mesh could be made of the current input. */
export const isBroken = ({ bench, shown, fault }: State): boolean => fault !== null && shown?.bench !== bench;
