// The menu of what to start from: the families of the server, and the 81 isohedral types, each with a picture of its tiling.
import { announce } from "../base/announce";
import { h, replace } from "../base/dom";
import { menu } from "../base/menu";
import type { Family, IsohedralType } from "../contract/types";
import type { FamilySession } from "./session";
import { familyOfType, typeName, typeWords } from "./state";
import { thumbnail } from "./thumbnail";
import { type DrawnFamily, drawnFamily } from "./tiling";

export function typeMenu(session: FamilySession): HTMLDetailsElement {
  const families = h("ul", { class: "tile-list", "aria-label": "Families of this server" });
  const types = h("ul", { class: "tile-list", "aria-label": "Isohedral types" });
  const element = menu("Start from", "list", h("h3", {}, "Families of this server"), families, h("h3", {}, "The 81 isohedral types"),
    h("p", { class: "muted" }, "All tiles are copies of one, and symmetries carry each to each other one."), types);
  element.classList.add("type-menu");

  const entry = (words: string, name: string, drawn: DrawnFamily | null, choose: () => void) =>
    h("li", {}, h("button", {
      type: "button",
      class: "tile-choice",
      title: words,
      "aria-label": words,
      onclick: () => {
        element.open = false;
        element.querySelector("summary")?.focus();
        choose();
        announce(`${name} is drawn.`, "change");
      },
    }, drawn && thumbnail(drawn), h("span", {}, name)));

  function familyEntry(family: Family): HTMLElement | null {
    const { definition, id, description } = family;
    return definition && entry(`${id}: ${description}`, id, drawnFamily(definition, session.types.get()), () => session.open(definition));
  }

  // The pictures are drawn when they are first seen.
  let drawnTypes: readonly IsohedralType[] = [];
  function draw(): void {
    if (!element.open) return;
    replace(families, ...session.families.get().map(familyEntry));
    if (drawnTypes === session.types.get()) return;
    drawnTypes = session.types.get();
    replace(types, ...drawnTypes.map((type) => entry(typeWords(type), typeName(type.number), drawnFamily(familyOfType(type), drawnTypes), () => session.openType(type))));
  }
  element.addEventListener("toggle", draw);
  for (const part of [session.families, session.types]) part.watch(draw);
  return element;
}
