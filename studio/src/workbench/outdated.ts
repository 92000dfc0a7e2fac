// Whether the mesh that is shown belongs to the current input, and whether there is anything of it.
import type { State } from "./state";

/** The mesh is of an older input and will stay, because the run for the current one failed or was cancelled. */
export const isOutdated = ({ bench, shown, fault, ended }: State): boolean =>
  shown !== null && shown.bench !== bench && (fault !== null || ended === bench);

/** No mesh could be made of the current input. */
export const isBroken = ({ bench, shown, fault }: State): boolean => fault !== null && shown?.bench !== bench;

/** The mesh of the current input has no triangles: the shape is smaller than the error that may be seen. */
export const isEmpty = ({ bench, shown }: State): boolean =>
  shown !== null && shown.bench === bench && !shown.isDraft && shown.certificate.output?.triangles === 0;
