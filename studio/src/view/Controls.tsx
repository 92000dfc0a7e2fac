// The controls of the main figure: the number of segments, their spacing, and which strokes are drawn.
import type { Spacing } from "../core/types";
import { type Look, MOST_SEGMENTS, STOPS, stopOf, within } from "../state/state";
import { Clauses } from "./Clauses";
import { verdict } from "./Verdicts";
import { Choice, Figure, Slider } from "./parts";
import type { Page } from "./page";

const SPACINGS: readonly Spacing[] = ["even", "fewest"];
const LOOKS: readonly Look[] = ["both", "chain", "curve"];

export function Headline({ page }: { page: Page }) {
  const { say, state, answers } = page;
  const chain = answers.study[state.spacing];
  if (!chain.gap) return (
      <h2 class="headline">
        <Clauses text={say.text("headline.point")} />
      </h2>
    );
  const result = verdict(chain, state.goal);
  const values = { segments: say.segments(chain.segments), px: say.pixels(chain.gap.pixels) };
  return (
    <h2 class={`headline ${result}`}>
      <Clauses text={say.text(`headline.${result}`, values)} />
    </h2>
  );
}

export function Count({ page }: { page: Page }) {
  const { say, state, set, isPlaying, play } = page;
  const n = state.segments;
  const bounded = (n: number) => within(n, 1, MOST_SEGMENTS);
  const to = (change: (n: number) => number) =>
    set(({ segments }) => ({ segments: bounded(change(segments)), before: null }));
  // The previous number is kept for the comparison.
  const scale = (change: (n: number) => number) =>
    set(({ segments }) => ({ segments: bounded(change(segments)), before: segments }));
  const step = (key: "half" | "fewer" | "more" | "twice", sign: string, change: (n: number) => number, go: typeof to) => (
    <button
      type="button"
      aria-label={`${sign} ${say.text(`segments.${key}`)}`}
      title={say.text(`segments.${key}`)}
      disabled={bounded(change(n)) === n}
      onClick={() => go(change)}
    >
      {sign}
    </button>
  );
  const film = say.text(isPlaying ? "film.stop" : "film.play");
  return (
    <div class="count">
      <Slider
        id="segments"
        label={say.text("segments")}
        shown={n}
        spoken={say.segments(n)}
        low={0}
        high={STOPS.length - 1}
        value={stopOf(n)}
        choose={(stop) => to(() => STOPS[stop]!)}
      />
      <div class="steps">
        {step("half", "½×", (n) => Math.ceil(n / 2), scale)}
        {step("fewer", "−", (n) => n - 1, to)}
        <button type="button" class="film" aria-label={film} title={film} aria-pressed={isPlaying} onClick={play}>
          <svg viewBox="0 0 16 16" width="16" height="16" aria-hidden="true">
            <path d={isPlaying ? "M4 3h3v10H4zM9 3h3v10H9z" : "M4 2.5L13.5 8L4 13.5z"} />
          </svg>
        </button>
        {step("more", "+", (n) => n + 1, to)}
        {step("twice", "2×", (n) => n * 2, scale)}
      </div>
      <Halving page={page} />
    </div>
  );
}

/** How doubling or halving changed the gap; before that, the question. */
function Halving({ page }: { page: Page }) {
  const { say, state, answers } = page;
  const { other, ...study } = answers.study;
  const [old, now] = [other[state.spacing], study[state.spacing]];
  const times = other.times[state.spacing];
  // Until the answer arrives, the question stays.
  if (state.before === null || state.before !== other.segments || times === null || !old.gap || !now.gap) {
    return <p class="halving">{say.text("halving.ask", { n: state.segments, twice: state.segments * 2 })}</p>;
  }
  const isLess = now.gap.pixels < old.gap.pixels;
  return (
    <p class="halving told">
      {say.text("halving.counts", { from: old.segments, to: now.segments })}
      <Figure name="gap-before" value={old.gap.pixels}>
        {say.text("halving.gaps", { before: say.number(old.gap.pixels), now: say.number(now.gap.pixels) })}
      </Figure>{" "}
      <Figure name="times" value={times}>
        <b>{say.text(isLess ? "halving.less" : "halving.more", { times: say.times(times) })}</b>
      </Figure>
    </p>
  );
}

/** The switch between the annotated figure and plain strokes to be judged by eye. */
export function LookAt({ page }: { page: Page }) {
  const { say, state, set } = page;
  return (
    <div class="judging">
      <Choice
        name="look"
        legend={say.text("look")}
        value={state.look}
        options={LOOKS.map((value) => ({ value, label: say.text(`look.${value}`) }))}
        choose={(look) => set({ look })}
      />
      <button
        type="button"
        class="flip"
        aria-label={say.text("look.flip")}
        title={say.text("look.flip")}
        onClick={() => set(({ look }) => ({ look: look === "chain" ? "curve" : "chain" }))}
      >
        ⇄
      </button>
    </div>
  );
}

export function Where({ page }: { page: Page }) {
  const { say, state, set } = page;
  return (
    <Choice
      name="spacing"
      legend={say.text("spacing")}
      value={state.spacing}
      options={SPACINGS.map((value) => ({ value, label: say.text(`spacing.${value}`) }))}
      choose={(spacing) => set({ spacing })}
    />
  );
}
