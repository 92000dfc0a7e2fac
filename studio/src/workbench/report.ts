// The part of a report that the page reads; see docs/schema/report.schema.json.
import type { Vec3 } from "../viewer";
import type { Source } from "./carried";
import type { Sentence } from "./command_zh";

export interface BoundFacts {
  at_least: number;
  at_most: number | null;
  pixels: number | null;
  evidence: "proved" | "proved-if" | "measured" | "estimated";
  assumptions?: readonly string[];
  samples?: number;
  reference: string;
  at?: Vec3 | null;
  /** The places where a proof did not end; where surfaces touch, the point and the lines of the script. */
  open?: { largest: readonly { contact?: { kind: "tangent" | "flush"; at: Vec3; lines?: readonly [number, number] } }[] } | null;
}

export interface LevelFacts {
  triangles: number;
  at_least: number;
  at_most: number | null;
  evidence: BoundFacts["evidence"];
  distance: number;
}

/** What is shown from a distance. */
export interface ShownFacts {
  distance: number;
  /** The diagonal of the box on the screen, in pixels. */
  covers_px: number;
  level: number;
  triangles: number;
  /** No point is farther off; null where the eye is too close for a bound. */
  pixels: number | null;
}

/** The error of one attribute after simplification: the largest that was found, which is no upper bound. */
export interface AttributeFacts {
  semantic: "normal" | "tangent" | "texcoord" | "color" | "custom";
  name: string;
  largest: number | null;
  unit: "degrees" | "value";
}

export interface Certificate {
  input?: { warnings?: readonly { code: string; message: string }[] };
  frame: { up: string | null; metres_per_unit: number | null };
  budget: { length: number | null; pixels: number | null; triangles: number | null } | null;
  bound: BoundFacts | null;
  output: { triangles?: number; vertices?: number; positions?: number; segments?: number } | null;
  valid: { closed: boolean; manifold: boolean; oriented: boolean; components: number; genus: number | null; triangles_per_vertex?: number | null; in_place?: boolean; non_manifold_edges?: number; witnesses?: readonly { of: string; at: Vec3 }[] } | null;
  attributes?: readonly AttributeFacts[];
  levels?: { pixels: number; view: { width_px: number; height_px: number }; levels: readonly LevelFacts[]; shown: readonly ShownFacts[] };
  baked?: { size: readonly [number, number, number]; origin: Vec3; spacing: number; off_at_most: number | null; evidence: BoundFacts["evidence"] };
  /** The bounds of all steps since the shape itself, added up. */
  history?: { total: Pick<BoundFacts, "at_least" | "at_most" | "evidence" | "assumptions"> | null };
  overshade?: { in_view: number; missed: number; micro: number; covered_px: number; every: { lanes: number } };
  notes: readonly string[];
  /** The scripts that the file carries. */
  sources?: readonly Source[];
}

export interface FindingFacts {
  of: string;
  count: number;
  weight: "fault" | "remark";
  words: string;
  means: string;
  sentences?: readonly Sentence[];
  cures: readonly string[];
  advice: string | null;
  advice_code?: string | null;
}

export interface Inspection {
  bytes: number;
  box: readonly [Vec3, Vec3] | null;
  parts: readonly { name: string; triangles: number }[] | null;
  field: { parameters: readonly { name: string; default: number; value: number }[]; terms: number; outside: string; inside: string } | null;
  /** Bytes of positions and indices. */
  sizes?: { indexed_bytes: number; unindexed_bytes: number } | null;
  findings: readonly FindingFacts[] | null;
  volume?: { low: number | null; high: number | null; labels: number | null; suggested: { level: number } | null } | null;
  /** The certificate that the file carries. */
  found?: { certificate: Partial<Certificate> } | null;
}

export interface Report {
  certificate?: Certificate;
  inspection?: Inspection;
  run?: { input_triangles?: number };
  error?: { code: string; messages: readonly string[] };
}
