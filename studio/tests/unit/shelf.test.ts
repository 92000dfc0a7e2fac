// The shelf: kept, named, deleted and restored; refused and full storage; and what the panels ask for.
import { describe, expect, test } from "vitest";
import { optionOf, withOption } from "../../src/workbench/Asks";
import { bench, withText } from "../../src/workbench/document";
import { lackOf, suits, supplied, withFont } from "../../src/workbench/lack";
import { MOST, Shelf, type Store, cleaned } from "../../src/workbench/shelf";

const of = (name: string, text: string) => bench(`${name}.star`, { [`${name}.star`]: new TextEncoder().encode(text) });

class Memory implements Store {
  readonly values = new Map<string, string>();
  getItem = (key: string) => this.values.get(key) ?? null;
  setItem = (key: string, value: string) => void this.values.set(key, value);
}

function shelf(store: Store | null = new Memory()): Shelf {
  let id = 0;
  return new Shelf(store, () => undefined, () => `id${++id}`);
}

describe("a script on the shelf", () => {
  test("follows the bench, and is there again after a reload", () => {
    const store = new Memory();
    const first = shelf(store);
    const kept = first.keep(of("bracket", "sphere(1)"));
    first.follow(kept);
    first.follow({ ...withText(kept, "sphere(2)"), set: { r: "3" } });
    const back = shelf(store).last()!;
    expect(back).toMatchObject({ name: "bracket.star", set: { r: "3" }, kept: "id1" });
    expect(new TextDecoder().decode(back.files["bracket.star"])).toBe("sphere(2)");
  });
  test("is not overwritten by a shared script of the same name, and is found again if that is the same", () => {
    const store = new Memory();
    const one = shelf(store);
    one.follow(one.keep(of("bracket", "sphere(1)")));
    const shared = one.known(of("bracket", "box(1, 2, 3)"));
    expect(shared.kept).toBeUndefined();
    one.follow(withText(shared, "box(3, 2, 1)"));
    expect(one.state.scripts.map(({ text }) => text)).toEqual(["sphere(1)"]);
    expect(one.known(of("bracket", "sphere(1)")).kept).toBe("id1");
  });
  test("has a name of its own, also when it is renamed and duplicated", () => {
    const one = shelf();
    const kept = one.keep(of("gear", "sphere(1)"));
    expect(one.keep(of("gear", "sphere(1)")).name).toBe("gear 2.star");
    expect(one.keep(kept).name).toBe("gear 3.star");
    expect(one.rename("id2", "gear")).toBeNull();
    expect(one.rename("id2", " ../wheel/a:b ")?.name).toBe("wheelab.star");
    expect(one.rename("id2", "  ")).toBeNull();
    expect(cleaned("part.star")).toBe("part");
  });
  test("that was deleted comes back to its place", () => {
    const one = shelf();
    for (const name of ["a", "b", "c"]) one.keep(of(name, name));
    one.remove("id2");
    expect(one.state.scripts.map(({ name }) => name)).toEqual(["c", "a"]);
    one.restore();
    expect(one.state.scripts.map(({ name }) => name)).toEqual(["c", "b", "a"]);
    expect(one.state.deleted).toBeNull();
  });
  test("knows whether a file has it as it is", () => {
    const one = shelf();
    const kept = one.keep(of("a", "sphere(1)"));
    one.savedToFile("id1", "sphere(1)");
    expect(one.of(kept)?.saved).toBe("sphere(1)");
    one.follow(withText(kept, "sphere(2)"));
    expect(one.of(kept)).toMatchObject({ saved: "sphere(1)", text: "sphere(2)" });
  });
});

