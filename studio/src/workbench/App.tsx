// The workbench page: the picture over the whole window, panels that slide over it, and a line that always says what is proved.
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { PAINT } from "../exhibits/paint";
import { Mark, jump } from "../exhibits/Frame";
import { FRAME } from "../exhibits/frame_texts";
import { TAGS } from "../exhibits/say";
import { LESSON } from "../lesson/where";
import type { Vec3 } from "../viewer";
import { Themes } from "../view/Themes";
import { Certificate } from "./Certificate";
import type { Controller } from "./controller";
import { NO_SCREEN, isScript, isVolume, meshLine, shell, stem, textOf } from "./document";
import { Exports } from "./Exports";
import { Findings } from "./Findings";
import { Inputs } from "./Inputs";
import { Panel, PanelButtons } from "./layout/Panel";
import { Messages, Status } from "./layout/Status";
import { type PanelName, isPhone, useLayout, within } from "./layout/layout";
import { LAYOUT_TEXTS } from "./layout/texts";
import { Levels } from "./Levels";
import type { State } from "./state";
import { Steps } from "./Steps";
import { Beside, type Covered, Stage } from "./Stage";
import { gridStep } from "./stage/ground";
import { unitOf } from "./stage/unit";
import { Touching, touches } from "./Touching";
import { type Language, TEXTS } from "./texts";
import { facesOf, siteAt } from "./trace/faces";
import type { CallSite } from "./trace/shadow";
import { useWords } from "./words";

export interface Props {
  language: Language;
  state: State;
  /** `null` at build time. */
  control: Controller | null;
}

/** The heights of the bars above and below the picture, in pixels, as in the style sheet. */
const BARS = { top: 44, status: 34, tabs: 52 };

