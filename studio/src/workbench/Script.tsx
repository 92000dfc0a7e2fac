// The script in an editor that is loaded when it is needed; until then, and without it, in a plain field.
import { textOf } from "./document";
import type { Page } from "./words";

export function Script({ page }: { page: Page }) {
  const { words, state, control } = page;
  const text = textOf(state.bench);
  return (
    <label class="field script">
      {words.script}
      <textarea spellcheck={false} value={text} onInput={(event) => control?.write(event.currentTarget.value)} />
    </label>
  );
}
