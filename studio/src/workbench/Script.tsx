// The script in an editor, which is loaded on demand; until then, or if that fails, in a plain text field.
import { useEffect, useRef, useState } from "preact/hooks";
import { faultIn } from "./command_zh";
import { textOf } from "./document";
import type { ScriptEditor } from "./editor";
import type { Page } from "./words";

export function Script({ page }: { page: Page }) {
  const { words, state, control, language } = page;
  const container = useRef<HTMLDivElement>(null);
  const editor = useRef<ScriptEditor | null>(null);
  const latestPage = useRef(page);
  latestPage.current = page;
  const [isLoaded, setLoaded] = useState(false);
  const text = textOf(state.bench);

  useEffect(() => {
    if (!control) return;
    let isGone = false;
    void import("./editor").then(({ EDITOR_PHRASES, createEditor, tableIn }) => {
      if (isGone) return;
      setLoaded(true);
      editor.current = createEditor(container.current!, {
        text: textOf(control.state.bench),
        label: words.script,
        phrases: EDITOR_PHRASES[language],
        moved: (place) => latestPage.current.link?.moved(place),
        change: (text, isDragging) => latestPage.current.control?.write(text, isDragging),
      });
      void control.onDemand.language().then(async (table) => {
        if (table) editor.current?.setTable(await tableIn(language, table.functions), table.words);
      });
    });
    return () => {
      isGone = true;
      editor.current?.dispose();
      editor.current = null;
    };
  }, [control, language]);

  useEffect(() => {
    // The newest text, not the rendered one: a key may have been pressed since.
    const newest = control ? textOf(control.state.bench) : text;
    if (editor.current && editor.current.text !== newest) editor.current.setText(newest);
  }, [text]);

  useEffect(() => {
    const { fault, moreFaults } = state;
    const placed = (fault ? [fault, ...moreFaults] : []).filter(({ line }) => line !== undefined);
    editor.current?.setErrors(
      placed.map((one) => {
        const { text: message, lang } = faultIn(language, one);
        return { line: one.line!, message, ...(lang ? { lang } : {}), ...(one.column ? { column: one.column } : {}) };
      }),
    );
  }, [state.fault, state.moreFaults, isLoaded]);

  const reveal = page.link?.reveal;
  useEffect(() => {
    if (reveal) editor.current?.reveal(reveal.from, reveal.to);
  }, [reveal]);

  return (
    <div class="field script">
      {!isLoaded && (
        <label class="field">
          {words.script}
          <textarea spellcheck={false} value={text} readOnly={!control} onInput={(event) => control?.write(event.currentTarget.value)} />
        </label>
      )}
      <div ref={container} class="editor-place" />
    </div>
  );
}
