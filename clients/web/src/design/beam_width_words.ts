// The sentence about how much a design changes with the width of its beams.
import { percent } from "../base/format";
import type { SimulatedTarget } from "./simulations";

/** A sentence such as "At rest, beams that are 5 % wider change the response by 12 %, narrower ones by 11 %."; empty if nothing is known. */
export function beamWidthSentence({ wider, narrower }: NonNullable<SimulatedTarget["beamWidth"]>): string {
  const clauses = [
    wider !== null && `beams that are 5 % wider change the response by ${percent(wider)}`,
    narrower !== null && `${wider === null ? "beams that are 5 % narrower change the response by" : "narrower ones by"} ${percent(narrower)}`,
  ].filter((clause) => clause !== false);
  return clauses.length > 0 ? `At rest, ${clauses.join(", ")}.` : "";
}
