// One disc, written down both ways: a list of points, and a rule with a sign for any point. A still, because nothing of it moves:
// each answer has its own figures later.

/** Corners of an octagon in a circle of radius 1, in hundredths, which is all that the list shows. */
const CORNERS = [[100, 0], [71, 71], [0, 100], [-71, 71], [-100, 0], [-71, -71], [0, -100], [71, -71]] as const;
const RADIUS = 84;
const MIDDLE = 110;
/** Between the signs. Chosen: none of them is on the circle. */
const STEP = 34;
const ROWS = [-3, -2, -1, 0, 1, 2, 3];
const SIGNS = ROWS.flatMap((row) => ROWS.map((column) => [STEP * column, STEP * row] as const));

const at = (hundredths: number) => MIDDLE + (RADIUS * hundredths) / 100;
const shown = (hundredths: number) => (hundredths / 100).toFixed(2).replace("-", "−");

export function TwoAnswers({ points, rule }: { points: string; rule: string }) {
  return (
    <div class="two-answers">
      <figure>
        <svg viewBox="0 0 360 220" aria-hidden="true">
          <path class="disc" d={`M${CORNERS.map(([x, y]) => `${at(x)} ${at(-y)}`).join("L")}z`} />
          {CORNERS.map(([x, y], i) => (
            <g key={i}>
              <circle class="corner" cx={at(x)} cy={at(-y)} r="4" />
              <text class="name" x={at(1.17 * x)} y={at(-1.17 * y) + 4}>
                {i}
              </text>
              <text class="row" x="252" y={30 + 23 * i}>
                <tspan class="name">{i}</tspan>
                <tspan x="306">{shown(x)}</tspan>
                <tspan x="358">{shown(y)}</tspan>
              </text>
            </g>
          ))}
        </svg>
        <figcaption>{points}</figcaption>
      </figure>
      <figure>
        <svg viewBox="0 0 360 220" aria-hidden="true">
          <circle class="disc" cx={MIDDLE} cy={MIDDLE} r={RADIUS} />
          {SIGNS.map(([x, y]) => {
            const isInside = Math.hypot(x, y) < RADIUS;
            return (
              <text key={`${x} ${y}`} class={isInside ? "sign inside" : "sign"} x={MIDDLE + x} y={MIDDLE + y + 5}>
                {isInside ? "−" : "+"}
              </text>
            );
          })}
          <text class="rule" x="238" y="104">
            f(x, y) =
          </text>
          <text class="rule" x="238" y="128">
            √(x² + y²) − 1
          </text>
        </svg>
        <figcaption>{rule}</figcaption>
      </figure>
    </div>
  );
}
