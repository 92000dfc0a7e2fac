// The line below the picture that always says what is known: the bound and how it is known, faults, what runs, and the scale.
import { Working, evidenceOf, isKnown, sizeOf } from "../Certificate";
import { lacksText } from "../Asks";
import { isEmpty, isOutdated } from "../outdated";
import { PANEL_TEXTS } from "../panel_texts";
import { FaultSaid } from "../Said";
import { touches } from "../Touching";
import type { Page } from "../words";
import type { LayoutControl } from "./layout";
import { LAYOUT_TEXTS } from "./texts";

export function Status({ page, control, square, unit }: { page: Page; control: LayoutControl; square: string; unit: string }) {
  const { words, say, state, language } = page;
  const texts = LAYOUT_TEXTS[language];
  const { shown } = state;
  const bound = shown?.certificate.bound;
  const triangles = shown?.certificate.output?.triangles;
  const isOld = shown !== null && shown.bench !== state.bench;
  const kind = !shown || !bound ? "" : shown.isDraft ? "draft" : isOld ? "old" : bound.evidence;
  return (
    <section class="status" aria-label={texts.status}>
      <button type="button" class={`headline-of-proof ${kind}`} onClick={() => control.isOpen("certificate") || control.toggle("certificate")}>
        <span aria-live="polite">
          {!shown && (state.running.length > 0 || state.isWaiting ? words.waiting : texts.nothing)}
          {shown && bound && (
            <>
              <b>{sizeOf(page, bound)}</b>
              {isKnown(bound) && say.marks.comma + evidenceOf(page, bound)}
            </>
          )}
          {shown && triangles !== undefined && `${bound ? say.marks.comma : ""}${texts.triangles(say.whole(triangles))}`}
          {shown && !isOld && !shown.isDraft && touches(shown.certificate) && ` · ${PANEL_TEXTS[language].touchingShort}`}
          {isOutdated(state) && ` · ${texts.older}`}
        </span>
      </button>
      <Working page={page} lanes={["proof", "draft", "trace"]} />
      <span class="scale">
        {unit || texts.noUnit}
        {square && ` · ${texts.square(square)}`}
      </span>
    </section>
  );
}

/** The fault of the current input, and what its script printed, above the status line. */
export function Messages({ page }: { page: Page }) {
  const { words, state, control, language } = page;
  const { bench, notice, shown } = state;
  // What a font still lacks is asked for, and is no mistake.
  const fault = lacksText(bench) ? null : state.fault;
  return (
    <div class="messages">
      {(fault || isOutdated(state) || isEmpty(state)) && (
        <div class="faults">
          {isEmpty(state) && (
            <p class="fault" role="alert">
              {words.noTriangles}
            </p>
          )}
          {fault && (
            <p class="fault" role="alert">
              <b>{fault.line ? words.atLine(fault.line) : words.error}</b> <FaultSaid fault={fault} language={language} />
            </p>
          )}
          {state.moreFaults.length > 0 && (
            <ul class="more-faults" role="status">
              {state.moreFaults.map((one, i) => (
                <li key={i}>
                  <b>{words.atLine(one.line!)}</b> <FaultSaid fault={one} language={language} />
                </li>
              ))}
            </ul>
          )}
          {isOutdated(state) && <p class="outdated">{words.outdated}</p>}
        </div>
      )}
      {shown?.bench === bench && shown.leftOut.length > 0 && (
        <p class="note" role="status">
          <code>{shown.leftOut.join(" ")}</code> {LAYOUT_TEXTS[language].leftOut}
        </p>
      )}
      {notice && (
        <p class="note" role="alert">
          {words.notices[notice]}{" "}
          <button type="button" onClick={() => control?.dismiss()}>
            {words.dismiss}
          </button>
        </p>
      )}
    </div>
  );
}