describe("a storage", () => {
  test("that is refused, throws or is full is said, and the scripts stay on the page", () => {
    expect(shelf(null).state.fault).toBe("refused");
    const refusing = shelf({ getItem: () => null, setItem: () => { throw new Error("no"); } });
    refusing.keep(of("a", "sphere(1)"));
    expect(refusing.state).toMatchObject({ fault: "refused", scripts: [{ name: "a" }] });
    const full = shelf({ getItem: () => null, setItem: () => { throw new DOMException("", "QuotaExceededError"); } });
    full.keep(of("a", "sphere(1)"));
    expect(full.state.fault).toBe("full");
    const long = shelf();
    long.keep(of("a", "#".repeat(MOST)));
    expect(long.state.fault).toBe("full");
    long.remove("id1");
    expect(long.state.fault).toBeNull();
  });
  test("remembers the one script that was changed last without being kept", () => {
    const store = new Memory();
    const first = shelf(store);
    expect(first.unkept()).toBeNull();
    const changed = { ...of("hook", "box(1, 2, 3)"), set: { r: "2" }, options: "--unit mm" };
    first.note(changed);
    first.note(bench("part.stl", { "part.stl": new Uint8Array(3) }));
    expect(shelf(store).unkept()).toEqual(changed);
    // Once it is on the shelf it is there.
    first.note(first.keep(changed));
    expect(shelf(store).unkept()).toBeNull();
    for (const text of ["{", "[]", '{"name":7}']) {
      store.setItem("chordal.unkept", text);
      expect(shelf(store).unkept(), text).toBeNull();
    }
  });
  test("with anything else in it is an empty shelf", () => {
    for (const text of ["", "{", "[]", '{"v":2,"scripts":[]}', '{"v":1,"scripts":[{"id":7}]}']) {
      const store = new Memory();
      store.setItem("chordal.shelf", text);
      expect(shelf(store).state.scripts, text).toEqual([]);
    }
  });
});

test("a font is named in the call of text in a line, and nowhere else", () => {
  const script = 'a = text("A")\nb = text("Hi, all", tolerance=0.1)\n';
  expect(withFont(script, 2, "my font.ttf")).toBe('a = text("A")\nb = text("Hi, all", "my font.ttf", tolerance=0.1)\n');
  expect(withFont(script, 1, "f.ttf")).toContain('a = text("A", "f.ttf")\n');
  expect(withFont("box(1)", 3, "f.ttf")).toContain("box(1)");
});

test("what a script lacks is taken from files that suit it, under the name in the script, and from no others", () => {
  const script = of("sign", 'a = text("A", "font.ttf", 0.1)\nextrude(a, 2)');
  const fault = { text: "'font.ttf' cannot be used: no such file or directory", line: 1 };
  const lack = lackOf({ bench: script, fault })!;
  const bytes = Uint8Array.of(1, 2);
  expect(lack).toEqual({ name: "font.ttf", isFont: true, line: 1 });
  expect(suits(lack, ["DejaVuSans.otf"])).toBe(true);
  expect(Object.keys(supplied(script, lack, { "DejaVuSans.otf": bytes }).files)).toEqual(["sign.star", "font.ttf"]);
  expect(supplied(script, lack, { "font.ttf": bytes, "a.svg": bytes }).files).toMatchObject({ "font.ttf": bytes, "a.svg": bytes });
  for (const others of [["part.stl"], ["other.star"], ["a.ttf", "b.ttf"], []]) expect(suits(lack, others), others.join()).toBe(false);
  const library = lackOf({ bench: script, fault: { text: "'lib.star' cannot be loaded: no such file or directory" } })!;
  expect([suits(library, ["lib.star"]), suits(library, ["part.star"])]).toEqual([true, false]);
  const unnamed = lackOf({ bench: of("sign", 'text("A")'), fault: { text: "Missing named-only parameter `font` for call to `text`", line: 1 } })!;
  const named = supplied(of("sign", 'text("A")'), unnamed, { "f.ttf": bytes });
  expect(new TextDecoder().decode(named.files["sign.star"])).toBe('text("A", "f.ttf")');
  expect(lackOf({ bench: script, fault: { text: "Variable `a` not found" } })).toBeNull();
  expect(lackOf({ bench: bench("a.stl", {}), fault })).toBeNull();
});

test("options are read, set and removed in the text of all of them", () => {
  expect(optionOf("--iso -3 --unit mm", "--iso")).toBe("-3");
  expect(optionOf('--text="A b"', "--text")).toBe("A b");
  expect(optionOf("--em 3", "--text")).toBeNull();
  expect(withOption("--iso -3 --unit mm", "--iso", "60")).toBe("--unit mm --iso 60");
  expect(withOption("", "--text", "A b")).toBe('--text "A b"');
  expect(withOption("--iso 60", "--iso", null)).toBe("");
});
