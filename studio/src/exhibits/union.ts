// The outline of what many small faces cover together, as one path. Faces of one orientation add up, so an edge between two of them
// is no edge of it: thousands of pieces of a surface leave its rim and the few edges between pieces of different size.

/** A corner as it is written in the path, so that neighbours agree after rounding. */
type Corner = readonly [x: number, y: number];

/** The path around faces of so many corners each, whose coordinates `at` moves and rounds. */
export function unionPath(faces: Float32Array, corners: number, at: (x: number, y: number) => Corner): string {
  const edges = new Edges();
  for (let i = 0; i < faces.length; i += 2 * corners) {
    const places = Array.from({ length: corners }, (_, k) => at(faces[i + 2 * k]!, faces[i + 2 * k + 1]!));
    // In triangles, because the corners of a piece beside an outline may cross over.
    for (let k = 2; k < corners; k++) edges.add(places[0]!, places[k - 1]!, places[k]!);
  }
  return edges.path();
}

/** Directed edges, of which opposite ones cancel. */
class Edges {
  private readonly corners = new Map<string, Corner>();
  /** The ends of the edges from each corner, with how many there are. */
  private readonly from = new Map<string, Map<string, number>>();

  /** Adds a triangle's edges, turned to the left: where faces overlap, none takes another away. */
  add(a: Corner, b: Corner, c: Corner): void {
    const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if (area === 0) return;
    const [second, third] = area > 0 ? [b, c] : [c, b];
    this.edge(a, second);
    this.edge(second, third);
    this.edge(third, a);
  }

  private edge(a: Corner, b: Corner): void {
    const [from, to] = [`${a[0]} ${a[1]}`, `${b[0]} ${b[1]}`];
    this.corners.set(from, a);
    this.corners.set(to, b);
    if (!this.take(to, from)) this.change(from, to, 1);
  }

  /** Removes one edge; whether there was one. */
  private take(from: string, to: string): boolean {
    if (!this.from.get(from)?.has(to)) return false;
    this.change(from, to, -1);
    return true;
  }

  private change(from: string, to: string, by: number): void {
    const ends = this.from.get(from) ?? new Map<string, number>();
    const count = (ends.get(to) ?? 0) + by;
    if (count) ends.set(to, count);
    else ends.delete(to);
    if (ends.size) this.from.set(from, ends);
    else this.from.delete(from);
  }

  /** As many edges enter a corner as leave it, so each walk ends where it began. */
  path(): string {
    let d = "";
    for (let first = this.next(); first !== undefined; first = this.next()) {
      d += `M${first}`;
      let [at, last] = [first, this.corners.get(first)!];
      do {
        const to = this.from.get(at)!.keys().next().value!;
        this.change(at, to, -1);
        const corner = this.corners.get(to)!;
        d += `l${step(corner[0] - last[0])} ${step(corner[1] - last[1])}`;
        [at, last] = [to, corner];
      } while (at !== first);
      d += "z";
    }
    return d;
  }

  private next = (): string | undefined => this.from.keys().next().value;
}

/** Without the noise of binary fractions. */
const step = (value: number) => Math.round(value * 10) / 10;
