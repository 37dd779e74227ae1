// What would help where a polish has not brought a design to its target.
import type { Polish } from "../contract/types";
import { limits } from "./verdict_words";
import type { WaysOutState } from "./ways_out";

const LIMIT_WORDS: Partial<Record<Polish["stopped"], string>> = { round_limit: "rounds", time_limit: "time", deadline: "time" };

/** Whether a polish has ended by a limit before it was at its end, so that another one may come closer. Simulations alone have one round. */
export function goesOn({ rounds, stopped, target_error: error }: Pick<Polish, "rounds" | "stopped" | "target_error">): boolean {
  return rounds.length > 1 && stopped in LIMIT_WORDS && (error ?? 1) > limits.reached;
}

/** What would help after a polish; empty if the target is reached, or if nothing was polished. `ways`: the ways out that are known. */
export function polishHelp(polish: Pick<Polish, "rounds" | "stopped" | "target_error">, ways: WaysOutState): string {
  const { rounds, stopped, target_error: error } = polish;
  if (rounds.length < 2 || (error ?? 1) <= limits.reached) return "";
  if (stopped in LIMIT_WORDS) return `It has ended by its limit of ${LIMIT_WORDS[stopped]}: polishing again goes on from here.`;
  if (stopped === "not_simulated") return "The simulation does not get to every sample of the target: a shorter range may help.";
  const [best] = ways.kind === "found" ? ways.ways : [];
  if (best) return `No polish brings it closer. What would help: ${best.sentence}`;
  return ways.kind === "found" ? "No polish brings it closer, and no change that was tried helps: the target asks for more than these structures have."
    : "No polish brings it closer: turning the structure, another material, a shorter range or another family may.";
}
