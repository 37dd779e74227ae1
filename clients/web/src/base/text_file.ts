// Text of a file that somebody chose or dropped.

/** UTF-8, or else the Latin-1 that older instruments and programs write. */
export function textOf(bytes: ArrayBuffer): string {
  try {
    return new TextDecoder("utf-8", { fatal: true }).decode(bytes);
  } catch {
    return new TextDecoder("windows-1252").decode(bytes);
  }
}
