// A text of the command, with its language if that is not the page's, so that screen readers pronounce it correctly.
import { errorIn, type Spoken } from "./command_zh";
import type { Fault } from "./outcome";
import { type Language, TEXTS } from "./texts";

export const Said = ({ words: { text, lang } }: { words: Spoken }) => <span {...(lang ? { lang } : {})}>{text}</span>;

/** An error: what its code says in the page's language, and the command's sentence with its values. */
export const FaultSaid = ({ fault, language }: { fault: Fault; language: Language }) => (
  <>
    {errorIn(language, fault.code)} <span lang="en">{fault.text}</span>
    {fault.openedIn !== undefined && ` ${TEXTS[language].openedIn(fault.openedIn)}`}
  </>
);
