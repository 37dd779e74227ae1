// What a page shows of an error: sentences without pointers and names of fields, and the places at fault, which the page marks.
import { capitalized, entriesOf, GOES_ON, inWords, pointerWords, rewritten } from "./places";
import type { ProblemDocument } from "./types";

/** Clauses of a hint that speak to somebody who writes requests, not to the user of a page. */
const FOR_PROGRAMS =
  /\bentr(?:y|ies) of errors\b|\b(?:GET|POST|PUT|DELETE) \/|\/openapi\.yaml|\/readyz|\/v1\b|Retry-After|\bheaders?\b|Content-Type|Idempotency-Key|\bschemas?\b|\bfield deadline\b/;

/** The clauses of the server's hint that help the user of a page; empty if none does. */
export function hintWords(hint: string): string {
  const sentences = hint.split(/(?<=[.!?])\s+/).map((sentence) => {
    const clauses = sentence.split(/;\s+/).filter((clause) => !FOR_PROGRAMS.test(clause));
    const text = clauses.join("; ");
    return text === "" || /[.!?)]$/.test(text) ? text : `${text}.`;
  });
  return sentences.filter((sentence) => sentence !== "").map(inWords).join(" ");
}

/** A fault of one place of the request. */
export interface PlacedFault {
  /** The place in words, such as "crossing 4"; empty for the request as a whole. */
  readonly place: string;
  readonly sentence: string;
}

/** A path with which a detail begins where its pointer only names the whole: "crossings/3 strands/1 must ..." at "/weave". */
const LEADING_PATH = /^([a-z_]+\/\d+):? (?=\S)/;

/** The pointer to the innermost place that a fault names, and the rest of its detail. */
function located(pointer: string, detail: string): { readonly pointer: string; readonly detail: string } {
  const path = /^\/weave\/?$/.test(pointer) ? LEADING_PATH.exec(detail) : null;
  return path ? { pointer: `/weave/${path[1]}`, detail: detail.slice(path[0].length) } : { pointer, detail };
}

function placed(givenPointer: string, givenDetail: string): PlacedFault {
  const { pointer, detail } = located(givenPointer, givenDetail);
  const place = pointerWords(pointer);
  // The server's sentences begin with the path of the field: "crossings/3: a channel needs ...".
  const rest = detail.replace(/^\/?([\w/~]+):? (?=\S)/, (begin, path: string) => (place !== "" && `/${pointer}`.endsWith(`/${path}`) ? "" : begin));
  const words = rewritten(rest);
  if (place === "" || (rest === detail && words.toLowerCase().includes(place.toLowerCase()))) return { place, sentence: capitalized(words) };
  return { place, sentence: capitalized(`${place}${GOES_ON.test(rest) ? "" : ":"} ${words}`) };
}

/** All faults that a problem names, each with its place. */
export function faultsIn({ errors }: Pick<ProblemDocument, "errors">): PlacedFault[] {
  return (errors ?? []).map(({ pointer, detail }) => placed(pointer ?? "", detail));
}

/** A problem as sentences for the user: the place at fault, the fault, and a hint if there is one. */
export function problemWords(problem: Pick<ProblemDocument, "detail" | "errors" | "hint">): string {
  const sentence = placed(problem.errors?.[0]?.pointer ?? "", problem.detail).sentence;
  const hint = hintWords(problem.hint ?? "");
  if (hint === "" || sentence.includes(hint)) return sentence;
  return `${sentence}${/[.!?)]$/.test(sentence) ? "" : "."} ${hint}`;
}

/**
 * The entries of a list that a problem names, by index, each once: those of "crossings" for marks at crossings. `within`: an outer entry that
 * the pointer must go through, if it goes through one of that list at all.
 */
export function entriesAtFault({ errors }: Pick<ProblemDocument, "errors">, list: string, within?: { readonly list: string; readonly index: number }): number[] {
  const found = (errors ?? []).flatMap(({ pointer, detail }) => {
    const entries = entriesOf(located(pointer ?? "", detail).pointer);
    const outer = within && entries.find((entry) => entry.list === within.list);
    if (outer && outer.index !== within?.index) return [];
    return entries.filter((entry) => entry.list === list).map(({ index }) => index);
  });
  return [...new Set(found)];
}
