// The dialogue by which a reader brings a shape: a file, some lines of a script, or one of the examples.
import { useState } from "preact/hooks";
import type { Language } from "../../exhibits/say";
import { bench } from "../../workbench/document";
import { type Example, PICTURE, example, pictureOf } from "../../workbench/examples";
import { FilePicker } from "../../workbench/FilePicker";
import { PANEL_TEXTS } from "../../workbench/panel_texts";
import { Reason, Working } from "./parts";
import type { OwnShape } from "./shape";
import type { OwnTexts } from "./texts";

/** Of the examples of the workbench those that take a moment. */
const CHOICES = ["bracket", "gear", "badge", "creature"] as const satisfies readonly Example[];
/** A shape at once, and short enough to be understood. */
const FIRST = "box(2, 2, 2) - cylinder(0.5, 3)\n";
/** The name of a script that was written here. */
const NAME = "shape.star";

interface Props {
  own: OwnShape;
  words: OwnTexts;
  language: Language;
  take(files: readonly File[]): void;
  taken(taking: Promise<boolean>): void;
}

export function Dialog({ own, words, language, take, taken }: Props) {
  const [script, setScript] = useState(FIRST);
  const [isOver, setOver] = useState(false);
  const { taking, why } = own;
  const close = (dialog: HTMLDialogElement) => dialog.close();
  return (
    <dialog
      class="own-dialog"
      aria-labelledby="own-dialog-title"
      onClick={(event) => event.target === event.currentTarget && close(event.currentTarget)}
      onClose={() => own.stop()}
    >
      <div class="own-head">
        <h2 id="own-dialog-title">{words.bring}</h2>
        <button type="button" onClick={(event) => close(event.currentTarget.closest("dialog")!)}>
          {words.close}
        </button>
      </div>
      <p>{words.lead}</p>
      {taking && (
        <div class="own-taking">
          <p>{words.taking(taking.name)}</p>
          <Working runs={[taking.run]} words={words} language={language} />
          <button type="button" onClick={() => own.stop()}>
            {words.cancel}
          </button>
        </div>
      )}
      {why && <Reason why={why} words={words} language={language} />}
      <div
        class="own-drop"
        data-over={isOver ? "1" : undefined}
        onDragEnter={() => setOver(true)}
        onDragLeave={(event) => !event.currentTarget.contains(event.relatedTarget as Node | null) && setOver(false)}
        onDrop={() => setOver(false)}
      >
        <FilePicker label={words.choose} multiple chosen={take} /> <span class="aside">{words.formats}</span>
      </div>
      <form
        onSubmit={(event) => {
          event.preventDefault();
          taken(own.take(bench(NAME, { [NAME]: new TextEncoder().encode(script) }), NAME));
        }}
      >
        <label for="own-script">{words.write}</label>
        <textarea
          id="own-script"
          rows={4}
          spellcheck={false}
          autocapitalize="off"
          autocomplete="off"
          value={script}
          onInput={(event) => setScript(event.currentTarget.value)}
        />
        <button type="submit">{words.take}</button>
      </form>
      <h3>{words.examples}</h3>
      <ul class="own-examples">
        {CHOICES.map((name) => (
          <li key={name}>
            <button type="button" data-example={name} onClick={() => taken(own.take(example(name), `${name}.star`))}>
              <img src={pictureOf(name)} {...PICTURE} loading="lazy" alt="" />
              {PANEL_TEXTS[language].examples[name]}
            </button>
          </li>
        ))}
      </ul>
      <p class="aside">{words.loads}</p>
      {own.shape && (
        <p>
          <button
            type="button"
            onClick={(event) => {
              own.leave();
              close(event.currentTarget.closest("dialog")!);
            }}
          >
            {words.back}
          </button>
        </p>
      )}
    </dialog>
  );
}
