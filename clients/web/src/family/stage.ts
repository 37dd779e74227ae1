// The card with the drawing of the tiling: tools, the drawing, what a drag changes, and what the check has found.
import { announce } from "../base/announce";
import { button, Segments } from "../base/controls";
import { h } from "../base/dom";
import type { DragMode } from "./drags";
import { canAddParameter, moveAsParameter } from "./edits";
import { dragControls, findingList } from "./finding_list";
import type { FamilySession } from "./session";
import { TilingView } from "./tiling_view";
import { typeMenu } from "./type_menu";

/** `tools`: buttons that open, save and share a family. */
export function stage(session: FamilySession, tools: readonly HTMLElement[]): HTMLElement {
  const view = new TilingView(session);
  const undo = button("", () => session.undo(), { icon: "undo", title: "Undo (Ctrl+Z)" });
  const redo = button("", () => session.redo(), { icon: "redo", title: "Redo (Ctrl+Shift+Z)" });
  const fit = button("", () => view.fit(), { icon: "fit", title: "Fit view" });
  const mode = new Segments<DragMode>("A drag changes", [{ value: "parameters", words: "The parameters" }, { value: "tile", words: "The tile" }],
    (value) => session.mode.set(value));
  session.steps.watch((steps) => {
    undo.disabled = !steps.undo;
    redo.disabled = !steps.redo;
  });
  session.mode.watch((value) => (mode.value = value));
  return h("section", { class: "card family-card", "aria-label": "Tiling" },
    h("div", { class: "toolbar", role: "toolbar", "aria-label": "Family" }, undo, redo, fit, h("span", { class: "gap" }), typeMenu(session), h("span", { class: "stretch" }),
      ...tools), view.element, dragControls(session, mode.element, () => lastDragAsParameter(session)), findingList(session, view));
}

function lastDragAsParameter(session: FamilySession): void {
  const drag = session.lastDrag.get();
  if (!drag) return;
  const { before, after, vertex } = drag;
  if (!canAddParameter(before.definition)) return announce("A family has at most eight parameters.");
  session.apply(moveAsParameter(before, after, session.state.get().shown, `Place of vertex ${vertex + 1}`));
}
