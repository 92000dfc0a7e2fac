// The example scripts of the workbench with their pictures, from examples/ and docs/pictures/.
import { type Bench, bench } from "./document";

/** In the order in which the shelf shows them. */
export const EXAMPLES = [
  "bracket",
  "enclosure",
  "gear",
  "vase",
  "angle_bracket",
  "twisted_bolt",
  "badge",
  "block",
  "gyroid_cube",
  "gyroid",
  "creature",
  "blobs",
  "sponge",
] as const;
export type Example = (typeof EXAMPLES)[number];

const SCRIPTS = import.meta.glob<string>("../../../examples/*.star", { query: "?raw", import: "default", eager: true });
const PICTURES = import.meta.glob<string>(
  [
    "../../../docs/pictures/{bracket,enclosure,gear,vase,angle_bracket,twisted_bolt,badge}.png",
    "../../../docs/pictures/{block,gyroid_cube,gyroid,creature,blobs,sponge}.png",
  ],
  { query: "?thumbnail", import: "default", eager: true },
);

/** The size of the pictures, in pixels. */
export const PICTURE = { width: 240, height: 180 };

export const example = (name: Example): Bench =>
  bench(`${name}.star`, { [`${name}.star`]: new TextEncoder().encode(SCRIPTS[`../../../examples/${name}.star`]) });

/** The address of a small picture. */
export const pictureOf = (name: Example): string => PICTURES[`../../../docs/pictures/${name}.png`] ?? "";
