// Families for the tests of the family page: those that the server ships, and those of the contract's examples.
import { steps } from "../../../api/examples/families.json";
import ih01 from "../../../models/families/ih01.json";
import ih21 from "../../../models/families/ih21.json";
import ih22 from "../../../models/families/ih22.json";
import ih28 from "../../../models/families/ih28.json";
import ih29 from "../../../models/families/ih29.json";
import ih50 from "../../../models/families/ih50.json";
import ih67 from "../../../models/families/ih67.json";
import type { FamilyCheck, FamilyDefinition, IsohedralType } from "../src/contract/types";
import { type FamilyState, stateOf } from "../src/family/state";
import { type DrawnFamily, drawnFamily } from "../src/family/tiling";

export const SHIPPED = [ih01, ih21, ih22, ih28, ih29, ih50, ih67] as unknown as FamilyDefinition[];

/** The shipped families as rows of the table of types, of which they are. */
export const TYPES: IsohedralType[] = SHIPPED.map(({ id, parameters, shapes = [], tile }) => ({
  number: Number(id.slice(2)),
  defaults: parameters.map((parameter) => parameter.default),
  classes: shapes.map((shape) => shape.class),
  tile: tile as IsohedralType["tile"],
}));

interface CheckStep {
  readonly body: { readonly definition: FamilyDefinition; readonly parameters?: number[] };
  readonly response: Pick<FamilyCheck, "faults"> & { readonly tiling: NonNullable<FamilyCheck["tiling"]> };
}

/** The requests and answers of the contract's examples whose definition has a name. */
export function exampleCheck(id: string): CheckStep {
  const found = (steps as unknown as CheckStep[]).find(({ body }) => body?.definition?.id === id);
  if (!found) throw new Error(`The contract has no example ${id}.`);
  return found;
}

export function drawn(definition: FamilyDefinition): DrawnFamily {
  const family = drawnFamily(definition, TYPES);
  if (!family) throw new Error(`${definition.id} cannot be drawn.`);
  return family;
}

export function shipped(id: string): DrawnFamily {
  return drawn(SHIPPED.find((one) => one.id === id) as FamilyDefinition);
}

export function stateFor({ definition }: DrawnFamily, shown?: readonly number[]): FamilyState {
  const state = stateOf(definition);
  return { ...state, shown: shown ?? state.shown };
}

/** A pseudorandom generator of numbers in [0, 1), the same in each run. */
export function random(seed: number): () => number {
  let state = seed;
  return () => {
    state = (state * 16807) % 2147483647;
    return state / 2147483647;
  };
}

/** Parameters anywhere within the bounds. */
export function anywhere({ definition: { parameters } }: DrawnFamily, next: () => number): number[] {
  return parameters.map(({ lower, upper }) => lower + (upper - lower) * next());
}
