// A 3D figure with handles over it: the viewer with WebGL; the same layers as flat shapes until it is ready, without WebGL,
// and in print.
import { createContext, options } from "preact";
import { useContext, useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import type { Children } from "./exhibit";
import { Grip } from "./Grip";
import { takeShapes } from "./kept";
import { Scope } from "../view/parts";
import {
  type Camera,
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

/** The size before the figure is measured. */
const STILL: Size = { width: 720, height: 480 };

/** Whether scenes are drawn as thumbnails of the list. */
export const Thumbnails = createContext(false);

/**
 * Whether the figure is in sight. A browser allows some eight to sixteen WebGL contexts, so in a page of many figures those out
 * of sight give theirs back and leave a copy of their last picture.
 */
export const Awake = createContext(true);

/** A number that is moved along a line in space. */
export interface Pull {
  name: string;
  spoken: string;
  value: number;
  low: number;
  high: number;
  /** The step of an arrow key. */
  step: number;
  at: Vec3;
  /** Its position for a value that is larger by 1. */
  along: Vec3;
  /** Changes the value at that time, which may be newer than `value`: keys may be faster than frames. */
  move(change: (value: number) => number): void;
}

interface SceneProps {
  name: string;
  /** Id of the text that lists the keys that turn it. */
  help: string;
  picture: Picture;
  view: View;
  home: View;
  look(view: View): void;
  isStill: boolean;
  /** Whether the view is not the reader's to turn, such as that of a camera on a path. */
  isFixed?: boolean;
  pulls?: readonly Pull[];
  /** Called after a press without a drag. */
  tap?(at: Projector, x: number, y: number): void;
  /** An overlay, in pixels. */
  over?(at: Projector): Children;
  /** Where the target is drawn, in pixels right of the middle and below it. */
  shift?: readonly [number, number];
  /** Listens for the reader's hands, in place of a figure's usual ones; returns what ends it. */
  steer?(element: HTMLElement, camera: Camera): () => void;
}

export function Scene(props: SceneProps) {
  const { name, help, picture, view, isStill, isFixed, pulls, over, shift } = props;
  const scope = useContext(Scope);
  const isAwake = useContext(Awake);
  const root = useRef<HTMLDivElement>(null);
  const stage = useRef<HTMLDivElement>(null);
  const viewer = useRef<Awaited<ReturnType<typeof createViewer>> | null>(null);
  const latest = useRef(props);
  latest.current = props;
  const [size, setSize] = useState(STILL);
  const [viewerState, setViewerState] = useState<"loading" | "live" | "missing">("loading");
  const [kept] = useState(takeShapes);
  const [isPrinted, setPrinted] = useState(() => globalThis.matchMedia?.("print").matches ?? false);
  const shownSize: Size = shift ? { ...size, shift } : size;
  const latestSize = useRef(shownSize);
  latestSize.current = shownSize;

  useEffect(() => {
    const element = root.current!;
    const measure = () => {
      const { clientWidth: width, clientHeight: height } = element;
      if (width && height) setSize((old) => (old.width === width && old.height === height ? old : { width, height }));
    };
    const sizeObserver = new ResizeObserver(measure);
    sizeObserver.observe(element);
    measure();
    const camera: Camera = {
      view: () => latest.current.view,
      size: () => latestSize.current,
      get home() {
        return latest.current.home;
      },
      look: (view) => {
        // Several moves may arrive before the next rendering, so the view must be current.
        latest.current = { ...latest.current, view };
        latest.current.look(view);
      },
      tap: (x, y) => latest.current.tap?.(projector(latest.current.view, latestSize.current), x, y),
    };
    const free = latest.current.isFixed ? () => undefined : (latest.current.steer ?? control)(element, camera);
    return () => {
      sizeObserver.disconnect();
      free();
    };
  }, []);

  useEffect(() => {
    if (!isAwake) return;
    const [element, container] = [root.current!, stage.current!];
    const copy = container.querySelector("canvas");
    let isGone = false;
    createViewer(container).then(
      (created) => {
        if (isGone) return created.dispose();
        viewer.current = created;
        created.look(latest.current.view, latest.current.shift);
        created.draw(latest.current.picture);
        created.now();
        copy?.remove();
        element.dataset["viewer"] = "webgl";
        setViewerState("live");
      },
      () => {
        element.dataset["viewer"] = "svg";
        setViewerState("missing");
      },
    );
    return () => {
      isGone = true;
      const { current } = viewer;
      viewer.current = null;
      if (!current) return;
      const last = copied(current.now());
      current.dispose();
      container.append(last);
      element.dataset["viewer"] = "asleep";
    };
  }, [isAwake]);

  // Not after the next frame, which would show the old shape once more.
  useLayoutEffect(() => {
    viewer.current?.look(view, shift);
    viewer.current?.draw(picture);
  });

  // WebGL pictures are not printed, so flat shapes replace them. They must be there when the `beforeprint` listener returns.
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

  // On paper there are no panels beside which the target would be drawn.
  const shownAs = isPrinted ? size : shownSize;
  const at = projector(view, shownAs);
  const isThumbnail = useContext(Thumbnails);
  const isKept = kept && viewerState === "loading" && !isPrinted;
  const shapes = isKept || (viewerState === "live" && !isPrinted) ? [] : still(picture, view, shownAs, isThumbnail);
  // As the projection does: about the middle, so that all of it fits.
  const scale = Math.min(size.width / STILL.width, size.height / STILL.height);
  const [left, top] = [0.5 * (size.width - scale * STILL.width), 0.5 * (size.height - scale * STILL.height)];
  return (
    <div class="scene" ref={root} {...(isStill || isFixed ? {} : { tabindex: 0, "aria-describedby": scope + help })} role="group" aria-label={name}>
      <div class="gl" ref={stage} />
      <svg data-figure viewBox={`0 0 ${size.width} ${size.height}`} aria-hidden={isStill ? "true" : undefined}>
        <g stroke-linecap="round" stroke-linejoin="round" fill="none">
          {shapes.map(({ d, fill, stroke, width, opacity }, i) => (
            <path key={i} d={d} fill={fill} stroke={stroke} stroke-width={width} opacity={opacity} />
          ))}
        </g>
        {isKept && <g transform={`translate(${left} ${top}) scale(${scale})`} ref={(g) => g?.append(kept)} />}
        {over?.(at)}
        {pulls?.map((pull) => (
          <PullHandle key={pull.name} pull={pull} at={at} isStill={isStill} />
        ))}
      </svg>
    </div>
  );
}

/** A copy of a picture that needs no WebGL. */
function copied(canvas: HTMLCanvasElement): HTMLCanvasElement {
  const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
  copy.getContext("2d")!.drawImage(canvas, 0, 0);
  copy.setAttribute("aria-hidden", "true");
  return copy;
}

/** Renders synchronously. */
function atOnce(change: () => void): void {
  const scheduleRendering = options.debounceRendering;
  options.debounceRendering = (draw) => draw();
  change();
  if (scheduleRendering) options.debounceRendering = scheduleRendering;
  else delete options.debounceRendering;
}

function PullHandle({ pull, at, isStill }: { pull: Pull; at: Projector; isStill: boolean }) {
  const [x, y] = at.to(pull.at);
  // A hundredth of the way, over which perspective hardly bends.
  const [ax, ay] = at.to([0, 1, 2].map((k) => pull.at[k]! + 0.01 * (pull.along[k]! - pull.at[k]!)) as unknown as Vec3);
  // Pixels for a change of 1. A line towards the eye is very short, hence the lower limit.
  const [wx, wy] = [(ax - x) * 100, (ay - y) * 100];
  const lengthSq = Math.max(wx * wx + wy * wy, 400);
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
      grab={() => (dx, dy) => pull.move(() => within(pull.value + (dx * wx + dy * wy) / lengthSq))}
      step={(right, up) => pull.move((value) => within(value + (up || right) * pull.step))}
    />
  );
}
