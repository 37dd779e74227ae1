// Sentences about a relaxed network: what its user has to know at once, and what is of interest beside the bill.
import { type ConvergenceWords, powerWords } from "../base/convergence_plot";
import { digits } from "../base/format";
import { inWords } from "../contract/places";
import type { EmbeddedSystem } from "../contract/types";
import { hasShrunk } from "./shrinking";

/** Words of the plot of a relaxation. */
export const GRADIENT_WORDS: ConvergenceWords = {
  xTitle: "Iteration",
  yTitle: "Gradient of the energy",
  counted: "iterations",
  tolerance: "tolerance",
  valueWords: (value) => digits(value, 2),
  tickWords: powerWords,
  multiples: [],
};

/** What is shown first. */
export function notesOf(answer: Pick<EmbeddedSystem, "warnings" | "springs" | "history" | "mollified">): string[] {
  const sentences = answer.warnings.map(inWords);
  if (answer.springs.length > 0 && hasShrunk(answer.history.map(({ energy }) => energy))) {
    return [...sentences,
      "The network has shrunk: its springs have no length any more, because nothing held their ends apart. Fix some points, or give the springs a rest length."];
  }
  if (answer.mollified) sentences.push("The energy at the end is smoothed next to vertices (mollified).");
  return sentences;
}

/** What it means that points rest on vertices of the surface; empty if none does. */
export function vertexWords({ at_vertices: { length } }: Pick<EmbeddedSystem, "at_vertices">): string {
  if (length === 0) return "";
  const points = length === 1 ? "1 point rests" : `${length.toLocaleString("en")} points rest`;
  return `${points} exactly at corners of the surface’s triangles, where the surface holds them like a tip. That is at rest, too: nothing has to be done.`;
}
