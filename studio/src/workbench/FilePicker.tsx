// A button by which files are chosen.
import { useRef } from "preact/hooks";

interface FilePickerProps {
  label: string;
  /** For programs that drive the page. */
  asks?: string;
  accept?: string;
  multiple?: boolean;
  chosen(files: File[]): void;
}

export function FilePicker({ label, asks, accept, multiple, chosen }: FilePickerProps) {
  const picker = useRef<HTMLInputElement>(null);
  return (
    <>
      <button type="button" data-ask={asks} onClick={() => picker.current?.click()}>
        {label}
      </button>
      <input
        ref={picker}
        type="file"
        accept={accept}
        multiple={multiple}
        hidden
        aria-label={label}
        onChange={(event) => {
          chosen([...(event.currentTarget.files ?? [])]);
          // Otherwise choosing the same file once more would be no change.
          event.currentTarget.value = "";
        }}
      />
    </>
  );
}
