// What the server's check has found in a definition, as sentences, and as marks in the drawing of the tiling at the shown parameters.
import { digits } from "../base/format";
import { capitalized, placeWords, rewritten } from "../contract/places";
import type { FamilyCheck, FamilyFinding } from "../contract/types";
import type { Vector } from "./expressions";

/** Parameters that differ by less than this, relative to their size, are the same. */
const SAME = 1e-9;

export interface Finding {
  readonly kind: "fault" | "warning";
  readonly flaw: FamilyFinding["flaw"];
  /** What was found, with its subject. */
  readonly sentence: string;
  /** Parameters at which it was found; null if it does not depend on them. */
  readonly parameters: readonly number[] | null;
  /** Where it is in the plane at these parameters; null if it has no place. */
  readonly point: Vector | null;
}

/** What the drawing tells by itself: the coordinates of places, which are marked, and the parameters, which can be shown. */
const TOLD_BY_MARKS = / (?:at|near) \(-?[\d.e+-]+, -?[\d.e+-]+\)| where the parameters are \([^)]*\)/g;

/** Edges have the numbers of the page, which counts from 1. */
function counted(message: string): string {
  return message.replace(/\b(edges?) (\d+)( and (\d+))?/g,
    (_, noun: string, first: string, rest: string | undefined, second: string) => `${noun} ${Number(first) + 1}${rest === undefined ? "" : ` and ${Number(second) + 1}`}`);
}

/** Measures have as many digits as say something, and the box of parameters is the bounds on this page. */
function measured(message: string): string {
  return message.replace(/\d+\.\d{3,}/g, (number) => digits(Number(number), 2)).replace(/ in 0 % of the box/, " in less than 1 % of the bounds").replace(/ of the box\b/,
    " of the bounds");
}

/** A finding as a sentence, whose subject the server leaves to the pointer. */
export function findingSentence({ pointer, message }: Pick<FamilyFinding, "pointer" | "message">): string {
  const place = placeWords(pointer) || "the definition";
  const words = rewritten(measured(counted(message.replace(TOLD_BY_MARKS, ""))));
  const sentence = capitalized(`${place} ${words}`);
  return /[.!?]$/.test(sentence) ? sentence : `${sentence}.`;
}

function findingOf(kind: Finding["kind"], found: FamilyFinding): Finding {
  const [x, y] = found.point ?? [];
  return {
    kind,
    flaw: found.flaw,
    sentence: findingSentence(found),
    parameters: found.parameters.length > 0 ? found.parameters : null,
    point: x === undefined || y === undefined ? null : [x, y],
  };
}

export function findingsOf({ faults, warnings }: Pick<FamilyCheck, "faults" | "warnings">): Finding[] {
  return [...faults.map((found) => findingOf("fault", found)), ...warnings.map((found) => findingOf("warning", found))];
}

/** Whether a finding is one of the tiling at these parameters, so that its place can be marked in the drawing. */
export function isShownAt({ parameters }: Finding, shown: readonly number[]): boolean {
  return parameters === null || parameters.every((value, k) => Math.abs(value - shown[k]) <= SAME * Math.max(1, Math.abs(value)));
}

/** What the check says as a whole. */
export function summaryOf(findings: readonly Finding[]): string {
  const [faults, warnings] = (["fault", "warning"] as const).map((kind) => findings.filter((finding) => finding.kind === kind).length);
  if (faults > 0) return faults === 1 ? "A fault: this is no family yet." : `${faults} faults: this is no family yet.`;
  if (warnings > 0) return `The tiles fill the plane within all bounds. ${warnings === 1 ? "One place is" : `${warnings} places are`} to be avoided.`;
  return "The tiles fill the plane within all bounds, and nothing is to be avoided.";
}
