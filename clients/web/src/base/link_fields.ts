// The text of a link: fields "name=value" that are joined by "&". Links come from anywhere, so that every value is checked when it is read.
import { plain } from "./format";

export type Fields = ReadonlyMap<string, string>;

export function writeFields(fields: readonly (readonly [name: string, value: string])[]): string {
  return fields.map(([name, value]) => `${name}=${value}`).join("&");
}

/** The fields with their decoded values. A value that cannot be decoded is empty. */
export function readFields(text: string): Fields {
  return new Map(
    text.split("&").map((field): [string, string] => {
      const equals = field.indexOf("=");
      return [field.slice(0, equals), decoded(field.slice(equals + 1))];
    }),
  );
}

export function decoded(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return "";
  }
}

/** Marks of the text of named values: between two values, and between a name and its value. */
export type Marks = readonly [between: string, assigned: string];
const VALUE_MARKS: Marks = [",", ":"];

/** Several values of one field by their names, as in "columns:3,rows:2". */
export function writeValues(values: Readonly<Record<string, string | number>>, [between, assigned]: Marks = VALUE_MARKS): string {
  const text = (value: string | number) => (typeof value === "string" || Number.isInteger(value) ? String(value) : plain(value));
  return Object.entries(values).map(([name, value]) => `${name}${assigned}${text(value)}`).join(between);
}

/** The values of such a text by their names. The links of version 0.1 have the values alone, in the order of `names`. */
export function readValues(text: string, names: readonly string[], [between, assigned]: Marks = VALUE_MARKS): Fields {
  return new Map(
    text.split(between).map((piece, place): [string, string] => {
      const end = piece.indexOf(assigned);
      return end < 0 ? [names[place] ?? "", piece] : [piece.slice(0, end), piece.slice(end + 1)];
    }),
  );
}

/** A number within limits; otherwise the given one. Links have rounded numbers, so that a number at a limit may lie slightly beyond it. */
export function numberOf(text: string | undefined, lower: number, upper: number, otherwise: number): number {
  const value = text === undefined || text === "" ? NaN : Number(text);
  const isWithin = value >= lower - 1e-7 * Math.abs(lower) && value <= upper + 1e-7 * Math.abs(upper);
  return isWithin ? Math.max(lower, Math.min(upper, value)) : otherwise;
}

export function wholeOf(text: string | undefined, lower: number, upper: number, otherwise: number): number {
  return Math.round(numberOf(text, lower, upper, otherwise));
}

export function choiceOf<Choice extends string>(text: string | undefined, choices: readonly Choice[], otherwise: Choice): Choice {
  return choices.find((choice) => choice === text) ?? otherwise;
}
