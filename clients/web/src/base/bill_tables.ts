// A bill as tables: stages, counted quantities, optional parts, accuracy.
import type { Cost, Effect } from "../contract/types";
import { digits, seconds } from "./format";
import { table } from "./tables";

export const plainName = (name: string): string => name.replace(/_/g, " ");

function plainValue(value: unknown): string | null {
  if (value === null) return "unknown";
  if (typeof value === "number") return Number.isInteger(value) && Math.abs(value) < 1e9 ? value.toLocaleString("en") : digits(value, 3);
  if (typeof value === "boolean") return value ? "yes" : "no";
  return typeof value === "string" ? value : null;
}

export function effectTable(effects: readonly Effect[]): HTMLElement {
  return table("Effects", ["Effect", "Ran", "Times", "Took", "Why"],
    effects.map(({ name, ran, why, count, seconds: took }) => [plainName(name), ran ? "yes" : "no", count.toLocaleString("en"), ran ? seconds(took) : "–", why]), "wide");
}

export function costTables({ stages, quantities, seconds: total }: Cost): HTMLElement[] {
  const rows = stages.map(({ name, seconds: took, count }) => [plainName(name), seconds(took), count.toLocaleString("en")]);
  const counted = Object.entries(quantities).map(([name, value]) => [plainName(name), plainValue(value) ?? ""]);
  return [table("Stages, the time of all threads added up", ["Stage", "Took", "Times"], [...rows, ["from start to end", seconds(total), ""]]),
    ...(counted.length > 0 ? [table("Counted", ["What", "Number"], counted)] : [])];
}

/** Null if an answer states no accuracy. */
export function accuracyTable(accuracy: Readonly<Record<string, unknown>>): HTMLElement | null {
  const rows = Object.entries(accuracy).flatMap(([name, value]): [string, string][] => {
    const words = plainValue(value);
    return words === null ? [] : [[plainName(name), words]];
  });
  return rows.length > 0 ? table("Accuracy, asked for and reached", ["What", "Value"], rows) : null;
}
