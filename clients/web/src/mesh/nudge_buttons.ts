// Buttons with arrows that move the chosen object in the view.
import { button } from "../base/controls";

/** Moves the chosen object in the view by steps to the right and down. */
export type Nudge = (right: number, down: number) => void;

export function nudgeButtons(what: string, nudge: Nudge): HTMLButtonElement[] {
  const arrow = (sign: string, direction: string, right: number, down: number) => button(sign, () => nudge(right, down), { title: `Move ${what} ${direction}` });
  const arrows = [arrow("←", "left", -1, 0), arrow("↑", "up", 0, -1), arrow("↓", "down", 0, 1), arrow("→", "right", 1, 0)];
  for (const one of arrows) one.setAttribute("aria-label", one.title);
  return arrows;
}
