// The field of a script as the graphics card draws it: at once from every view, while the core's picture of the same view is
// being traced. It lies over that picture, and leaves it to be seen when it is ready.
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { control, createViewer, fieldProgram } from "../viewer";
import type { Children } from "../exhibits/exhibit";
import type { Page } from "./words";

/** The colours of the core's pictures. */
const CLAY = { front: "#db8654", back: "#547ea8" };
/** A longer text is not compiled: the core's picture is soon there, and a browser may take half a minute. */
const MOST_CODE = 400_000;

type Viewer = Awaited<ReturnType<typeof createViewer>>;

/** `children` is the core's picture; `isCurrent` says whether it is of this script and this view. */
export function LiveField({ page, isCurrent, drawn, children }: { page: Page; isCurrent: boolean; drawn(isDrawn: boolean): void; children: Children }) {
  const { state, words } = page;
  const { view } = state;
  const root = useRef<HTMLDivElement>(null);
  const latest = useRef(page);
  latest.current = page;
  const [viewer, setViewer] = useState<Viewer | null>(null);
  const [isDrawn, setDrawn] = useState(false);
  const source = state.field?.source ?? null;
  const program = useMemo(() => (viewer && source && source.length <= MOST_CODE ? fieldProgram(source, viewer.uniformVectors) : null), [source, viewer]);

  useEffect(() => {
    const element = root.current!;
    const stage = element.querySelector<HTMLElement>(".card-picture")!;
    let isGone = false;
    let created: Viewer | null = null;
    const free = control(element, {
      view: () => latest.current.state.view,
      size: () => ({ width: element.clientWidth, height: element.clientHeight }),
      get home() {
        return latest.current.state.home;
      },
      look: (next) => latest.current.control?.look(next),
    });
    createViewer(stage).then(
      (made) => {
        const isWanted = !made.isSoftware || new URLSearchParams(location.search).has("live");
        if (isGone || !isWanted) return made.dispose();
        created = made;
        setViewer(made);
      },
      // Without WebGL, and if the processor would draw, the core's picture is all there is.
      () => undefined,
    );
    return () => {
      isGone = true;
      free();
      created?.dispose();
    };
  }, []);

  const report = useRef(drawn);
  report.current = drawn;
  const tell = useRef((now: boolean) => {
    setDrawn(now);
    report.current(now);
  });
  const code = program?.code ?? null;
  // Another program is compiled first, and the core's picture is there meanwhile.
  useEffect(() => tell.current(false), [code]);
  useEffect(() => {
    viewer?.look(view);
    const layer = program && ({ kind: "field", id: "field", program, paint: CLAY.front, back: CLAY.back, light: "studio", drawn: tell.current } as const);
    viewer?.draw({ layers: layer ? [layer] : [] });
  }, [viewer, program, view]);

  const isLive = isDrawn && !isCurrent;
  return (
    <div class="live-field" ref={root} tabindex={0} role="group" aria-label={words.besides.traced} aria-describedby="turn-hint" data-live={isDrawn ? "" : undefined}>
      {children}
      <div class="card-picture" data-shown={isLive ? "" : undefined} />
    </div>
  );
}
