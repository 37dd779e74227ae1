export interface Undoable {
  undo(): void;
  redo(): void;
}

/** A listener of the document for Ctrl+Z, Ctrl+Y and Ctrl+Shift+Z. Text fields keep their own undo. */
export function undoKeys(session: Undoable): (event: KeyboardEvent) => void {
  return (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey || isTextField(event.target)) return;
    const key = event.key.toLowerCase();
    if (key === "z" && !event.shiftKey) session.undo();
    else if (key === "y" || (key === "z" && event.shiftKey)) session.redo();
    else return;
    event.preventDefault();
  };
}

function isTextField(target: EventTarget | null): boolean {
  if (target instanceof HTMLTextAreaElement) return true;
  return target instanceof HTMLInputElement && (target.type === "number" || target.type === "text");
}
