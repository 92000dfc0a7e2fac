// The defects of a mesh that was opened, their places, and their repairs.
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
    <div class="findings">
      {findings.length === 0 && <p class="good">{words.sound}</p>}
      <ul>
        {findings.map((finding) => {
          const witnesses = state.witnesses.filter(({ of }) => of === finding.of);
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
                {witnesses.length > 0 && (
                  <button
                    type="button"
                    onClick={() => {
                      const places = witnesses.map(({ at }) => control?.place(at) ?? at);
                      mark(places);
                      control?.look({ ...state.view, target: places[0]! });
                    }}
                  >
                    {words.showPlaces(say.whole(witnesses.length), witnesses.length < finding.count)}
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
    </div>
  );
}

/** The ending of the mended file: that of the input if the command can write it. */
const endingOf = (name: string): string => /\.(glb|stl|ply|obj|off|3mf)$/i.exec(name)?.[1]?.toLowerCase() ?? "glb";
