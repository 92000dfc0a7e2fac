// Whether this browser keeps a shape for the lesson: a word that is read at once, without opening what has the bytes.
const KEY = "chordal.own";

export function isMarked(): boolean {
  try {
    return localStorage.getItem(KEY) !== null;
  } catch {
    return false;
  }
}

export function mark(isKept: boolean): void {
  try {
    if (isKept) localStorage.setItem(KEY, "1");
    else localStorage.removeItem(KEY);
  } catch {
    // Then a reload has the teapot alone.
  }
}
