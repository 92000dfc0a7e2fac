// The command's sentences about mistakes and failures, in Chinese.
import { JOB_SENTENCES } from "./jobs_zh";
import { translator } from "./match";
import { KINDS, NOTES, SCRIPT_SENTENCES } from "./script_zh";
import { QUANTITIES, SHAPE_SENTENCES } from "./shapes_zh";
import { VERIFY_SENTENCES } from "./verify_zh";

export const SENTENCES_ZH = { ...SCRIPT_SENTENCES, ...SHAPE_SENTENCES, ...JOB_SENTENCES, ...VERIFY_SENTENCES };
export const KINDS_ZH = { ...KINDS, ...QUANTITIES };

/** The Chinese of a sentence, or nothing if it is not known. */
export const chineseOf = (english: string): string | undefined => known(english.replace(/ \(see --help\)$/, ""));
const known = translator(SENTENCES_ZH, KINDS_ZH);

/** The Chinese of a line that a function adds to what its script prints; a line of the script itself stays as it is. */
export const noteOf = translator(NOTES, {});
