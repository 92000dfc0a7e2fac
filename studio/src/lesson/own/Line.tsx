// The line at the top of the lesson: which shape travels along, and the way back to the teapot alone.
import { STATIONS } from "../outline";
import type { OwnShape } from "./shape";
import type { OwnTexts } from "./texts";

export function Line({ own, words }: { own: OwnShape; words: OwnTexts }) {
  if (!own.shape) return <p role="status" />;
  return (
    <>
      <p role="status">{words.travels(own.shape.name)}</p>
      <p class="own-ways">
        <a href={`#own-${STATIONS[0].id}`}>{words.first}</a>
        <button type="button" data-own-back onClick={() => own.leave()}>
          {words.back}
        </button>
      </p>
      {own.isKept === false && <p class="aside">{words.notKept}</p>}
    </>
  );
}
