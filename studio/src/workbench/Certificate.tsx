// The certificate of the mesh: its bound, the evidence for that, and the properties of its triangles.
import { Figure } from "../view/parts";
import type { Vec3 } from "../viewer";
import { assumptionIn, stageIn } from "./command_zh";
import { isScript } from "./document";
import type { LaneName } from "./state";
import { LAYOUT_TEXTS } from "./layout/texts";
import { isOutdated } from "./outdated";
import { towards } from "./pixels";
import type { AttributeFacts, BoundFacts } from "./report";
import { Said } from "./Said";
import type { Page } from "./words";

export function Certificate({ page, mark }: { page: Page; mark(places: readonly Vec3[]): void }) {
  const { words, say, state, control, language } = page;
  const { shown } = state;
  const bound = shown?.certificate.bound;
  const { output, valid } = shown?.certificate ?? {};
  return (
    <div class="certificate">
      {isOutdated(state) && <p class="outdated">{words.outdated}</p>}
      {shown?.isShort && !shown.isDraft && <p class="aside">{words.short}</p>}
      {bound && shown && (
        <>
          <p class={`big ${shown.isDraft ? "draft" : shown.bench === state.bench ? bound.evidence : "old"}`}>
            <Figure name="bound" value={bound.at_most ?? bound.at_least}>
              {sizeOf(page, bound)}
            </Figure>
          </p>
          <p class="evidence">
            {isKnown(bound) && <b>{evidenceOf(page, bound)}</b>}
            {bound.pixels !== null && ` · ${words.inPixels(say.number(bound.pixels))}`}
          </p>
          {bound.assumptions?.map((assumption) => (
            <p class="aside" key={assumption}>
              <Said words={assumptionIn(language, assumption)} />
            </p>
          ))}
          {shown.isDraft && <p class="aside">{state.ended === state.bench ? words.draftOnly : isScript(state.bench) ? words.draft : LAYOUT_TEXTS[language].asItIs}</p>}
        </>
      )}
      {shown && (
        <dl class="facts">
          <div>
            <dt>{words.triangles}</dt>
            <dd>
              <Figure name="triangles" value={output?.triangles ?? null}>
                {say.whole(output?.triangles ?? 0)}
              </Figure>
            </dd>
          </div>
          {valid && (
            <div>
              <dt>{words.closed}</dt>
              <dd>{valid.closed && valid.manifold ? words.yes : words.no}</dd>
            </div>
          )}
          {valid && valid.genus !== null && valid.closed && (
            <div>
              <dt>{words.genus}</dt>
              <dd>{valid.genus}</dd>
            </div>
          )}
          {shown.certificate.attributes?.map((attribute) => (
            <div key={attribute.name} data-attribute={attribute.name}>
              <dt>{words.attributeOff(words.attributes[attribute.semantic], numberOf(attribute))}</dt>
              <dd>{errorOf(page, attribute)}</dd>
            </div>
          ))}
          <div>
            <dt>{words.seconds}</dt>
            <dd>{say.fixed(shown.seconds)}</dd>
          </div>
        </dl>
      )}
      {bound?.at && !shown?.isDraft && control && (
        <button
          type="button"
          onClick={() => {
            const at = control.sight.place(bound.at!);
            mark([at]);
            control.look(towards(at, state.view, state.home));
          }}
        >
          {words.worst}
        </button>
      )}
    </div>
  );
}

/** Whether the bound says anything: the estimate of a draft does not, and neither does "0 or more". */
export const isKnown = ({ evidence, at_least, at_most }: BoundFacts): boolean => evidence !== "estimated" && (at_most !== null || at_least > 0);

export function sizeOf({ words, say, state }: Page, bound: BoundFacts): string {
  if (!isKnown(bound)) return state.shown?.isDraft ? words.unknown : words.unproved;
  return bound.at_most === null ? words.atLeast(say.number(bound.at_least)) : words.atMost(say.number(bound.at_most));
}

/** Which of several attributes of one kind, counted from 1; of a custom attribute its name in the file. */
const numberOf = ({ semantic, name }: AttributeFacts): string =>
  semantic === "custom" ? name : (/ ([1-9]\d*)$/.exec(name)?.[1] ?? "").replace(/\d+/, (k) => String(Number(k) + 1));

const errorOf = ({ words, say }: Page, { largest, unit }: AttributeFacts): string =>
  largest === null ? words.noNumber : unit === "degrees" ? say.degrees(largest) : say.number(largest);

export function evidenceOf({ words }: Page, { evidence }: BoundFacts): string {
  return { proved: words.proved, "proved-if": words.provedIf, measured: words.measured, estimated: words.estimated }[evidence];
}

/** Rounded, since it is a guess: to a second, from ten on to five, from a minute and a half on to minutes. */
function leftIn({ say, language }: Page, seconds: number): string {
  const texts = LAYOUT_TEXTS[language];
  if (seconds >= 90) return texts.minutesLeft(say.whole(Math.round(seconds / 60)));
  return texts.secondsLeft(say.whole(seconds < 10 ? Math.max(1, Math.round(seconds)) : 5 * Math.round(seconds / 5)));
}

/** The progress of a run, with a button that cancels it. */
export function Working({ page, lanes }: { page: Page; lanes: readonly LaneName[] }) {
  const { words, say, state, control, language } = page;
  const lane = lanes.find((name) => state.running.includes(name));
  if (!lane) return null;
  const progress = state.progress[lane];
  return (
    <p class="working">
      <progress max={100} {...(progress ? { value: progress.percent } : {})} aria-label={words.waiting} />
      <span>
        {progress ? (
          <>
            <Said words={stageIn(language, progress.stage)} /> {say.percent(progress.percent / 100)}
            {progress.left !== null && say.marks.comma + leftIn(page, progress.left)}
          </>
        ) : (
          words.waiting
        )}
      </span>
      <button type="button" onClick={() => control?.cancel(lane)}>
        {words.cancel}
      </button>
    </p>
  );
}
