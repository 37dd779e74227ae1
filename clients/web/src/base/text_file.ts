// The text of a file that the user opened or dropped.

/** Decodes UTF-8, or Windows-1252, which older instruments write, if the bytes are no UTF-8. */
export function textOf(bytes: ArrayBuffer): string {
  try {
    return new TextDecoder("utf-8", { fatal: true }).decode(bytes);
  } catch {
    return new TextDecoder("windows-1252").decode(bytes);
  }
}
