// The bills of the last answers that a page received: one for each endpoint, the newest first.
import type { Cost, Effect } from "../contract/types";
import { Observable } from "./observable";

export interface Bill {
  /** Path of the request, without its query. */
  readonly path: string;
  readonly cost: Cost;
  readonly effects: readonly Effect[];
  /** Requested and reached accuracy, by name. */
  readonly accuracy: Readonly<Record<string, unknown>>;
  /** The document that was sent. */
  readonly request: unknown;
  /** Family of the structure in the answer, if there is one. */
  readonly family: string | null;
}

const MAX_BILLS = 8;

export class Bills {
  readonly list = new Observable<readonly Bill[]>([]);

  /** Stores the bill of an answer, if it has one. */
  readonly record = (path: string, answer: unknown, request?: unknown): void => {
    const bill = billOf(path, answer, request);
    if (bill) this.list.set([bill, ...this.list.get().filter((other) => other.path !== bill.path)].slice(0, MAX_BILLS));
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
