// A line of text that counts when it is entered. What is being typed stays: the page is drawn anew with every step of a run, and
// would put the old value back.
import { useState } from "preact/hooks";

interface TextFieldProps {
  value: string;
  /** Called with the text when it was changed and the field is left, or Enter is pressed. */
  enter(text: string): void;
  label?: string;
  inputMode?: "text" | "decimal";
  maxLength?: number;
  /** What the field asks for, for programs. */
  ask?: string;
}

export function TextField({ value, enter, label, inputMode, maxLength, ask }: TextFieldProps) {
  const [typed, setTyped] = useState<string | null>(null);
  return (
    <input
      type="text"
      spellcheck={false}
      value={typed ?? value}
      {...(label === undefined ? {} : { "aria-label": label })}
      {...(inputMode ? { inputMode } : {})}
      {...(maxLength ? { maxLength } : {})}
      {...(ask ? { "data-ask": ask } : {})}
      onInput={(event) => setTyped(event.currentTarget.value)}
      onChange={(event) => {
        const text = event.currentTarget.value;
        setTyped(null);
        enter(text);
      }}
      onBlur={() => setTyped(null)}
      onKeyDown={(event) => {
        if (event.key !== "Escape" || typed === null) return;
        // Not to the picture as well, which clears what is measured.
        event.preventDefault();
        setTyped(null);
      }}
    />
  );
}
