// Words for what hands do: on a touch screen one taps, and with a mouse one clicks.

/** Whether the main pointer is a finger. */
export function isTouch(): boolean {
  return typeof matchMedia === "function" && matchMedia("(pointer: coarse)").matches;
}

/** A sentence about clicks, in words of a touch screen. */
export function tapped(sentence: string): string {
  return sentence.replace(/\b([Cc])lick(s|ed|ing)?\b/g, (_, first: string, end: string | undefined) => `${first === "C" ? "Tap" : "tap"}${doubled(end ?? "")}`);
}

function doubled(end: string): string {
  return end === "ed" || end === "ing" ? `p${end}` : end;
}

/** A sentence for this device: with its clicks as taps on a touch screen, or the other sentence that is given for it. */
export function touchWords(sentence: string, onTouch = tapped(sentence)): string {
  return isTouch() ? onTouch : sentence;
}
