// What is measured: over the picture as lines and numbers, and in a card as text.
import type { Projector, Vec3 } from "../../viewer";
import { evidenceOf, isKnown } from "../Certificate";
import type { BoundFacts } from "../report";
import type { Page } from "../words";
import { MEASURE_TEXTS } from "./texts";
import type { Measures, Result } from "./useMeasures";

/** A number in single precision has about so many digits. */
const MOST_DIGITS = 6;

/** A length or an angle, with what it may be off by if that is known. */
export function sizeOfResult({ say }: Page, { of, value, isBounded }: Result, bound: BoundFacts | null | undefined, unit: string): string {
  if (of === "angle") return say.degrees(Math.round(value * 100) / 100);
  const plusMinus = isBounded && bound && isKnown(bound) && bound.at_most !== null ? 2 * bound.at_most : null;
  const whole = Math.max(Math.ceil(Math.log10(Math.max(value, 1e-30))), 1);
  // One digit below the error, and none that single precision does not have.
  const wanted = plusMinus === null ? 4 - whole : plusMinus === 0 ? MOST_DIGITS : 1 - Math.floor(Math.log10(plusMinus));
  const text = say.fixed(value, Math.min(Math.max(wanted, 0), Math.max(MOST_DIGITS - whole, 0)));
  return `${text}${plusMinus === null ? "" : ` ± ${say.number(plusMinus)}`}${unit && ` ${unit}`}`;
}

const path = (at: Projector, points: readonly Vec3[]): string =>
  points
    .map((point) => at.to(point))
    .filter(([, , depth]) => depth > 0)
    .map(([x, y], i) => `${i ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`)
    .join("");

export function MeasureMarks({ page, at, measures, unit, centre }: { page: Page; at: Projector; measures: Measures; unit: string; centre: readonly [number, number] }) {
  const { tool, spots, hovered, results } = measures;
  const bound = page.state.shown?.certificate.bound;
  return (
    <g class="measures" aria-hidden="true">
      {results.map((result, i) => {
        const [x, y] = at.to(result.at);
        return (
          <g key={i}>
            {result.lines.map((points, k) => (
              <path key={k} d={path(at, points)} />
            ))}
            <text x={x.toFixed(1)} y={(y - 6).toFixed(1)}>
              {result.of === "cylinder" || result.of === "radius" ? "R " : ""}
              {sizeOfResult(page, result, bound, unit)}
            </text>
          </g>
        );
      })}
      {spots.map((spot, i) => {
        const [x, y] = at.to(spot.at);
        return <circle key={i} class="set" cx={x.toFixed(1)} cy={y.toFixed(1)} r={5} />;
      })}
      {spots.length === 1 && hovered && <path class="open" d={path(at, [spots[0]!.at, hovered.at])} />}
      {hovered && <Mark at={at} point={hovered.at} on={hovered.on} />}
      {tool && <path class="cross" d={`M${centre[0] - 9} ${centre[1]}h18M${centre[0]} ${centre[1] - 9}v18`} />}
    </g>
  );
}

/** The shape of the mark says to what it snapped: a square to a corner, a rhombus to an edge, a ring on a face. */
function Mark({ at, point, on }: { at: Projector; point: Vec3; on: "vertex" | "edge" | "face" }) {
  const [x, y] = at.to(point);
  const d = { vertex: "M-6-6h12v12h-12z", edge: "M0-8L8 0L0 8L-8 0z", face: "M-5 0a5 5 0 1 0 10 0a5 5 0 1 0-10 0" }[on];
  return <path class={`snap on-${on}`} d={d} transform={`translate(${x.toFixed(1)} ${y.toFixed(1)})`} />;
}

export function MeasureCard({ page, measures, unit, isReady }: { page: Page; measures: Measures; unit: string; isReady: boolean }) {
  const { say, state, language } = page;
  const { tool, spots, results, wrong } = measures;
  const texts = MEASURE_TEXTS[language];
  if (!tool && !results.length) return null;
  const bound = state.shown?.certificate.bound;
  const isProved = bound && isKnown(bound) && bound.at_most !== null;
  return (
    <div class="card measure-card">
      {tool && <p role="status">{!isReady ? texts.building : `${wrong ? `${texts.wrong[wrong]} ` : ""}${texts.ask[tool][spots.length]}`}</p>}
      {results.length > 0 && (
        <ol aria-live="polite">
          {results.map((result, i) => (
            <li key={i} data-result={result.of} data-value={result.value}>
              {texts.results[result.of]} <b>{sizeOfResult(page, result, bound, unit)}</b>
              {(result.of === "radius" || result.of === "cylinder") && `, ${texts.diameter(sizeOfResult(page, { ...result, value: 2 * result.value }, bound, unit))}`}
            </li>
          ))}
        </ol>
      )}
      {results.some(({ isBounded }) => isBounded) && (
        <p class="aside">{isProved ? texts.basis(`${say.number(bound.at_most!)}${unit && ` ${unit}`}`, evidenceOf(page, bound)) : texts.basisUnknown}</p>
      )}
      {results.some(({ isBounded }) => !isBounded) && <p class="aside">{texts.basisAngle}</p>}
      {tool && !results.length && <p class="aside by-keys">{texts.keys}</p>}
      {(results.length > 0 || spots.length > 0) && (
        <button type="button" onClick={() => measures.clear()}>
          {texts.clear}
        </button>
      )}
    </div>
  );
}
