// Asks in place for what the input still lacks: the files that a script reads, the text that a font sets, the height of a
// drawing, and the level of a volume's surface.
import { Slider } from "../view/parts";
import { type Bench, isDrawing, isVolume, split, without } from "./document";
import { FilePicker } from "./FilePicker";
import { isFont, lackOf } from "./lack";
import { PANEL_TEXTS } from "./panel_texts";
import { TextField } from "./TextField";
import type { Page } from "./words";

const FONTS = ".ttf,.otf,.ttc";
/** The slider of a level has so many steps. Chosen: one is about a pixel of the slider. */
const STEPS = 200;
/** The height that is offered first, as a share of the diagonal: a plate. */
const HEIGHT = 0.1;

export function Asks({ page }: { page: Page }) {
  return (
    <>
      <FileAsk page={page} />
      <FontAsk page={page} />
      <HeightAsk page={page} />
      <LevelAsk page={page} />
    </>
  );
}

/** A font without the text that it is to set. */
export const lacksText = ({ name, options }: Bench): boolean => isFont(name) && !optionOf(options, "--text");

/** The value of an option on the bench; `null` if it is not there. */
export function optionOf(options: string, name: string): string | null {
  const words = split(options);
  const at = words.findIndex((word) => word === name || word.startsWith(`${name}=`));
  if (at < 0) return null;
  return words[at] === name ? (words[at + 1] ?? "") : words[at]!.slice(name.length + 1);
}

/** The options with one set to a value, or without it. */
export function withOption(options: string, name: string, value: string | null): string {
  // `without` leaves the first word alone, which is the verb of a line.
  const rest = without(["", ...split(options)], name).slice(1);
  const all = value === null ? rest : [...rest, name, value];
  return all.map((word) => (/\s/.test(word) ? `"${word}"` : word)).join(" ");
}

/** A file that the script reads and that is not here. */
function FileAsk({ page }: { page: Page }) {
  const { state, control, language } = page;
  const words = PANEL_TEXTS[language];
  const lack = lackOf(state);
  if (!lack) return null;
  const { name, isFont } = lack;
  const add = async (file: File | undefined) => {
    if (file) control?.supply(lack, { [file.name]: new Uint8Array(await file.arrayBuffer()) });
  };
  return (
    <div class="ask" role="group" aria-label={words.ask}>
      <p>{name === null ? words.askFontArgument : words.askFile(name)}</p>
      <FilePicker
        asks="file"
        label={isFont ? words.chooseFont : words.chooseFile}
        {...(isFont ? { accept: FONTS } : {})}
        chosen={([file]) => void add(file)}
      />
    </div>
  );
}

/** The text that a font sets. */
function FontAsk({ page }: { page: Page }) {
  const { state, control, language } = page;
  const words = PANEL_TEXTS[language];
  const { bench } = state;
  if (!isFont(bench.name)) return null;
  const put = (options: string) => control?.put({ ...bench, options });
  return (
    <div class="ask" role="group" aria-label={words.ask}>
      <label class="field">
        {words.askText}
        <TextField ask="text" value={optionOf(bench.options, "--text") ?? ""} enter={(text) => put(withOption(bench.options, "--text", text || null))} />
      </label>
    </div>
  );
}

/** The height to which a drawing is raised. */
function HeightAsk({ page }: { page: Page }) {
  const { state, control, language } = page;
  const words = PANEL_TEXTS[language];
  const { bench, inspection } = state;
  if (!isDrawing(bench)) return null;
  const put = (value: string | null) => control?.put({ ...bench, options: withOption(bench.options, "--extrude", value) });
  const height = optionOf(bench.options, "--extrude");
  if (lacksText(bench)) return null;
  return (
    <div class="ask" role="group" aria-label={words.ask}>
      <label class="field">
        {words.askHeight}
        <TextField ask="height" inputMode="decimal" value={height ?? ""} enter={(text) => put(text.trim() || null)} />
      </label>
      {height === null && inspection?.box && (
        <button type="button" data-ask="raise" onClick={() => put(String(Number((HEIGHT * diagonalOf(inspection.box!)).toPrecision(1))))}>
          {words.raise}
        </button>
      )}
    </div>
  );
}

const diagonalOf = ([low, high]: readonly [readonly number[], readonly number[]]): number => Math.hypot(...low.map((x, k) => high[k]! - x));

/** The level of a volume's surface, within the range of its samples. */
function LevelAsk({ page }: { page: Page }) {
  const { state, control, language, say } = page;
  const words = PANEL_TEXTS[language];
  const { bench, inspection } = state;
  const { low, high, suggested } = inspection?.volume ?? {};
  if (!isVolume(bench) || low === undefined || low === null || high === undefined || high === null || low === high) return null;
  // Labels have surfaces of their own, which are no level.
  if (optionOf(bench.options, "--labels") !== null) return null;
  const given = optionOf(bench.options, "--iso");
  const level = given === null ? (suggested?.level ?? (low + high) / 2) : Number(given);
  const step = Number(((high - low) / STEPS).toPrecision(1));
  const choose = (value: number, isDragging: boolean) =>
    control?.put({ ...bench, options: withOption(bench.options, "--iso", String(Number(value.toPrecision(6)))) }, isDragging);
  return (
    <div class="ask" role="group" aria-label={words.ask} onChange={() => control?.rest()}>
      <Slider
        id="iso"
        label={words.askLevel}
        shown={say.number(level)}
        spoken={`${words.askLevel} ${level}`}
        low={low}
        high={high}
        step={step}
        value={level}
        choose={(value) => choose(value, true)}
      />
      <p class="aside">
        {words.levelRange(say.number(low), say.number(high))}
        {suggested && ` ${words.levelSuggested(say.number(suggested.level))}`}
      </p>
      {given !== null && (
        <button type="button" onClick={() => control?.put({ ...bench, options: withOption(bench.options, "--iso", null) })}>
          {words.levelReset}
        </button>
      )}
    </div>
  );
}
