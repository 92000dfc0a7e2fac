// A text of the command, with its language if that is not the page's, so that screen readers pronounce it correctly.
import type { Spoken } from "./command_zh";

export const Said = ({ words: { text, lang } }: { words: Spoken }) => <span {...(lang ? { lang } : {})}>{text}</span>;
