import { button } from "../base/controls";
import { h, replace } from "../base/dom";
import { download } from "../base/download";
import { menu as dropDown } from "../base/menu";
import { savePng } from "../base/png_file";
import { svgOf } from "../base/svg_file";
import type { Client } from "../contract/client";
import { csvOf, jsonOf } from "./exports";
import { structurePath } from "./requests";
import type { DesignSession } from "./session";
import type { TargetResponse } from "./shown";
import type { Verification } from "./verification";

/** Number of cells of an exported structure along each of its two translations. */
const CELLS = [4, 4] as const;

export function exportMenu(session: DesignSession, verification: Verification, client: Client, plot: () => SVGSVGElement): HTMLElement {
  const links = h("div", { class: "menu-group" });
  const menu = dropDown(
    "Export",
    "download",
    h("div", { class: "menu-group" }, h("h3", {}, "Design"), button("Data (JSON)", () => save("json"), { kind: "quiet" }),
      button("Curves (CSV)", () => save("csv"), { kind: "quiet" }), button("Plot (SVG)", () => save("svg"), { kind: "quiet" }),
      button("Plot (PNG)", () => save("png"), { kind: "quiet" })),
    links,
  );

  function save(kind: "json" | "csv" | "svg" | "png"): void {
    const shown = session.results.shown.get();
    if (!shown) return;
    const verified = verification.simulated?.curve ?? null;
    const name = `${shown.found.family}-${shown.task}`;
    if (kind === "json") {
      const { at } = session.state.get();
      // Targets may have been renamed since the answer arrived.
      const all = session.results.all.get().map((one, k) => one && { ...one, name: session.targets[k]?.name ?? "" });
      download(`${name}.json`, "application/json", jsonOf(all[at] ?? shown, verified, all.filter((one, k): one is TargetResponse => one !== null && k !== at)));
    }
    if (kind === "csv") download(`${name}.csv`, "text/csv", csvOf(shown, session.results.previous.get(), verified));
    if (kind === "svg") download(`${name}.svg`, "image/svg+xml", svgOf(plot()));
    if (kind === "png") void savePng(plot(), `${name}.png`);
    menu.open = false;
  }

  session.redraws.follow([session.results.shown], () => {
    const shown = session.results.shown.get();
    if (!shown) return replace(links);
    const link = (format: "svg" | "dxf" | "stl", words: string) =>
      h("a", {
        class: "button quiet",
        href: client.url(structurePath(shown.found, format, CELLS, shown.measures.beamWidth)),
        download: `${shown.found.family}.${format}`,
        onclick: () => (menu.open = false),
      }, words);
    replace(links, h("h3", {}, "Structure"), link("svg", "Drawing (SVG)"), link("dxf", "Outlines (DXF)"), link("stl", "Solid (STL)"));
  });
  return menu;
}
