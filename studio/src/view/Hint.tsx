// How to move a figure, for the devices that the reader has: what follows {touch}, {mouse} or {keys} in a hint, up to the next of
// them, is shown only if there is a touch screen, a mouse or a keyboard.
import { type ComponentChildren, Fragment } from "preact";

/** The parts of a hint, each with its device; the first is for all. */
export function partsOf(text: string): { device: string; text: string }[] {
  return text.split(/(?=\{(?:touch|mouse|keys)\})/).map((part) => {
    const [, device = "", rest = part] = /^\{(\w+)\}([^]*)$/.exec(part) ?? [];
    return { device, text: rest };
  });
}

export const Hint = ({ text }: { text: string }): ComponentChildren =>
  partsOf(text).map(({ device, text }) => (device ? <span class={`for-${device}`}>{text}</span> : <Fragment>{text}</Fragment>));
