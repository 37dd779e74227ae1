// Requests for what is known of a design whose parameters are given: its profiles and its structure.
import { Problem } from "../contract/client";
import type { Profile, StructureAnswer } from "../contract/types";
import { profileRequest, structureRequest } from "./requests";
import type { Specification } from "./specification";
import type { DesignState, ProfileKind, TilingDesign } from "./state";
import { targetsOf } from "./target_list";

/** Sends requests: a client, or a task that is running. */
export interface Sender {
  post<Answer>(path: string, request: unknown): Promise<Answer>;
}

/** A design's profile of some kind; null if the server does not answer with it. */
export async function profileOf(sender: Sender, found: TilingDesign, kind: ProfileKind & Pick<DesignState, "points">, made: Specification): Promise<Profile | null> {
  try {
    return await sender.post<Profile>("/v1/profiles", profileRequest(kind, found, made));
  } catch {
    return null; // the main request meets the same fault and reports it
  }
}

/** The profiles of a design for all targets, in the order of the tabs. */
export function profilesOf(sender: Sender, state: DesignState, found: TilingDesign): Promise<Profile[]> {
  return Promise.all(targetsOf(state).map((target) => sender.post<Profile>("/v1/profiles", profileRequest(target, found, state.made))));
}

/** The measures of a structure; null if the parameters give no valid structure. */
export async function structureOf(sender: Sender, found: TilingDesign, made: Specification): Promise<StructureAnswer | null> {
  try {
    return await sender.post<StructureAnswer>("/v1/structures", structureRequest(found, made));
  } catch (error) {
    if (error instanceof Problem) return null;
    throw error;
  }
}
