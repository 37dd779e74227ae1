export interface Undoable {
  undo(): void;
  redo(): void;
}

/** Ctrl+Z and its kin, as a listener of the document. Fields that a person writes into keep their own undo. */
export function undoKeys(session: Undoable): (event: KeyboardEvent) => void {
  return (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey || isWritten(event.target)) return;
    const key = event.key.toLowerCase();
    if (key === "z" && !event.shiftKey) session.undo();
    else if (key === "y" || (key === "z" && event.shiftKey)) session.redo();
    else return;
    event.preventDefault();
  };
}

function isWritten(target: EventTarget | null): boolean {
  if (target instanceof HTMLTextAreaElement) return true;
  return target instanceof HTMLInputElement && (target.type === "number" || target.type === "text");
}
