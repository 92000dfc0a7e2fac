// Steps that replace the shape by another one: union, difference or intersection with a solid, and baking into a grid.
import { useState } from "preact/hooks";
import { Choice } from "../view/parts";
import { type Bench, stem } from "./document";
import { FilePicker } from "./FilePicker";
import { isBroken } from "./outdated";
import type { Page } from "./words";

const HOWS = ["union", "minus", "intersect"] as const;
/** Cells of a bake by default. */
const CELLS = "64";

export function Steps({ page }: { page: Page }) {
  const { words, state, control } = page;
  const { bench } = state;
  const [cells, setCells] = useState(CELLS);
  const combine = (change: Bench["combine"], files = bench.files) => control?.put({ ...bench, files, combine: change });
  const combineWith = async (file: File | undefined) => {
    if (!file) return;
    const name = file.name === bench.name ? `other-${file.name}` : file.name;
    combine({ how: "union", name }, { ...bench.files, [name]: new Uint8Array(await file.arrayBuffer()) });
  };
  return (
    <section class="panel steps-panel">
      <h2>{words.combine}</h2>
      {bench.combine ? (
        <>
          <Choice
            name="how"
            legend={bench.combine.name}
            value={bench.combine.how}
            options={HOWS.map((value) => ({ value, label: words.how[value] }))}
            choose={(how) => combine({ ...bench.combine!, how })}
          />
          <button type="button" onClick={() => combine(null)}>
            {words.remove}
          </button>
        </>
      ) : (
        <FilePicker label={words.combineWith} chosen={([file]) => void combineWith(file)} />
      )}
      <h2>{words.bake}</h2>
      <label class="field">
        {words.cells}
        <input type="text" inputMode="numeric" value={cells} onInput={(event) => setCells(event.currentTarget.value)} />
      </label>
      <button
        type="button"
        disabled={isBroken(state)}
        onClick={() => void control?.step("bake", ["--cells", cells], `${stem(bench.name)}.nrrd`)}
      >
        {words.bake}
      </button>
      <p class="aside">{words.bakeHint}</p>
    </section>
  );
}
