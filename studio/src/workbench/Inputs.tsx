// The inputs of the bench: a script or a file, its parameters, its options, and the error budget.
import { Choice, Slider } from "../view/parts";
import { Asks } from "./Asks";
import { CarriedNote } from "./Carried";
import { lineIn } from "./command_zh";
import { type Bench, type BudgetKind, isScript, viewText } from "./document";
import { FilePicker } from "./FilePicker";
import { LAYOUT_TEXTS } from "./layout/texts";
import { Script } from "./Script";
import { ShelfBar } from "./Shelf";
import { TextField } from "./TextField";
import type { Page } from "./words";

const KINDS: readonly BudgetKind[] = ["tol", "px", "triangles"];
/** A slider goes up to this multiple of the default, in so many steps. Chosen: a wider range makes steps coarser. */
const REACH = 2;
const STEPS = 100;
/** A whole number of at least this size may be a count, so its slider has whole steps. */
const WHOLE = 5;

export function Inputs({ page }: { page: Page }) {
  const { words, state, control, say } = page;
  const { bench } = state;
  return (
    <section class="inputs" aria-label={words.file}>
      <ShelfBar page={page}>
        <FilePicker label={words.open} multiple chosen={(files) => void control?.open(files)} />
        <button type="button" disabled={!state.past.length} aria-label={words.undo} title={words.undo} onClick={() => control?.undo()}>
          ↶
        </button>
        <button type="button" disabled={!state.future.length} aria-label={words.redo} title={words.redo} onClick={() => control?.redo()}>
          ↷
        </button>
      </ShelfBar>
      <CarriedNote page={page} />
      {isScript(bench) ? (
        <Script page={page} />
      ) : (
        <p class="named">
          <b>{bench.name}</b> · {say.bytes(bench.files[bench.name]?.length ?? 0)}
        </p>
      )}
      <Asks page={page} />
      <Printed page={page} />
      <Parameters page={page} />
      <BudgetBar page={page} />
      <details class="options-more" open={bench.options !== ""}>
        <summary>{words.options}</summary>
        <label class="field">
          <span class="aside">{words.optionsHint}</span>
          <TextField value={bench.options} enter={(options) => control?.put({ ...bench, options })} />
        </label>
      </details>
    </section>
  );
}

/** What the script printed, and what the command remarks on it. */
function Printed({ page }: { page: Page }) {
  const { state, language } = page;
  const said = (state.shown?.certificate.input?.warnings ?? []).filter(({ code }) => code === "script-said");
  if (!said.length || !isScript(state.bench)) return null;
  const texts = LAYOUT_TEXTS[language];
  return (
    <pre class="said" tabIndex={0} aria-label={texts.said}>
      {said.map(({ message }) => lineIn(language, message)).join("\n")}
    </pre>
  );
}

function Parameters({ page }: { page: Page }) {
  const { words, state, control, say } = page;
  const { bench, inspection } = state;
  const parameters = inspection?.field?.parameters ?? [];
  // If a parameter was renamed, the command refuses its value and lists no parameters; the button must still reset it.
  const isChanged = Object.keys(bench.set).length > 0;
  if (!isScript(bench) || !(parameters.length || isChanged)) return null;
  const set = (name: string, value: number, isDragging: boolean) =>
    control?.put({ ...bench, set: { ...bench.set, [name]: String(value) } }, isDragging);
  return (
    <details class="parameters-fold" open>
      <summary>{words.parameters}</summary>
      <fieldset class="parameters" aria-label={words.parameters} onChange={() => control?.rest()}>
        {parameters.map(({ name, default: usual }) => {
          const value = Number(bench.set[name] ?? usual);
          const [low, high] = usual === 0 ? [-1, 1] : usual > 0 ? [0, REACH * usual] : [REACH * usual, 0];
          const step = Number.isInteger(usual) && Math.abs(usual) >= WHOLE ? 1 : Number(((high - low) / STEPS).toPrecision(1));
          return (
            <Slider
              key={name}
              id={`param-${name}`}
              label={name}
              shown={say.number(value)}
              spoken={`${name} ${value}`}
              low={Math.min(low, value)}
              high={Math.max(high, value)}
              step={step}
              value={value}
              choose={(next) => set(name, next, true)}
            />
          );
        })}
        {isChanged && (
          <button type="button" onClick={() => control?.put({ ...bench, set: {} })}>
            {words.reset}
          </button>
        )}
      </fieldset>
    </details>
  );
}

function BudgetBar({ page }: { page: Page }) {
  const { words, state, control } = page;
  const { bench } = state;
  const { budget } = bench;
  const put = (change: Partial<Bench["budget"]>) => control?.put({ ...bench, budget: { ...budget, ...change } });
  const hint = budget.by === "px" ? words.budgetHints.px(control ? viewText(control.sight.screen) : "", control?.sight.isNear ?? false) : words.budgetHints[budget.by];
  return (
    <div class="budget">
      <Choice
        name="budget"
        legend={words.budget}
        value={budget.by}
        options={KINDS.map((value) => ({ value, label: words.budgets[value] }))}
        choose={(by) => put({ by })}
      />
      <label class="field">
        <TextField
          key={budget.by}
          value={budget[budget.by]}
          label={words.budgets[budget.by]}
          inputMode={budget.by === "tol" ? "text" : "decimal"}
          enter={(text) => put({ [budget.by]: text })}
        />
        <span class={`aside${budget.by === "px" ? "" : " when-entered"}`}>{hint}</span>
      </label>
    </div>
  );
}
