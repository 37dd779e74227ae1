// The regions of a product as tabs above those of the targets; each has targets and a design of its own.
import { button } from "../base/controls";
import { percent } from "../base/format";
import { Tabs } from "../base/tabs";
import { MOST_REGION_NAME, MOST_REGIONS, regionWords } from "./region_list";
import type { DesignSession } from "./session";

export interface RegionTabs {
  /** Not in sight while there is one region alone. */
  readonly element: HTMLElement;
  /** Makes two regions of one. */
  readonly divide: HTMLButtonElement;
}

/** `panel` shows the region in sight. */
export function regionTabs(session: DesignSession, panel: HTMLElement): RegionTabs {
  const tabs = new Tabs(
    { label: "Regions of the product", noun: "region", addTitle: "Add a further region with a design of its own", longestName: MOST_REGION_NAME, panel },
    { select: (at) => session.selectRegion(at), add: () => session.addRegion(), rename: (name) => session.renameRegion(name), remove: (at) => session.removeRegion(at) });
  const divide = button("Regions", () => {
    session.addRegion();
    tabs.focusSelected();
  }, { kind: "quiet", title: "Divide the product into regions, each with a design of its own" });
  tabs.element.classList.add("regions");

  function show(): void {
    const { regions, regionShown } = session;
    const { regionAt, points } = session.state.get();
    const several = regions.length > 1;
    tabs.element.hidden = !several;
    divide.hidden = several;
    divide.disabled = points.length === 0;
    tabs.show(regions.map((region, k) => ({
      words: regionWords(region, k), plainWords: regionWords({ region: "" }, k), detail: several && regionShown[k] ? percent(regionShown[k][0].overall) : "",
    })), regionAt, regions.length < MOST_REGIONS && points.length > 0);
    if (!several) panel.removeAttribute("aria-labelledby");
    // Without tabs it is no panel of one.
    if (several) panel.setAttribute("role", "tabpanel");
    else panel.removeAttribute("role");
  }

  for (const part of [session.state, session.all, session.kept]) part.watch(show);
  return { element: tabs.element, divide };
}
