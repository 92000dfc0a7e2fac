// The defects of a mesh that was opened, their places, and their repairs.
import type { Vec3 } from "../viewer";
import { Working } from "./Certificate";
import { adviceIn, cureIn, joining, meaningIn, nameIn } from "./command_zh";
import { isScript, isVolume, stem } from "./document";
import { towards } from "./pixels";
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
          const places = state.witnesses.filter(({ of }) => of === finding.of).map(({ at }) => control?.sight.place(at) ?? at);
          const advice = adviceIn(language, finding);
          const show = (at: Vec3) => {
            mark(places);
            control?.look(towards(at, state.view, state.home));
          };
          return (
            <li key={finding.of} class={finding.weight}>
              <p>
                <b>
                  {say.whole(finding.count)} <Said words={nameIn(language, finding)} />
                </b>
                <Said words={meaningIn(language, finding)} />
              </p>
              {advice && (
                <p class="aside">
                  <Said words={advice} />
                </p>
              )}
              <div class="row tight">
                {places.length > 0 && (
                  <button type="button" onClick={() => show(places[0]!)}>
                    {words.showPlaces(say.whole(places.length), places.length < finding.count)}
                  </button>
                )}
                {places.length > 1 &&
                  places.map((at, k) => (
                    <button type="button" key={k} aria-label={words.place(k + 1)} onClick={() => show(at)}>
                      {k + 1}
                    </button>
                  ))}
                {[...finding.cures, ...joining(finding.sentences)].map((option) => (
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
