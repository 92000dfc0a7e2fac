// A figure in space: the viewer where there is WebGL, the same layers as flat shapes before that, without it and on paper, and
// handles over both.
import { options } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import type { Children } from "./exhibit";
import { Grip } from "./Grip";
import {
  type Picture,
  type Projector,
  type Size,
  type Vec3,
  type View,
  control,
  createViewer,
  projector,
  still,
} from "../viewer";

/** A figure before it is measured. */
const STILL: Size = { width: 720, height: 480 };

/** A number that is moved along a line in space. */
export interface Pull {
  name: string;
  spoken: string;
  value: number;
  low: number;
  high: number;
  /** Of an arrow key. */
  step: number;
  at: Vec3;
  /** Where it would be with a value that is larger by 1. */
  along: Vec3;
  /** Changes it from what it is by then: keys may be faster than frames. */
  move(change: (value: number) => number): void;
}

interface SceneProps {
  name: string;
  /** Id of the text that says which keys turn it. */
  help: string;
  picture: Picture;
  view: View;
  home: View;
  look(view: View): void;
  isStill: boolean;
  pulls?: readonly Pull[];
  /** A press that was no drag. */
  tap?(at: Projector, x: number, y: number): void;
  /** What is drawn above it, in pixels. */
  over?(at: Projector): Children;
}

export function Scene(props: SceneProps) {
  const { name, help, picture, view, isStill, pulls, over } = props;
  const root = useRef<HTMLDivElement>(null);
  const stage = useRef<HTMLDivElement>(null);
  const viewer = useRef<Awaited<ReturnType<typeof createViewer>> | null>(null);
  const now = useRef(props);
  now.current = props;
  const [size, setSize] = useState(STILL);
  const [isLive, setLive] = useState(false);
  const [isPrinted, setPrinted] = useState(false);
  const sized = useRef(size);
  sized.current = size;

  useEffect(() => {
    const [element, place] = [root.current!, stage.current!];
    let isGone = false;
    const measure = () => {
      const { clientWidth: width, clientHeight: height } = element;
      if (width && height) setSize((old) => (old.width === width && old.height === height ? old : { width, height }));
    };
    const sizes = new ResizeObserver(measure);
    sizes.observe(element);
    measure();
    const free = control(element, {
      view: () => now.current.view,
      size: () => sized.current,
      get home() {
        return now.current.home;
      },
      look: (view) => {
        // Several moves of the hand may come before the page is drawn again.
        now.current = { ...now.current, view };
        now.current.look(view);
      },
      tap: (x, y) => now.current.tap?.(projector(now.current.view, sized.current), x, y),
    });
    createViewer(place).then(
      (made) => {
        if (isGone) return made.dispose();
        viewer.current = made;
        made.look(now.current.view);
        made.draw(now.current.picture);
        made.now();
        element.dataset["viewer"] = "webgl";
        setLive(true);
      },
      () => {
        element.dataset["viewer"] = "svg";
      },
    );
    return () => {
      isGone = true;
      sizes.disconnect();
      free();
      viewer.current?.dispose();
      viewer.current = null;
    };
  }, []);

  useEffect(() => {
    viewer.current?.look(view);
    viewer.current?.draw(picture);
  });

  // What WebGL has drawn is not printed. The browser prints what is there when it has told so.
  useEffect(() => {
    const paper = matchMedia("print");
    const print = (value: boolean) => () => atOnce(() => setPrinted(value));
    const [before, after] = [print(true), print(false)];
    const change = () => atOnce(() => setPrinted(paper.matches));
    addEventListener("beforeprint", before);
    addEventListener("afterprint", after);
    paper.addEventListener("change", change);
    return () => {
      removeEventListener("beforeprint", before);
      removeEventListener("afterprint", after);
      paper.removeEventListener("change", change);
    };
  }, []);

  const at = projector(view, size);
  const shapes = isLive && !isPrinted ? [] : still(picture, view, size);
  return (
    <div class="scene" ref={root} {...(isStill ? {} : { tabindex: 0, "aria-describedby": help })} role="group" aria-label={name}>
      <div class="gl" ref={stage} />
      <svg data-figure viewBox={`0 0 ${size.width} ${size.height}`} aria-hidden={isStill ? "true" : undefined}>
        {shapes.map(({ d, fill, stroke, width, opacity }, i) => (
          <path
            key={i}
            d={d}
            fill={fill ?? "none"}
            stroke={stroke}
            stroke-width={width}
            opacity={opacity}
            stroke-linecap="round"
            stroke-linejoin="round"
          />
        ))}
        {over?.(at)}
        {pulls?.map((pull) => (
          <Puller key={pull.name} pull={pull} at={at} isStill={isStill} />
        ))}
      </svg>
    </div>
  );
}

/** Draws what changes before it returns. */
function atOnce(change: () => void): void {
  const later = options.debounceRendering;
  options.debounceRendering = (draw) => draw();
  change();
  if (later) options.debounceRendering = later;
  else delete options.debounceRendering;
}

function Puller({ pull, at, isStill }: { pull: Pull; at: Projector; isStill: boolean }) {
  const [x, y] = at.to(pull.at);
  const [ax, ay] = at.to([0, 1, 2].map((k) => pull.at[k]! + 0.01 * (pull.along[k]! - pull.at[k]!)) as unknown as Vec3);
  // Pixels for a change of 1. A line that points at the eye is too short to be followed.
  const [wx, wy] = [(ax - x) * 100, (ay - y) * 100];
  const long = Math.max(wx * wx + wy * wy, 400);
  const within = (value: number) => Math.round(Math.min(Math.max(value, pull.low), pull.high) * 1000) / 1000;
  return (
    <Grip
      name={pull.name}
      spoken={pull.spoken}
      now={pull.value}
      low={pull.low}
      high={pull.high}
      at={[x, y]}
      along={(Math.atan2(wx, -wy) * 180) / Math.PI}
      isStill={isStill}
      grab={() => (dx, dy) => pull.move(() => within(pull.value + (dx * wx + dy * wy) / long))}
      step={(right, up) => pull.move((value) => within(value + (up || right) * pull.step))}
    />
  );
}
