// Two pictures of one thing, pixel by pixel, of which a button shows one in the other's place; or their difference. Drawn and
// compared by the core.
import { Row } from "../view/parts";
import { bitmap } from "./bitmap";
import type { Language, Say } from "./say";

/** Two pictures by the core. */
export interface Pair {
  width: number;
  height: number;
  /** The coarse one, the fine one, their difference. */
  pictures: readonly [Uint32Array, Uint32Array, Uint32Array];
  /** Pixels that show the shape; that only one of them covers; that differ at all; that differ so that an eye could tell; the
   * largest difference, of 255. */
  covered: number;
  outline: number;
  differ: number;
  seen: number;
  largest: number;
}

export const SIDES = ["coarse", "fine", "difference"] as const;
export type Side = (typeof SIDES)[number];

const WORDS: Record<Language, { flip: string; difference: string; outline: string; differ: string; seen: string; largest: string; of(n: string, all: string): string; ofTones: string }> = {
  en: {
    flip: "Flip between the two",
    difference: "the difference, 16 times as dark",
    outline: "Pixels in one outline alone",
    differ: "that differ at all",
    seen: "that differ by more than an eye can tell",
    largest: "Largest difference of a tone",
    of: (n, all) => `${n} of ${all}`,
    ofTones: "of 255",
  },
  zh: {
    flip: "在两幅之间切换",
    difference: "两者之差，加深 16 倍",
    outline: "只在一幅轮廓内的像素",
    differ: "有任何差别的",
    seen: "差别超过眼睛所能分辨的",
    largest: "明暗的最大差别",
    of: (n, all) => `${all} 个中的 ${n} 个`,
    ofTones: "（共 255 级）",
  },
};

interface Props {
  pair: Pair;
  side: Side;
  /** What each of the two is. */
  names: readonly [coarse: string, fine: string];
  /** CSS pixels for each pixel of the pictures. */
  scale: number;
  say: Say;
  isStill: boolean;
  choose(side: Side): void;
}

export function SamePicture({ pair, side, names, scale, say, isStill, choose }: Props) {
  const words = WORDS[say.language];
  const of = SIDES.indexOf(side);
  const name = [...names, words.difference][of]!;
  const cached = pictureOf(pair, of);
  return (
    <figure class="same">
      <div>
        <img src={bitmap(cached)} width={pair.width * scale} height={pair.height * scale} alt={name} />
      </div>
      <figcaption aria-live="polite">{name}</figcaption>
      {!isStill && (
        <div class="buttons">
          <button type="button" onClick={() => choose(side === "coarse" ? "fine" : "coarse")}>
            ⇄ {words.flip}
          </button>
          <button type="button" aria-pressed={side === "difference"} onClick={() => choose(side === "difference" ? "coarse" : "difference")}>
            {words.difference}
          </button>
        </div>
      )}
      <dl>
        {(
          [
            ["outline", words.outline, pair.outline],
            ["differ", words.differ, pair.differ],
            ["seen", words.seen, pair.seen],
          ] as const
        ).map(([key, label, count]) => (
          <Row key={key} name={key} label={label} value={count}>
            {words.of(say.whole(count), say.whole(pair.covered))}
          </Row>
        ))}
        <Row name="largest" label={words.largest} value={pair.largest}>
          {`${say.whole(pair.largest)} ${words.ofTones}`}
        </Row>
      </dl>
    </figure>
  );
}

/** The same object for the same picture, since bitmaps are cached by it. */
const greys = new WeakMap<Uint32Array, { width: number; height: number; grey: Uint32Array }>();
function pictureOf({ width, height, pictures }: Pair, of: number) {
  const grey = pictures[of]!;
  if (!greys.has(grey)) greys.set(grey, { width, height, grey });
  return greys.get(grey)!;
}