export function App({ language, state, control }: Props) {
  const words = TEXTS[language];
  const texts = LAYOUT_TEXTS[language];
  const say = useWords(language);
  const layout = useLayout(control !== null);
  const [marked, setMarked] = useState<readonly Vec3[]>([]);
  const [isOver, setOver] = useState(false);
  const { bench, inspection, shown, view } = state;
  useEffect(() => setMarked([]), [bench]);
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
  // The help lies over the picture: Escape and a press elsewhere close it.
  const about = useRef<HTMLDetailsElement>(null);
  useEffect(() => {
    const close = (event: Event) => {
      const isOther = event instanceof KeyboardEvent ? event.key === "Escape" : !about.current?.contains(event.target as Node);
      if (!about.current?.open || !isOther) return;
      // What is measured stays.
      if (event instanceof KeyboardEvent) event.preventDefault();
      about.current.open = false;
    };
    addEventListener("keydown", close, true);
    addEventListener("pointerdown", close, true);
    return () => {
      removeEventListener("keydown", close, true);
      removeEventListener("pointerdown", close, true);
    };
  }, []);
  // Between the script and the picture: the calls whose faces are marked, and the call to show in the text.
  const [chosen, setChosen] = useState<readonly CallSite[]>([]);
  const [reveal, setReveal] = useState<CallSite | null>(null);
  useEffect(() => setChosen([]), [bench]);
  const moved = (place: number) => {
    if (!control || !isScript(bench) || state.ended !== bench) return;
    const line = textOf(bench).slice(0, place).split("\n").length;
    void control.onDemand.trace().then((trace) => trace?.bench === control.state.bench && setChosen(trace.sites.filter((site) => site.line === line)));
  };
  const tapped = (at?: Vec3, normal?: Vec3) => {
    if (!at || !normal) return setChosen([]);
    void control?.onDemand.trace().then((trace) => {
      const site = trace?.bench === control.state.bench ? siteAt(trace, at, normal) : undefined;
      setChosen(site ? [site] : []);
      if (!site) return;
      if (!isPhone() && !layout.isOpen("input")) layout.toggle("input");
      setReveal(site);
    });
  };
  const show = (site: CallSite) => {
    if (!layout.isOpen("input")) layout.toggle("input");
    // A copy, so that the same call is shown again.
    setReveal({ ...site });
  };
  const page = { words, say, state, control, language, link: { reveal, moved } };

  const findings = isScript(bench) || isVolume(bench) ? null : (inspection?.findings ?? null);
  // Whoever opens a file with defects wants to see them; on a phone their number on the button has to do.
  useEffect(() => {
    if (findings?.length && !layout.layout.right && !isPhone()) layout.toggle("findings");
  }, [findings]);
  // Parts that only touch are said in the panel of the certificate.
  const hasContacts = shown?.bench === bench && !shown.isDraft && touches(shown.certificate);
  useEffect(() => {
    if (hasContacts && !layout.layout.right && !isPhone()) layout.toggle("certificate");
  }, [hasContacts]);
  const names: readonly PanelName[] = ["input", "certificate", ...(findings ? (["findings"] as const) : []), "beside", "change", "export"];
  const isOpen = (name: PanelName) => names.includes(name) && layout.isOpen(name);
  const isRightOpen = names.some((name) => name !== "input" && isOpen(name));
  useEffect(() => control?.showBeside(isOpen("beside")), [control, isOpen("beside")]);
  const { left, rightWidth, sheet, isLeftOpen } = layout.layout;
  const sizes = control
    ? { left: within("left", left), right: within("rightWidth", rightWidth), sheet: within("sheet", sheet) }
    : { left: 0, right: 0, sheet: 0 };
  // Through the object model: the page's policy blocks style attributes.
  useEffect(() => {
    const { style } = document.documentElement;
    style.setProperty("--left", `${sizes.left}px`);
    style.setProperty("--right", `${sizes.right}px`);
    style.setProperty("--sheet", `${sizes.sheet}px`);
  }, [sizes.left, sizes.right, sizes.sheet]);
  const covered: Covered = !control
    ? { left: 0, right: 0, top: 0, bottom: 0 }
    : isPhone()
      ? { left: 0, right: 0, top: BARS.top, bottom: BARS.status + BARS.tabs + (isLeftOpen || isRightOpen ? sizes.sheet : 0) }
      : { left: isLeftOpen ? sizes.left : 0, right: isRightOpen ? sizes.right : 0, top: BARS.top, bottom: BARS.status };

  const step = gridStep(view.distance);
  const unit = unitOf(shown?.certificate.frame.metres_per_unit ?? null);
  const extra = useMemo(() => (state.trace?.bench === bench && chosen.length ? facesOf(state.trace, chosen, PAINT.mark) : []), [state.trace, chosen]);
  return (
    <div
      class={`bench${isOver ? " over" : ""}${isLeftOpen ? " left-open" : ""}${isRightOpen ? " right-open" : ""}`}
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
        <h1>{words.title}</h1>
        <nav class="onward-links" aria-label={words.exhibits}>
          <a href={LESSON[language]}>{words.lesson}</a>
          <a href={language === "zh" ? "exhibits.zh.html" : "exhibits.html"}>{words.exhibits}</a>
        </nav>
        <details class="about" ref={about}>
          <summary>{texts.help}</summary>
          <div class="card">
            <p class="lead">{words.lead}</p>
            <p class="with-pointer">{texts.hint}</p>
            <p class="with-finger">{texts.hintTouch}</p>
            <p>{words.drop}</p>
            <p>{words.footer}</p>
          </div>
        </details>
        <Themes language={language} />
        <nav class="language" aria-label={FRAME[language].language}>
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
        {!control && (
          <noscript>
            <p class="lead">{words.lead}</p>
            <p class="note">
              {words.noScript} <code lang="en">{shell([meshLine(bench, NO_SCREEN, `${stem(bench.name)}.glb`)])}</code>
            </p>
          </noscript>
        )}
        <Stage page={page} marked={marked} layout={layout} covered={covered} step={step} unit={unit} extra={extra} tapped={tapped} chosen={chosen} show={show} />
        {/* After the picture, so that keys reach that within ten stops. */}
        <PanelButtons names={names} language={language} control={layout} counts={findings?.length ? { findings: say.whole(findings.length) } : {}} />
        <Panel name="input" language={language} control={layout}>
          <Inputs page={page} />
        </Panel>
        <Panel name="certificate" language={language} control={layout}>
          <Certificate page={page} mark={setMarked} />
          <Touching page={page} mark={setMarked} />
        </Panel>
        {findings && (
          <Panel name="findings" language={language} control={layout}>
            <Findings page={page} mark={setMarked} />
          </Panel>
        )}
        <Panel name="beside" language={language} control={layout}>
          <Beside page={page} />
        </Panel>
        <Panel name="change" language={language} control={layout}>
          <Levels page={page} />
          <Steps page={page} />
        </Panel>
        <Panel name="export" language={language} control={layout}>
          <Exports page={page} />
        </Panel>
        <Messages page={page} />
      </main>
      <Status page={page} control={layout} square={layout.layout.hasGrid && shown ? say.number(step) : ""} unit={unit} />
    </div>
  );
}
