// The tabs of the regions, above the tabs of the targets. Each region has its own targets and its own design.
import { button } from "../base/controls";
import { percent } from "../base/format";
import { Tabs } from "../base/tabs";
import { MAX_REGION_NAME_LENGTH, MAX_REGIONS, regionWords } from "./region_list";
import type { DesignSession } from "./session";

export interface RegionTabs {
  /** The tabs; hidden while there is only one region. */
  readonly element: HTMLElement;
  /** A button that adds a second region. */
  readonly divide: HTMLButtonElement;
}

/** `panel` shows the selected region. */
export function regionTabs(session: DesignSession, panel: HTMLElement): RegionTabs {
  const tabs = new Tabs(
    { label: "Regions of the product", noun: "region", addTitle: "Add a further region with a design of its own", maxNameLength: MAX_REGION_NAME_LENGTH, panel },
    {
      select: (at) => session.regionEdits.select(at),
      add: () => session.regionEdits.add(),
      rename: (name) => session.regionEdits.rename(name),
      remove: (at) => session.regionEdits.remove(at),
    },
  );
  const divide = button("Regions", () => {
    session.regionEdits.add();
    tabs.focusSelected();
  }, { kind: "quiet", title: "Divide the product into regions, each with a design of its own" });
  tabs.element.classList.add("regions");

  function show(): void {
    const regions = session.regionEdits.all;
    const regionShown = session.results.ofRegions;
    const { regionAt, points } = session.state.get();
    const several = regions.length > 1;
    tabs.element.hidden = !several;
    divide.hidden = several;
    divide.disabled = points.length === 0;
    tabs.show(regions.map((region, k) => ({
      words: regionWords(region, k),
      defaultWords: regionWords({ region: "" }, k),
      detail: several && regionShown[k] ? percent(regionShown[k][0].overall) : "",
    })), regionAt, regions.length < MAX_REGIONS && points.length > 0);
    if (!several) panel.removeAttribute("aria-labelledby");
    // The panel has the role "tabpanel" only while there are tabs.
    if (several) panel.setAttribute("role", "tabpanel");
    else panel.removeAttribute("role");
  }

  for (const part of [session.state, session.results.all, session.results.regionCache]) part.watch(show);
  return { element: tabs.element, divide };
}
