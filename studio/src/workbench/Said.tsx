// A text of the command, with its language if that is not the page's, so that screen readers pronounce it correctly.
import { type Spoken, faultIn } from "./command_zh";
import type { Fault } from "./outcome";
import { type Language, TEXTS } from "./texts";

export const Said = ({ words: { text, lang } }: { words: Spoken }) => <span {...(lang ? { lang } : {})}>{text}</span>;

/** An error, in the page's language as far as it is known there. */
export const FaultSaid = ({ fault, language }: { fault: Fault; language: Language }) => {
  const said = faultIn(language, fault);
  return (
    <>
      {said.lead && `${said.lead} `}
      <Said words={said} />
      {fault.openedIn !== undefined && ` ${TEXTS[language].openedIn(fault.openedIn)}`}
    </>
  );
};
