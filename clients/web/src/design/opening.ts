// The state with which the page opens without a link.
import type { Client } from "../contract/client";
import type { Model } from "../contract/types";
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
  const found = designAt(models[index], START_FRACTION);
  return { ...DEFAULT_STATE, ...targetOnCurve(profiles[index], DEFAULT_STATE), found, fixed: found.parameters.map(() => false) };
}

function designAt({ family, parameters: { lower, upper } }: Model, fraction: number): TilingDesign {
  return { family, parameters: lower.map((value, k) => value + fraction * (upper[k] - value)) };
}
