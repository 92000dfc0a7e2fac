// What the command says, marked with its language where that is not the page's, so that it is read out as what it is.
import type { Spoken } from "./command_zh";

export const Said = ({ words: { text, lang } }: { words: Spoken }) => <span {...(lang ? { lang } : {})}>{text}</span>;
