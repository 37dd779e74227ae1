// The state with which the page opens without a link.
import type { Client } from "../contract/client";
import type { Model, Profile } from "../contract/types";
import type { Catalogue } from "./catalogue";
import { profileOf } from "./properties";
import { DEFAULT_STATE, type DesignState, type TilingDesign } from "./state";
import { targetOnCurve } from "./targets";
import { firstModels, indexOfMostReliable } from "./verdict";

/** Parameters of the design whose profile is the first target, and of the one from which the search starts, as fractions of their ranges. */
const TARGET_FRACTION = 0.7;
const START_FRACTION = 0.3;

/**
 * The target is the profile of a design, and the search starts from another design of the same family. Two families are asked for a
 * profile, and the one with the more reliable model is chosen, so that the first verdict does not say that the model is not trusted.
 */
export async function firstState(client: Client, catalogue: Catalogue): Promise<DesignState> {
  const models = firstModels(catalogue.familyModels);
  const profiles = await Promise.all(models.map((model) => profileOf(client, designAt(model, TARGET_FRACTION), DEFAULT_STATE, DEFAULT_STATE.made)));
  const index = indexOfMostReliable(profiles);
  return beginning(profiles[index], models[index]);
}

/** The same for the family of one model; null if the server does not answer with a profile. */
export async function stateOfModel(client: Client, model: Model): Promise<DesignState | null> {
  const profile = await profileOf(client, designAt(model, TARGET_FRACTION), DEFAULT_STATE, DEFAULT_STATE.made);
  return profile && beginning(profile, model);
}

/** A state whose target is a profile, and whose search starts from another design of the model. */
function beginning(profile: Profile | null, model: Model): DesignState {
  const found = designAt(model, START_FRACTION);
  return { ...DEFAULT_STATE, ...targetOnCurve(profile, DEFAULT_STATE), found, fixed: found.parameters.map(() => false) };
}

function designAt({ family, parameters: { lower, upper } }: Model, fraction: number): TilingDesign {
  return { family, parameters: lower.map((value, k) => value + fraction * (upper[k] - value)) };
}
