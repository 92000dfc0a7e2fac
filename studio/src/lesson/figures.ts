// The figures of the lesson: the exhibits, and those that have no page of their own.
import type { AnyExhibit } from "../exhibits/exhibit";
import { EXHIBITS } from "../exhibits/index";
import type { OWN_FIGURES } from "./outline";

const OWN: Record<(typeof OWN_FIGURES)[number], () => Promise<{ default: AnyExhibit }>> = {
  segments: () => import("./segments"),
};

/** Loads a figure's module. */
export async function loaded(id: string): Promise<AnyExhibit> {
  const load = EXHIBITS.find((entry) => entry.id === id)?.load ?? OWN[id as keyof typeof OWN];
  return (await load()).default;
}

/** Whether a figure has a page of its own. */
export const hasPage = (id: string) => EXHIBITS.some((entry) => entry.id === id);
