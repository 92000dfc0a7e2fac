// The workbench page: the inputs at the left, the picture in the middle, certificate and findings at the right.
import { useEffect, useState } from "preact/hooks";
import { Mark, jump } from "../exhibits/Frame";
import { TAGS } from "../exhibits/say";
import { Themes } from "../view/Themes";
import { Certificate } from "./Certificate";
import type { Controller } from "./controller";
import { NO_SCREEN, meshLine, shell, stem } from "./document";
import { Exports } from "./Exports";
import { Findings } from "./Findings";
import { Inputs } from "./Inputs";
import { Levels } from "./Levels";
import type { State } from "./state";
import { Steps } from "./Steps";
import { Stage } from "./Stage";
import { type Language, TEXTS } from "./texts";
import { useWords } from "./words";

export interface Props {
  language: Language;
  state: State;
  /** `null` at build time. */
  control: Controller | null;
}

export function App({ language, state, control }: Props) {
  const words = TEXTS[language];
  const say = useWords(language);
  const [marked, setMarked] = useState<readonly (readonly [number, number, number])[]>([]);
  const [isOver, setOver] = useState(false);
  useEffect(() => setMarked([]), [state.bench]);
  useEffect(() => {
    if (!control) return;
    const key = (event: KeyboardEvent) => {
      const isText = event.target instanceof Element && event.target.closest("input, textarea, .script-editor");
      if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z" || isText) return;
      event.preventDefault();
      if (event.shiftKey) control.redo();
      else control.undo();
    };
    addEventListener("keydown", key);
    return () => removeEventListener("keydown", key);
  }, [control]);
  const page = { words, say, state, control, language };
  return (
    <div
      class={`page workbench${isOver ? " over" : ""}`}
      onDragOver={(event) => {
        event.preventDefault();
        setOver(true);
      }}
      onDragLeave={(event) => event.currentTarget.contains(event.relatedTarget as Node | null) || setOver(false)}
      onDrop={(event) => {
        event.preventDefault();
        setOver(false);
        void control?.open([...(event.dataTransfer?.files ?? [])]);
      }}
    >
      <a class="skip" href="#figure" onClick={jump}>
        {words.skip}
      </a>
      <header>
        <a class="brand" href={language === "zh" ? "zh.html" : "index.html"}>
          <Mark />
          {words.home}
        </a>
        <nav class="onward-links">
          <a href={language === "zh" ? "exhibits.zh.html" : "exhibits.html"}>{words.exhibits}</a>
        </nav>
        <Themes language={language} />
        <nav class="language">
          {(["en", "zh"] as const).map((other) => (
            <a
              key={other}
              href={(other === "en" ? "workbench.html" : "workbench.zh.html") + (control ? location.search : "") + (state.link ? `#s=${state.link}` : "")}
              lang={TAGS[other]}
              hreflang={TAGS[other]}
              {...(other === language ? { "aria-current": "true" as const } : {})}
            >
              {other === "en" ? "English" : "中文"}
            </a>
          ))}
        </nav>
      </header>
      <main>
        <div class="masthead">
          <h1>{words.title}</h1>
          <p class="lead">{words.lead}</p>
        </div>
        {!control && (
          <noscript>
            <p class="note">
              {words.noScript} <code lang="en">{shell([meshLine(state.bench, NO_SCREEN, `${stem(state.bench.name)}.glb`)])}</code>
            </p>
          </noscript>
        )}
        <div class="notes">
          {state.notice && (
            <p class="note" role="alert">
              {words.notices[state.notice]}{" "}
              <button type="button" onClick={() => control?.dismiss()}>
                {words.dismiss}
              </button>
            </p>
          )}
        </div>
        <div class="places">
          <Inputs page={page} />
          <Stage page={page} marked={marked} />
          <div class="known">
            <Certificate page={page} mark={setMarked} />
            <Findings page={page} mark={setMarked} />
            <Levels page={page} />
            <Steps page={page} />
          </div>
        </div>
        <Exports page={page} />
      </main>
      <footer>
        <p>{words.footer}</p>
      </footer>
    </div>
  );
}
