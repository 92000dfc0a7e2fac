// The solid of the parts that are shown, built in a worker; `null` until it is ready.
import { useEffect, useRef, useState } from "preact/hooks";
import type { Part } from "../glb";
import { type Solid, joined } from "./solid";

export function useSolid(parts: readonly Part[]): { readonly current: Solid | null; isReady: boolean } {
  const solid = useRef<Solid | null>(null);
  const [isReady, setReady] = useState(false);
  useEffect(() => {
    solid.current = null;
    setReady(false);
    if (!parts.length) return undefined;
    const worker = new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });
    worker.onmessage = ({ data }: MessageEvent<Solid>) => {
      solid.current = data;
      setReady(true);
      document.documentElement.dataset["solid"] = String(data.indices.length / 3);
      worker.terminate();
    };
    const triangles = joined(parts);
    worker.postMessage(triangles, [triangles.positions.buffer, triangles.indices.buffer, ...(triangles.normals ? [triangles.normals.buffer] : [])]);
    return () => {
      delete document.documentElement.dataset["solid"];
      worker.terminate();
    };
  }, [parts]);
  return { get current() { return solid.current; }, isReady };
}
