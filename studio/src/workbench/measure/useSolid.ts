// The solid of the parts that are shown, built in a worker when they have been shown for a moment; `null` until it is ready.
import { useEffect, useRef, useState } from "preact/hooks";
import type { Part } from "../glb";
import { type Solid, joined } from "./solid";

/** In milliseconds: longer than between two drafts, whose mesh would have to share the processor with a worker for each. */
const PAUSE = 250;

export function useSolid(parts: readonly Part[]): { readonly current: Solid | null; isReady: boolean } {
  const solid = useRef<Solid | null>(null);
  const [isReady, setReady] = useState(false);
  useEffect(() => {
    solid.current = null;
    setReady(false);
    if (!parts.length) return undefined;
    let worker: Worker | undefined;
    const timer = setTimeout(() => {
      worker = new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });
      worker.onmessage = ({ data }: MessageEvent<Solid>) => {
        solid.current = data;
        setReady(true);
        document.documentElement.dataset["solid"] = String(data.indices.length / 3);
        worker?.terminate();
      };
      const triangles = joined(parts);
      const { positions, indices, normals } = triangles;
      worker.postMessage(triangles, [positions.buffer, indices.buffer, ...(normals ? [normals.buffer] : [])]);
    }, PAUSE);
    return () => {
      clearTimeout(timer);
      delete document.documentElement.dataset["solid"];
      worker?.terminate();
    };
  }, [parts]);
  return { get current() { return solid.current; }, isReady };
}
