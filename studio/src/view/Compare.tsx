// Equal steps beside the fewest segments, for the same number of segments: two small figures and a table.
import type { Spacing } from "../core/types";
import { Clauses } from "./Clauses";
import { CurveAndChain } from "./Drawing";
import { Frame, linePath, px } from "./frame";
import { Figure } from "./parts";
import type { Page } from "./page";

const SPACINGS: readonly Spacing[] = ["even", "fewest"];
/** Width of a small figure before the layout scales it. */
const WIDTH = 420;

export function Compare({ page }: { page: Page }) {
  const { say, answers, state } = page;
  const goal = say.text("verdict.px", { n: say.number(state.goal) });
  return (
    <>
      <h2 id="compare-title">
        <Clauses text={say.text("compare.title")} />
      </h2>
      <p>{say.text("compare.text", { segments: say.segments(state.segments) })}</p>
      <div class="pair">
        {SPACINGS.map((spacing) => (
          <SmallFigure key={spacing} page={page} spacing={spacing} />
        ))}
      </div>
      <details>
        <summary>{say.text("compare.caption")}</summary>
        <table class="numbers-table" aria-label={say.text("compare.caption")}>
          <thead>
            <tr>
              <td />
              {SPACINGS.map((spacing) => (
                <th key={spacing} scope="col">
                  {say.text(`compare.${spacing}`)}
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            <tr>
              <th scope="row">{say.text("compare.measured")}</th>
              {SPACINGS.map((spacing) => {
                const gap = answers.study[spacing].gap;
                return (
                  <td key={spacing}>
                    <Figure name={`${spacing}-gap-pixels`} value={gap?.pixels ?? 0}>
                      {say.pixels(gap?.pixels ?? 0)}
                    </Figure>
                    <small>{say.units(gap?.distance ?? 0)}</small>
                  </td>
                );
              })}
            </tr>
            <tr>
              <th scope="row">{say.text("compare.proved")}</th>
              {SPACINGS.map((spacing) => {
                const { pixels, at_most } = answers.study[spacing].bound;
                return (
                  <td key={spacing}>
                    <Figure name={`${spacing}-bound-pixels`} value={pixels}>
                      {pixels === null ? "–" : say.pixels(pixels)}
                    </Figure>
                    <small>{at_most === null ? "–" : say.units(at_most)}</small>
                  </td>
                );
              })}
            </tr>
            <tr>
              <th scope="row">{say.text("compare.needed", { px: goal })}</th>
              {SPACINGS.map((spacing) => (
                <td key={spacing}>{answers.study.needed[spacing] ?? say.text("needed.none")}</td>
              ))}
            </tr>
          </tbody>
        </table>
        <p class="aside">{say.text("compare.why")}</p>
      </details>
    </>
  );
}

function SmallFigure({ page, spacing }: { page: Page; spacing: Spacing }) {
  const { say, answers } = page;
  const chain = answers.study[spacing];
  const frame = new Frame(WIDTH);
  const gap = chain.gap;
  const ends = gap && ([frame.to(gap.on_curve), frame.to(gap.on_polyline)] as const);
  const how = say.text(`compare.${spacing}`);
  return (
    <figure class={spacing}>
      <svg
        class="drawing small"
        viewBox={`0 0 ${WIDTH} ${px(frame.height)}`}
        role="img"
        aria-label={say.text("compare.alt", { how, px: say.pixels(gap?.pixels ?? 0) })}
      >
        <CurveAndChain control={answers.study.control} chain={chain} frame={frame} />
        {ends && (
          <g class="gap">
            <circle class="ring" cx={px((ends[0][0] + ends[1][0]) / 2)} cy={px((ends[0][1] + ends[1][1]) / 2)} r="12" />
            <path class="needle" d={linePath(ends)} />
          </g>
        )}
      </svg>
      <figcaption>{how}</figcaption>
    </figure>
  );
}
