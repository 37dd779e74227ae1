// The link to the page Design with a family of one's own: its target is the profile of one of the family's designs.
import type { Client } from "../contract/client";
import type { Model } from "../contract/types";
import { writeLink } from "../design/link";
import { stateOfModel } from "../design/opening";

/** The text of the link, for the address after "#/design?". */
export async function designLink(client: Client, model: Model): Promise<string | null> {
  const state = await stateOfModel(client, model);
  return state && writeLink({ ...state, family: model.family });
}
