// The example scripts of the workbench, from examples/.
import badge from "../../../examples/badge.star?raw";
import bracket from "../../../examples/bracket.star?raw";
import gear from "../../../examples/gear.star?raw";
import vase from "../../../examples/vase.star?raw";
import { type Bench, bench } from "./document";

const SCRIPTS = { bracket, gear, vase, badge };

export type Example = keyof typeof SCRIPTS;
export const EXAMPLES = Object.keys(SCRIPTS) as readonly Example[];

export const example = (name: Example): Bench =>
  bench(`${name}.star`, { [`${name}.star`]: new TextEncoder().encode(SCRIPTS[name]) });
