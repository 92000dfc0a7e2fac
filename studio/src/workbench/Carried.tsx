// Says that a file was opened as the script it carries, and whether its claims were proved again from it.
import { Working } from "./Certificate";
import { faultIn } from "./command_zh";
import { PANEL_TEXTS } from "./panel_texts";
import { Said } from "./Said";
import type { Page } from "./words";

export function CarriedNote({ page }: { page: Page }) {
  const { state, control, language } = page;
  const words = PANEL_TEXTS[language];
  const { carried } = state;
  // Undone, or another shape: the note is about neither.
  if (!carried || state.bench.name !== carried.script.name) return null;
  const { file, verdict, isRunning, reason } = carried;
  return (
    <div class={`carried ${verdict ?? ""}`} role="status">
      <p>
        {words.carried(file.name, carried.script.name)}{" "}
        {isRunning ? words.carriedRunning : verdict ? words.carriedVerdicts[verdict] : words.carriedUnknown}
        {!isRunning && reason && (
          <>
            {" "}
            <Said words={faultIn(language, { text: reason })} />
          </>
        )}
      </p>
      <Working page={page} lanes={["verify"]} />
      <div class="row tight">
        <button type="button" onClick={() => control?.put(file)}>
          {words.showFile(file.name)}
        </button>
        <button type="button" onClick={() => control?.change({ carried: null })}>
          {words.dismiss}
        </button>
      </div>
    </div>
  );
}
