// Runs the first picture: plays it once, and stops when the reader takes the handle.
import { render } from "preact";
import { keepShapes } from "../exhibits/kept";
import type { Language } from "../exhibits/say";
import type { Size } from "../viewer";
import { HeroBench, type HeroState, REST, START, STILL_STEP } from "./Hero";
import type { Words } from "./lesson";
import { unpacked } from "./teapot_levels";

/** The way back takes this long. Chosen: the page answers its own question within ten seconds. */
const PLAY_MS = 7500;

export async function heroLive(element: HTMLElement, language: Language): Promise<void> {
  const response = await fetch(element.dataset["hero"]!);
  if (!response.ok) return;
  const levels = unpacked(await response.arrayBuffer());
  const words = wordsOf(JSON.parse(element.dataset["words"]!) as Record<string, string>);
  const isCalm = matchMedia("(prefers-reduced-motion: reduce)").matches;
  let state: HeroState = { ...START, step: isCalm ? STILL_STEP : 0 };
  let [frame, playing, isAwake] = [0, 0, true];
  let size: Size = { width: 720, height: 480 };
  let isDrawn = false;

  function draw(): void {
    frame ||= requestAnimationFrame(() => {
      frame = 0;
      if (!isDrawn) {
        keepShapes(element);
        element.replaceChildren();
      }
      isDrawn = true;
      const set = (change: Partial<HeroState>) => {
        stop();
        state = { ...state, ...change };
        draw();
      };
      render(
        <HeroBench
          levels={levels}
          state={state}
          language={language}
          words={words}
          size={size}
          isStill={false}
          isAwake={isAwake}
          set={set}
          play={play}
        />,
        element,
      );
      element.dataset["live"] = isAwake ? "awake" : "asleep";
    });
  }
  function stop(): void {
    cancelAnimationFrame(playing);
    playing = 0;
    delete element.dataset["playing"];
  }
  function play(): void {
    stop();
    let start: number | undefined;
    element.dataset["playing"] = "1";
    const tick = (now: number) => {
      start ??= now;
      const share = Math.min((now - start) / PLAY_MS, 1);
      const step = Math.round(share * REST);
      if (step !== state.step || state.isFull) {
        state = { ...state, step, isFull: false };
        draw();
      }
      if (share < 1 && isAwake) playing = requestAnimationFrame(tick);
      else stop();
    };
    playing = requestAnimationFrame(tick);
  }

  new ResizeObserver(() => {
    const scene = element.querySelector(".scene");
    if (!scene?.clientWidth || (scene.clientWidth === size.width && scene.clientHeight === size.height)) return;
    size = { width: scene.clientWidth, height: scene.clientHeight };
    draw();
  }).observe(element);
  new IntersectionObserver(([entry]) => {
    isAwake = entry!.isIntersecting;
    draw();
  }).observe(element);
  element.addEventListener("pointerdown", stop);
  element.addEventListener("keydown", stop);
  draw();
  if (!isCalm) play();
}

/** The patterns of the page as functions again. */
function wordsOf(patterns: Record<string, string>): Words {
  const filled =
    (name: string) =>
    (...values: string[]) =>
      patterns[name]!.replace(/\{(\d)\}/g, (_, i: string) => values[Number(i)] ?? "");
  const functions = Object.fromEntries(["seenFrom", "enough", "spokenAt", "all"].map((name) => [name, filled(name)]));
  return { ...patterns, ...functions } as unknown as Words;
}
