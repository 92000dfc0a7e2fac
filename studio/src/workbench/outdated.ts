// Whether what is shown is of what is on the bench.
import type { State } from "./state";

/** What is shown is not of what is on the bench, and will not be: that failed or was stopped. */
export const isOutdated = ({ bench, shown, fault, ended }: State): boolean =>
  shown !== null && shown.of !== bench && (fault !== null || ended === bench);

/** What is on the bench makes no shape. */
export const isBroken = ({ bench, shown, fault }: State): boolean => fault !== null && shown?.of !== bench;
