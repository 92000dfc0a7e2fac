// The questions to the core for a state.
import type { LadderQuestion, SeamQuestion, StudyQuestion } from "./core/types";
import type { State } from "./state/state";
import { LOUPE_REACH } from "./view/Loupe";
import { COUNTS } from "./view/Plot";
import { firstOf, secondOf } from "./view/Seam";
import { Frame } from "./view/frame";
import { densityOf, type Surroundings } from "./view/page";

/** Device pixels in one unit of the drawing. */
export function pixelsPerUnit(state: State, around: Surroundings): number {
  return new Frame(around.width).scale * densityOf(state, around);
}

export function studyOf(state: State, around: Surroundings): StudyQuestion {
  return {
    control: state.control,
    segments: state.segments,
    other: state.before ?? 2 * state.segments,
    pixels_per_unit: pixelsPerUnit(state, around),
    pixels: state.goal,
    t: state.t,
    near: LOUPE_REACH / new Frame(around.width).scale,
  };
}

export function ladderOf(state: State, around: Surroundings): LadderQuestion {
  return { control: state.control, counts: COUNTS, pixels_per_unit: pixelsPerUnit(state, around) };
}

export function seamOf(state: State, leader: "first" | "second"): SeamQuestion {
  return { first: firstOf(state.seam), second: secondOf(state.seam), smoothness: state.smoothness, leader, scale: state.comb };
}
