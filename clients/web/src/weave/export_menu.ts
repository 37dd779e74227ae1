// The menu of files to export. A new kind of file is a new entry in `groups`.
import { button } from "../base/controls";
import { h } from "../base/dom";
import { download } from "../base/download";
import { menu } from "../base/menu";
import { savePng } from "../base/png_file";
import { svgOf } from "../base/svg_file";
import { type Client, explain } from "../contract/client";
import { csvOf } from "./profile";
import type { ProfileCard } from "./profile_card";
import { FINE_DIRECTIONS, homogenizationRequest, layoutRequest } from "./requests";
import type { WeaveSession } from "./session";
import { isPeriodic } from "./state";

interface Entry {
  readonly words: string;
  readonly save: () => Promise<void> | void;
}

interface Group {
  readonly title: string;
  readonly entries: readonly Entry[];
}

/** `print` opens the print dialog. */
export function exportMenu(session: WeaveSession, card: ProfileCard, client: Client, print: () => void): HTMLElement {
  const name = (what: string) => `${session.state.get().pattern.replace(/_/g, "-")}-${what}`;
  const groups: readonly Group[] = [
    {
      title: "Weave",
      entries: [
        { words: "Drawing (SVG)", save: saveDrawing },
        { words: "Request (JSON)", save: saveRequest },
        { words: "Sheet to print (G-code)", save: print },
      ],
    },
    {
      title: "Stiffness",
      entries: [
        { words: "Values (CSV)", save: saveValues },
        { words: "Plot of the modulus (SVG)", save: () => download(name("modulus.svg"), "image/svg+xml", svgOf(card.charts[0].element)) },
        { words: "Plot of Poisson’s ratio (SVG)", save: () => download(name("poisson.svg"), "image/svg+xml", svgOf(card.charts[1].element)) },
        { words: "Plot of the modulus (PNG)", save: () => savePng(card.charts[0].element, name("modulus.png")) },
        { words: "Plot of Poisson’s ratio (PNG)", save: () => savePng(card.charts[1].element, name("poisson.png")) },
      ],
    },
  ];

  async function saveDrawing(): Promise<void> {
    const response = await client.postResponse("/v1/weave-layouts", layoutRequest(session.state.get()), { headers: { Accept: "image/svg+xml" } });
    download(name("layout.svg"), "image/svg+xml", await response.text());
  }

  /** Saves the request of the profile, or that of the layout if there is no periodic cell. */
  function saveRequest(): void {
    const state = session.state.get();
    const request = isPeriodic(state) ? homogenizationRequest(state, FINE_DIRECTIONS) : layoutRequest(state);
    download(name("request.json"), "application/json", `${JSON.stringify(request, null, 2)}\n`);
  }

  function saveValues(): void {
    const profile = session.profile.get();
    if (!profile) throw new Error("There are no values yet.");
    download(name("profile.csv"), "text/csv", csvOf(profile));
  }

  async function save(entry: Entry): Promise<void> {
    fault.hidden = true;
    try {
      await entry.save();
      element.open = false;
    } catch (error) {
      fault.textContent = explain(error);
      fault.hidden = false;
    }
  }

  const fault = h("p", { class: "note", role: "alert", hidden: true });
  const element = menu("Export", "download", fault,
    ...groups.map(({ title, entries }) =>
      h("div", { class: "menu-group" }, h("h3", {}, title), ...entries.map((entry) => button(entry.words, () => void save(entry), { kind: "quiet" })))
    ));
  // Only a periodic cell has a stiffness over direction.
  session.state.watch((state) =>
    element.querySelectorAll<HTMLElement>(".menu-group").forEach((group, k) => (group.hidden = groups[k].title === "Stiffness" && !isPeriodic(state)))
  );
  return element;
}
