// The words of verdicts. They come from the table that the server uses too, so that the page says of designs that were set by hand what
// the server says of those that it found.
import { limits, words } from "../../../../api/verdicts.json";

type Words = typeof words;
export type Source = keyof Words["source"];
export type Heading = keyof Words["heading"];
export type Grade = "reached" | "close" | "missed" | "unknown";
/** How well a range of a target is met, from best to worst. */
export type Fit = keyof Words["range"];
/** What a range of a target's curve looks like. */
export type CurvePart = keyof Words["part"];

export { limits, words };

/** A template of the table with its slots filled. */
export function filled(template: string, slots: Readonly<Record<string, string | number>>): string {
  return template.replace(/\{(\w+)\}/g, (slot, name: string) => String(slots[name] ?? slot));
}

/** Labels of grades, for chips and lists. */
const GRADE_WORDS: Record<Grade, string> = { reached: "Reached", close: "Close", missed: "Missed", unknown: "Not certain" };

export function gradeWords(grade: Grade): string {
  return GRADE_WORDS[grade];
}
