// What is wrong with a mesh that was opened, where, and what cures it.
import type { Vec3 } from "../viewer";
import { Working } from "./Certificate";
import { cureIn, joining, nameIn, sentenceIn } from "./command_zh";
import { isScript, isVolume, stem } from "./document";
import { Said } from "./Said";
import type { Page } from "./words";

export function Findings({ page, mark }: { page: Page; mark(places: readonly Vec3[]): void }) {
  const { words, say, state, control, language } = page;
  const { bench, inspection } = state;
  const findings = inspection?.findings;
  if (!findings || isScript(bench) || isVolume(bench)) return null;
  const cure = (options: readonly string[]) => void control?.step("mend", options, `${stem(bench.name)}-mended.${endingOf(bench.name)}`);
  const curable = findings.some(({ cures }) => cures.length > 0);
  return (
    <section class="panel findings">
      <h2>{words.findings}</h2>
      {findings.length === 0 && <p class="good">{words.sound}</p>}
      <ul>
        {findings.map((finding) => {
          const here = state.witnesses.filter(({ of }) => of === finding.of);
          return (
            <li key={finding.of} class={finding.weight}>
              <p>
                <b>
                  {say.whole(finding.count)} <Said words={nameIn(language, finding)} />
                </b>
                <Said words={sentenceIn(language, finding.means)} />
              </p>
              {finding.advice && (
                <p class="aside">
                  <Said words={sentenceIn(language, finding.advice)} />
                </p>
              )}
              <div class="row tight">
                {here.length > 0 && (
                  <button
                    type="button"
                    onClick={() => {
                      const places = here.map(({ at }) => control?.place(at) ?? at);
                      mark(places);
                      control?.look({ ...state.view, target: places[0]! });
                    }}
                  >
                    {words.showPlaces(say.whole(here.length), here.length < finding.count)}
                  </button>
                )}
                {[...finding.cures, ...joining(finding.means)].map((option) => (
                  <button type="button" key={option} data-cure={option} onClick={() => cure([option])}>
                    {words.cure(cureIn(language, option))}
                  </button>
                ))}
              </div>
            </li>
          );
        })}
      </ul>
      {curable && findings.length > 1 && (
        <button type="button" onClick={() => cure(["--all"])}>
          {words.cureAll}
        </button>
      )}
      <Working page={page} lanes={["step"]} />
    </section>
  );
}

/** The ending of what a cure writes: that of the input where it can be written so. */
const endingOf = (name: string): string => /\.(glb|stl|ply|obj|off|3mf)$/i.exec(name)?.[1]?.toLowerCase() ?? "glb";
