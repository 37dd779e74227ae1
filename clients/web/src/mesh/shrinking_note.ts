// The note about a network that will shrink to one point.
import { announce } from "../base/announce";
import { button } from "../base/controls";
import { h, replace } from "../base/dom";
import type { NetworkSession } from "./network_session";
import { farthestPoints, HELD_POINTS, willShrink } from "./shrinking";

/** A note about a network that will shrink, with a button that holds some of its points. */
export function shrinkingNote(network: NetworkSession): HTMLElement {
  const element = h("div", { class: "note", hidden: true });
  const show = (): void => {
    const made = network.network.get();
    element.hidden = !made || made.pairs.length === 0 || !willShrink(network.state.get());
    if (element.hidden || !made) return;
    const fixed = farthestPoints(made.positions, HELD_POINTS);
    const words = fixed.length === HELD_POINTS ? "Fix six points" : `Fix ${fixed.length} points`;
    replace(element, h("p", {}, "This network will shrink to one point: its springs have no rest length, and no point is held."), button(words, () => {
      network.change({ fixed });
      announce(`${fixed.length} points are held.`, "change");
    }, { title: "Holds points that are far from each other" }));
  };
  network.network.watch(show);
  network.state.watch(show);
  return element;
}
