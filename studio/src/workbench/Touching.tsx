// Parts of a script's shape that only touch, as a finding: where, of which lines, what helps, and a button that goes there.
import type { Vec3 } from "../viewer";
import { PANEL_TEXTS } from "./panel_texts";
import { towards } from "./pixels";
import type { Certificate } from "./report";
import type { Page } from "./words";

/** A coordinate that is tiny beside the others is the rounding of the search, and shown as 0. */
const ROUNDING = 1e-6;
const rounded = (x: number, at: Vec3): number => (Math.abs(x) < ROUNDING * Math.max(...at.map(Math.abs)) ? 0 : x);

const contactsOf = ({ bound }: Certificate) => (bound?.open?.largest ?? []).flatMap(({ contact }) => (contact ? [contact] : []));

type Contact = ReturnType<typeof contactsOf>[number];

const spelled = (say: Page["say"], at: Vec3): string => at.map((x) => say.number(rounded(x, at))).join(", ");

/** The contacts of the same two lines together, each place once. */
export function byLines(contacts: readonly Contact[]): { lines: Contact["lines"]; places: Vec3[] }[] {
  const found = new Map<string, { lines: Contact["lines"]; places: Vec3[] }>();
  for (const { at, lines } of contacts) {
    const key = lines?.join() ?? "";
    const same = found.get(key);
    if (!same) found.set(key, { lines, places: [at] });
    else if (!same.places.some((one) => one.every((x, k) => Math.abs(x - at[k]!) <= ROUNDING * Math.max(...at.map(Math.abs))))) same.places.push(at);
  }
  return [...found.values()];
}

/** Whether some parts only touch. */
export const touches = (certificate: Certificate): boolean => contactsOf(certificate).length > 0 || (certificate.valid?.non_manifold_edges ?? 0) > 0;

export function Touching({ page, mark }: { page: Page; mark(places: readonly Vec3[]): void }) {
  const { say, state, control, language } = page;
  const words = PANEL_TEXTS[language];
  const { shown } = state;
  if (!shown || shown.isDraft || shown.bench !== state.bench) return null;
  const contacts = contactsOf(shown.certificate);
  const n = shown.certificate.valid?.non_manifold_edges ?? 0;
  if (!touches(shown.certificate)) return null;
  const go = (at: Vec3) => {
    const place = control!.sight.place(at);
    mark([place]);
    control!.look(towards(place, state.view, state.home));
  };
  return (
    <section class="panel findings touching">
      <h2>{words.touching}</h2>
      <ul>
        {byLines(contacts).map(({ lines, places: [first, ...others] }) => (
          <li key={lines?.join()} class="fault">
            <p>
              {words.touchingSays(spelled(say, first!), lines ? lines.map(String) : null)}
              {say.marks.gap}
              {words.touchingCure}
            </p>
            <div class="row tight">
              <button type="button" data-go="contact" onClick={() => go(first!)}>
                {words.goThere}
              </button>
              {others.map((at, k) => (
                <button type="button" key={at.join()} aria-label={words.goToPlace(k + 2)} onClick={() => go(at)}>
                  {k + 2}
                </button>
              ))}
            </div>
          </li>
        ))}
        {n > 0 && (
          <li class="fault">
            <p>
              {words.edgesSay(say.whole(n))}
              {!contacts.length && say.marks.gap + words.touchingCure}
            </p>
          </li>
        )}
      </ul>
    </section>
  );
}
