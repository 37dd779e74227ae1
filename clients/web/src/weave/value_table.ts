// Tables of profile and crossings, for users who do not see the drawings.
import { h, replace } from "../base/dom";
import { degrees, digits } from "../base/format";
import { connectionWords } from "./connections";
import type { WeaveSession } from "./session";

/** Limit of the rows of evenly selected directions. Directions without a value are always listed. */
const MAX_ROWS = 50;

export function valueTable(session: WeaveSession): HTMLElement {
  const curves = h("div", { class: "table-box", tabindex: 0, role: "region", "aria-label": "Values over direction" });
  const crossings = h("div", { class: "table-box", tabindex: 0, role: "region", "aria-label": "List of crossings" });
  const details = h("details", { class: "card table" }, h("summary", {}, "Values as tables"), h("div", { class: "tables" }, curves, crossings));

  function table(caption: string, head: readonly string[], rows: readonly (readonly string[])[]): HTMLElement {
    return h("table", {}, h("caption", {}, caption), h("thead", {}, h("tr", {}, ...head.map((words) => h("th", { scope: "col" }, words)))),
      h("tbody", {}, ...rows.map(([first, ...others]) => h("tr", {}, h("th", { scope: "row" }, first), ...others.map((words) => h("td", {}, words))))));
  }

  function showCurves(): void {
    const profile = session.profile.get();
    if (!profile) return replace(curves);
    const gaps = profile.reasons.some((reason) => reason !== null);
    const stride = Math.max(1, Math.ceil(profile.directions.length / MAX_ROWS));
    const rows = profile.directions.flatMap((direction, k) => {
      const reason = profile.reasons[k];
      if (k % stride !== 0 && reason === null) return [];
      const value = (quantity: number | null) => (quantity === null ? "none" : digits(quantity, 4));
      return [[degrees(direction), value(profile.youngs[k]), value(profile.poisson[k]), ...(gaps ? [reason ?? ""] : [])]];
    });
    const head = ["Direction", "Young’s modulus (N/m)", "Poisson’s ratio", ...(gaps ? ["Why there is no value"] : [])];
    replace(curves, table(`At a strain of ${digits(profile.strain)}`, head, rows));
  }

  function showCrossings(): void {
    const laidOut = session.laidOut.get();
    if (!laidOut) return replace(crossings);
    const rows = laidOut.layout.crossings.map((crossing, k) => [
      String(k + 1),
      crossing.members.map((member) => member.strand + 1).join(", "),
      crossing.position.map((value) => digits(value, 4)).join(", "),
      connectionWords(crossing),
    ]);
    replace(crossings, table("Crossings", ["Crossing", "Strands", "At (mm)", "Connection"], rows));
  }

  function show(): void {
    if (!details.open) return;
    showCurves();
    showCrossings();
  }

  details.addEventListener("toggle", show);
  session.profile.watch(show);
  session.laidOut.watch(show);
  return details;
}
