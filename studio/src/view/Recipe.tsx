// The formula for the number of segments and six lines of code that use it, beside the figure that it is about.
import { FRACTIONS } from "./Verdicts";
import { Figure } from "./parts";
import type { Page } from "./page";

/** Complete and runnable: a test runs it with the figure's points. */
export const CODE = `from math import ceil, sqrt
def polyline(p, gap):  # p: four points as complex numbers
    bend = 6 * max(abs(p[0] - 2*p[1] + p[2]), abs(p[1] - 2*p[2] + p[3]))
    n = max(1, ceil(sqrt(bend / (8 * gap))))
    at = lambda s, t: s*s*s*p[0] + 3*s*s*t*p[1] + 3*s*t*t*p[2] + t*t*t*p[3]
    return [at(1 - i/n, i/n) for i in range(n + 1)]`;

export function Recipe({ page }: { page: Page }) {
  const { say, state, answers } = page;
  const { formula, needed } = answers.study;
  const px = say.text("verdict.px", { n: FRACTIONS[state.goal]! });
  return (
    <div class="recipe">
      <h2>{say.text("recipe")}</h2>
      <Formula label={say.text("recipe.alt")} />
      <p>
        {say.text("recipe.why")}
        {say.text("recipe.here", { bend: say.number(formula.bend), px, gap: say.units(formula.length) })}{" "}
        <Figure name="formula-segments" value={formula.segments}>
          <b>N = {formula.segments}</b>
        </Figure>
        {needed.even === null ? say.text("recipe.stop") : say.text("recipe.more", { n: needed.even })}
      </p>
      <pre lang="en" tabIndex={0} aria-label={say.text("recipe.code")}>
        <code>{CODE}</code>
      </pre>
      <p class="aside">{say.text("recipe.source")}</p>
    </div>
  );
}

/** ε ≤ max |B″| / 8 N² */
function Formula({ label }: { label: string }) {
  return (
    <math display="block" aria-label={label}>
      <mi>ε</mi>
      <mo>≤</mo>
      <mfrac>
        <mrow>
          <mi>max</mi>
          <mo>|</mo>
          <mi>B″</mi>
          <mo>|</mo>
        </mrow>
        <mrow>
          <mn>8</mn>
          <msup>
            <mi>N</mi>
            <mn>2</mn>
          </msup>
        </mrow>
      </mfrac>
    </math>
  );
}
