// How good the chain is: its measured gap, its proved bound, whether that is smooth, and how many segments suffice.
import type { Chain, Spacing } from "../core/types";
import { type Density, GOALS, MOST_SEGMENTS } from "../state/state";
import { Choice, Figure } from "./parts";
import type { Page } from "./page";

export type Verdict = "smooth" | "seen" | "open";

/** `smooth` if proved, `seen` if the measured gap is larger than the goal, otherwise `open`. */
export function verdict(chain: Chain, goal: number): Verdict {
  if (chain.bound.pixels !== null && chain.bound.pixels <= goal) return "smooth";
  return chain.gap !== null && chain.gap.pixels > goal ? "seen" : "open";
}

const SPACINGS: readonly Spacing[] = ["even", "fewest"];
const MARKS: Record<Verdict, string> = { smooth: "✓", seen: "✕", open: "?" };
export const FRACTIONS: Record<number, string> = { 1: "1", 0.5: "½", 0.25: "¼" };

export function Readout({ page }: { page: Page }) {
  const { say, state, answers } = page;
  const chain = answers.study[state.spacing];
  const { gap, bound } = chain;
  return (
    <div class="readout">
      <h3>{say.text("gap")}</h3>
      <p class={`big ${gap ? verdict(chain, state.goal) : ""}`}>
        <Figure name="gap-pixels" value={gap?.pixels ?? 0}>
          {say.pixels(gap?.pixels ?? 0)}
        </Figure>
      </p>
      <dl class="plain">
        <dt>{say.text("gap.measured")}</dt>
        <dd>
          <Figure name="gap-units" value={gap?.distance ?? 0}>
            {say.units(gap?.distance ?? 0)}
          </Figure>
        </dd>
        <dt>{say.text("gap.proved")}</dt>
        <dd>
          <Figure name="bound-units" value={bound.at_most}>
            {bound.at_most === null ? "–" : say.units(bound.at_most)}
          </Figure>
        </dd>
      </dl>
      <p class="aside">{say.text("gap.apart", { n: say.number((bound.at_most ?? 0) - (gap?.distance ?? 0)) })}</p>
    </div>
  );
}

export function Verdicts({ page }: { page: Page }) {
  const { say, state, answers, set } = page;
  const chain = answers.study[state.spacing];
  const options = GOALS.map((value) => {
    const result = verdict(chain, value);
    const extra = (
      <small class={result} data-verdict={result}>
        <i aria-hidden="true">{MARKS[result]}</i> {say.text(`verdict.${result}`)}
      </small>
    );
    return { value, label: <b>{say.text("verdict.px", { n: FRACTIONS[value]! })}</b>, extra };
  });
  return (
    <Choice class="verdicts" name="goal" legend={say.text("verdict")} value={state.goal} options={options} choose={(goal) => set({ goal })} />
  );
}

export function Needed({ page }: { page: Page }) {
  const { say, state, answers, set } = page;
  const goal = say.text("verdict.px", { n: FRACTIONS[state.goal]! });
  return (
    <div class="needed">
      <h3>{say.text("needed", { px: goal })}</h3>
      <ul>
        {SPACINGS.map((spacing) => {
          const n = answers.study.needed[spacing];
          const how = say.text(`needed.${spacing}`);
          return (
            <li key={spacing}>
              <button
                type="button"
                disabled={n === null || n > MOST_SEGMENTS}
                {...(n === null ? {} : { title: say.text("needed.show", { segments: say.segments(n), how }) })}
                onClick={() => n !== null && set({ segments: n, before: null, spacing })}
              >
                <Figure name={`needed-${spacing}`} value={n}>
                  {n === null ? say.text("needed.none") : say.segments(n)}
                </Figure>{" "}
                <span>{how}</span>
              </button>
            </li>
          );
        })}
      </ul>
      <Exception page={page} />
    </div>
  );
}

/** With equal steps a larger number of segments may be worse, because its vertices may be in less useful places. */
function Exception({ page }: { page: Page }) {
  const { say, state, answers } = page;
  const { even, even_fails, even_from } = answers.study.needed;
  if (even === null || even_fails === null || even_fails.pixels === null || even_from === null) return null;
  const values = { n: even, fails: even_fails.segments, px: say.pixels(even_fails.pixels), from: even_from };
  return (
    <p class="aside exception">
      {say.text(even_fails.pixels > state.goal ? "needed.exception" : "needed.unproved", values)}
      <data data-name="even-fails-pixels" value={String(even_fails.pixels)} />
    </p>
  );
}

export function Screen({ page }: { page: Page }) {
  const { say, state, around, set } = page;
  const options = ([0, 1, 2, 3] as const).map((value) => ({
    value: value as Density,
    label: say.text(value === 0 ? "density.own" : "density.other", { n: value === 0 ? say.number(around.ownDensity) : value }),
  }));
  return (
    <div class="screen">
      <Choice name="density" legend={say.text("density")} value={state.density} options={options} choose={(density) => set({ density })} />
      <p class="aside">{say.text("density.help")}</p>
    </div>
  );
}
