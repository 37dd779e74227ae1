// The layout of a finite sheet, connected as the cell is, for simulations and prints.
import type { Run } from "../contract/runner";
import type { Weave, WeaveLayout } from "../contract/types";
import { layoutRequest } from "./requests";
import { sheetOverrides, sheetWeave } from "./sheet";
import { isPeriodic, type WeaveState } from "./state";

export interface SheetLayout {
  readonly weave: Weave;
  /** The sheet at rest. */
  readonly layout: WeaveLayout;
  /** Number of crossings of the sheet without a counterpart in the cell. */
  readonly unknown: number;
}

export async function layOutSheet(run: Run<object>, state: WeaveState): Promise<SheetLayout> {
  const lay = (weave: unknown) => run.post<WeaveLayout>("/v1/weave-layouts", { weave });
  const weave = sheetWeave(state);
  const layout = await lay(weave);
  if (!isPeriodic(state)) return { weave, layout, unknown: 0 };
  const { overrides, unknown } = sheetOverrides(await lay(layoutRequest(state).weave), layout);
  return { weave: overrides.length > 0 ? { ...weave, overrides } : weave, layout, unknown };
}

/** A sentence about crossings without a counterpart in the cell; empty if there are none. */
export function unknownWords({ layout, unknown }: Pick<SheetLayout, "layout" | "unknown">): string {
  return unknown > 0 ? `${unknown} of ${layout.crossings.length} crossings of the sheet lie between its cells or at its edge. What you clicked in the cell does not change them.`
    : "";
}
