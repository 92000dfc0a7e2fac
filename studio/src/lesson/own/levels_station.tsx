// The levels of an own shape: as it is seen from a distance, at its true size, and the triangles that this takes, held up close.
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { FRAME } from "../../exhibits/frame_texts";
import { Scene } from "../../exhibits/Scene";
import { Hint } from "../../view/Hint";
import { Figure as Data, Slider } from "../../view/parts";
import type { Size } from "../../viewer";
import { focal } from "../../viewer/view";
import { layersOf } from "../../workbench/stage/layers";
import { Live, Rows, Station, type StationPage, isGood } from "./parts";

/** The part of the picture's height that the shape fills at most. */
const FILLED = 0.9;

export function Levels({ page }: { page: StationPage }) {
  const { own, words, say } = page;
  const [mesh, run] = [own.mesh, own.levels];
  const facts = run?.made?.certificate.levels;
  // From near to far; from nearer than where the box is a screen high, nothing is seen of it as a whole.
  const stops = useMemo(() => [...(facts?.shown ?? [])].sort((a, b) => a.distance - b.distance), [facts]);
  const [stop, setStop] = useState<number | null>(null);
  const step = Math.min(stop ?? Math.floor(stops.length / 2), stops.length - 1);
  const seen = stops[step];
  const level = seen && facts!.levels[seen.level]!;
  const parts = seen && run!.made!.levels[seen.level];
  const layers = useMemo(
    () => (parts ? { near: layersOf(parts, "wire", [], 1), far: layersOf(parts, "shaded", [], 1) } : { near: [], far: [] }),
    [parts],
  );
  return (
    <Station
      page={page}
      runs={[mesh, run]}
      figure={<Halves page={page} layers={layers} covers={seen?.covers_px ?? 0} />}
    >
      {seen && (
        <>
          <Slider
            id="own-distance"
            label={words.distance}
            shown={say.number(seen.distance)}
            spoken={words.spokenAt(say.number(seen.distance), say.whole(seen.triangles))}
            low={0}
            high={stops.length - 1}
            value={step}
            choose={setStop}
          />
          <Live
            label={words.shown}
            name="shown-triangles"
            value={seen.triangles}
            shown={say.whole(seen.triangles)}
            isGood={isGood(level)}
          />
          <Rows
            page={page}
            rows={[
              [words.level, "shown-level", seen.level],
              [words.size, "covers", seen.covers_px],
              [words.shownOff, "shown-off", seen.pixels],
            ]}
          />
          <p class="aside own-screen">{words.screen(facts!.view.width_px, facts!.view.height_px)}</p>
          <table class="own-levels">
            <thead>
              <tr>
                {[words.level, words.triangles, words.off, words.from].map((name) => (
                  <th key={name} scope="col">
                    {name}
                  </th>
                ))}
              </tr>
            </thead>
            <tbody>
              {facts!.levels.map(({ triangles, at_most, distance }, k) => (
                <tr key={k} {...(k === seen.level ? { "aria-current": "true" as const } : {})}>
                  <th scope="row">{say.whole(k)}</th>
                  {([["triangles", triangles, say.whole(triangles)], ["off", at_most, at_most === null ? "–" : say.number(at_most)], ["from", distance, say.number(distance)]] as const).map(
                    ([name, value, shown]) => (
                      <td key={name}>
                        <Data name={`own-level-${k}-${name}`} value={value}>
                          {shown}
                        </Data>
                      </td>
                    ),
                  )}
                </tr>
              ))}
            </tbody>
          </table>
        </>
      )}
    </Station>
  );
}

interface HalvesProps {
  page: StationPage;
  layers: Record<"near" | "far", ReturnType<typeof layersOf>>;
  /** The diagonal of the shape on the screen, in pixels. */
  covers: number;
}

function Halves({ page, layers, covers }: HalvesProps) {
  const { id, own, words, language } = page;
  const { view, home, diagonal } = own;
  const half = useRef<HTMLDivElement>(null);
  const [size, setSize] = useState<Size>({ width: 300, height: 300 });
  useEffect(() => {
    const measure = () => {
      const { clientWidth: width, clientHeight: height } = half.current!.querySelector(".scene")!;
      if (width && height) setSize((old) => (old.width === width && old.height === height ? old : { width, height }));
    };
    const observer = new ResizeObserver(measure);
    observer.observe(half.current!);
    return () => observer.disconnect();
  }, []);
  const most = FILLED * Math.min(size.width, size.height);
  const drawn = Math.max(Math.min(covers, most), 1);
  // So far away that the diagonal is as long as the command says.
  const far = { ...view, target: home.target, distance: (focal(size) * diagonal) / drawn };
  const turn = (next: typeof view) => own.look({ ...own.view, azimuth: next.azimuth, elevation: next.elevation });
  const hint = `own-${id}-hint`;
  return (
    <div class="stage">
      <div class="own-halves">
        <div ref={half}>
          <Scene name={words.trueSize} help={hint} picture={{ layers: layers.far }} view={far} home={far} look={turn} isStill={false} />
          <p class="aside">
            {words.trueSize}
            {covers > most && `. ${words.clipped}`}
          </p>
        </div>
        <div>
          <Scene name={words.upClose} help={hint} picture={{ layers: layers.near }} view={view} home={home} look={(next) => own.look(next)} isStill={false} />
          <p class="aside">{words.upClose}</p>
        </div>
      </div>
      <p class="aside hint" id={hint}>
        <Hint text={FRAME[language].turn} />
      </p>
    </div>
  );
}
