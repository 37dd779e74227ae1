// A finite sheet before it is put under load or printed: laid out, and connected as the cell is.
import type { Client } from "../contract/client";
import type { Weave, WeaveLayout } from "../contract/types";
import { layoutRequest } from "./requests";
import { sheetOverrides, sheetWeave } from "./sheet";
import { isPeriodic, type WeaveState } from "./state";

export interface LaidSheet {
  readonly weave: Weave;
  /** The sheet at rest. */
  readonly layout: WeaveLayout;
  /** Crossings of the sheet that the cell does not have. */
  readonly unknown: number;
}

export async function laySheet(client: Client, state: WeaveState, signal: AbortSignal): Promise<LaidSheet> {
  const lay = (weave: unknown) => client.post<WeaveLayout>("/v1/weave-layouts", { weave }, { signal });
  const weave = sheetWeave(state);
  const layout = await lay(weave);
  if (!isPeriodic(state)) return { weave, layout, unknown: 0 };
  const { overrides, unknown } = sheetOverrides(await lay(layoutRequest(state).weave), layout);
  return { weave: overrides.length > 0 ? { ...weave, overrides } : weave, layout, unknown };
}

/** How many crossings of a sheet nobody connected, in words; empty where there is none. */
export function unknownWords({ layout, unknown }: Pick<LaidSheet, "layout" | "unknown">): string {
  return unknown > 0 ? `${unknown} of ${layout.crossings.length} crossings of the sheet are none of the cell’s: they stay as they were found.` : "";
}
