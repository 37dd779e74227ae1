// The families of tilings and the neural models that the server has.
import type { Client } from "../contract/client";
import type { Family, Model } from "../contract/types";
import { ANY, type DesignState } from "./state";

export class Catalogue {
  families: readonly Family[] = [];
  models: readonly Model[] = [];

  async load(client: Client): Promise<void> {
    [this.families, this.models] = await Promise.all([
      client.get<{ families: Family[] }>("/v1/families").then((answer) => answer.families),
      client.get<{ models: Model[] }>("/v1/models").then((answer) => answer.models),
    ]);
  }

  /** One model for each family that has any, in the order of the families. */
  get familyModels(): readonly Model[] {
    const found = this.families.map((family) => this.model(family.id));
    return found.filter((model): model is Model => model !== undefined);
  }

  model(family: string): Model | undefined {
    return this.models.find((model) => model.family === family);
  }

  family(id: string): Family | undefined {
    return this.families.find((family) => family.id === id);
  }

  /** Whether the server has the models that a state needs. */
  serves(state: DesignState): boolean {
    const model = state.found && this.model(state.found.family);
    if (state.found && model?.parameters.lower.length !== state.found.parameters.length) return false;
    return state.family === ANY || this.model(state.family) !== undefined;
  }
}
