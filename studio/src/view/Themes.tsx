// The choice of colours, on every page. public/theme.js applies it, before anything is drawn.
import type { Language, Theme } from "../state/state";

const THEMES: readonly Theme[] = ["auto", "light", "dark"];
const WORDS: Record<Language, Record<Theme | "name", string>> = {
  en: { name: "Colours", auto: "As the system", light: "Light", dark: "Dark" },
  zh: { name: "配色", auto: "跟随系统", light: "浅色", dark: "深色" },
};

export function Themes({ language, change }: { language: Language; change?(theme: Theme): void }) {
  const words = WORDS[language];
  return (
    <label class="theme">
      <span>{words.name}</span>
      <select data-themes ref={show} onChange={change && ((event) => change(event.currentTarget.value as Theme))}>
        {THEMES.map((theme) => (
          <option key={theme} value={theme}>
            {words[theme]}
          </option>
        ))}
      </select>
    </label>
  );
}

/** Selects the theme that the page has already. */
function show(select: HTMLSelectElement | null): void {
  if (select) select.value = document.documentElement.dataset["theme"] ?? "auto";
}
