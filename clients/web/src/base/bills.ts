// What the server charged for its last answers of a page: one bill for each endpoint, the newest first.
import type { Cost, Effect } from "../contract/types";
import { Observable } from "./observable";

export interface Bill {
  /** Path of the request, without its query. */
  readonly path: string;
  readonly cost: Cost;
  readonly effects: readonly Effect[];
  /** What was asked for and reached; names and numbers. */
  readonly accuracy: Readonly<Record<string, unknown>>;
  /** What was asked. */
  readonly request: unknown;
  /** Of the answer's structure, where it has one. */
  readonly family: string | null;
}

const MOST_BILLS = 8;

export class Bills {
  readonly list = new Observable<readonly Bill[]>([]);

  /** Keeps the bill of an answer, where it has one. */
  readonly hear = (path: string, answer: unknown, request?: unknown): void => {
    const bill = billOf(path, answer, request);
    if (bill) this.list.set([bill, ...this.list.get().filter((other) => other.path !== bill.path)].slice(0, MOST_BILLS));
  };
}

export function billOf(path: string, answer: unknown, request: unknown = null): Bill | null {
  if (typeof answer !== "object" || answer === null) return null;
  const { cost, effects, accuracy, family } = answer as { cost?: Cost; effects?: unknown; accuracy?: unknown; family?: unknown };
  if (!cost || typeof cost.seconds !== "number" || !Array.isArray(cost.stages)) return null;
  return {
    path: path.replace(/\?.*/, ""),
    cost,
    effects: Array.isArray(effects) ? (effects as Effect[]) : [],
    accuracy: typeof accuracy === "object" && accuracy !== null ? (accuracy as Record<string, unknown>) : {},
    request,
    family: typeof family === "string" ? family : null,
  };
}
