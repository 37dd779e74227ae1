// The weave page: makes its parts and connects them.
import { rememberedLevel } from "../base/accuracy_choice";
import { announce } from "../base/announce";
import { button } from "../base/controls";
import { h } from "../base/dom";
import { shareButton } from "../base/share";
import { StateLink } from "../base/state_link";
import { undoKeys } from "../base/undo_keys";
import type { Page, PageContext } from "../page";
import { cellView } from "./cell_view";
import { DeformedCell } from "./deformed_cell";
import { Draft } from "./draft";
import { exportMenu } from "./export_menu";
import { LayoutEditor } from "./layout_editor";
import { isShareable, readLink, writeLink } from "./link";
import { pinList } from "./pin_list";
import { Pins } from "./pins";
import { printDialog } from "./print_dialog";
import { PrintCheck } from "./print_check";
import { PrintSession } from "./print_session";
import { ProfileCard } from "./profile_card";
import { WeaveSession } from "./session";
import { sheetCard } from "./sheet_card";
import { SheetSession } from "./sheet_session";
import { DEFAULT_STATE, isPeriodic, type WeaveState } from "./state";
import { strandPanel } from "./strand_panel";
import { valueTable } from "./value_table";
import { weaveControls } from "./weave_controls";

/** A weave that is too long for a link has none. */
const LINK_TEXT = { write: (state: WeaveState) => (isShareable(state) ? writeLink(state) : ""), read: readLink };

export function weavePage({ client, link }: PageContext): Page {
  let started = false;
  const session = new WeaveSession(client);
  const deformed = new DeformedCell(session, client);
  const sheet = new SheetSession(session, client);
  const print = new PrintSession(session, client);
  const printCheck = new PrintCheck(session, print.settings, client);
  const dialog = printDialog(print, () => session.state.get().pattern.replace(/_/g, "-"));
  const pins = new Pins(session);
  const draft = new Draft(session);
  const editor = new LayoutEditor(session, draft);
  const profile = new ProfileCard(session, deformed, pins);
  const address = new StateLink(link, session, LINK_TEXT, () => started);
  const share = shareButton("Copy a link to this weave", () => {
    address.write();
    return isShareable(session.state.get()) ? undefined : "Too long for a link: export the request";
  });
  const cell = cellView(session, deformed);
  const element = h(
    "div",
    { class: "weave-page" },
    h("h1", { class: "visually-hidden" }, "Weave"),
    h("div", { class: "column left" }, weaveControls(session), strandPanel(session, draft), pinList(pins)),
    h("div", { class: "column" },
      h("section", { class: "card", "aria-label": "Layout and deformed cell" }, toolbar(session, pins, share, exportMenu(session, profile, client, dialog.open)),
        h("div", { class: "panels" }, editor.element, cell)), profile.element, valueTable(session), sheetCard(session, sheet, printCheck.words, dialog.open)),
    dialog.element,
  );

  // Only a periodic cell has a stiffness over direction. The panel of the cell explains this for other weaves.
  session.state.watch((state) => {
    profile.element.hidden = !isPeriodic(state);
  });

  const undoKey = undoKeys(session);
  function keys(event: KeyboardEvent): void {
    draft.key(event);
    if (!event.defaultPrevented) undoKey(event);
  }

  return {
    element,
    open(text) {
      document.addEventListener("keydown", keys);
      if (!started) {
        started = true;
        pins.restore();
        return session.start(readLink(text) ?? { ...DEFAULT_STATE, accuracy: { ...DEFAULT_STATE.accuracy, level: rememberedLevel("weave") } });
      }
      const linked = address.follow(text);
      if (linked) session.apply(linked);
    },
    close() {
      document.removeEventListener("keydown", keys);
      address.close();
      printCheck.end();
      if (dialog.element.open) dialog.element.close();
    },
    async resume(path) {
      if (path === "/v1/weave-simulations") await sheet.run();
      if (path === "/v1/weave-toolpaths") dialog.open();
    },
    reconnected() {
      if (!started) return;
      print.retry();
      session.retry();
      deformed.retry();
    },
  };
}

function toolbar(session: WeaveSession, pins: Pins, ...tools: HTMLElement[]): HTMLElement {
  const undo = button("", () => session.undo(), { icon: "undo", title: "Undo (Ctrl+Z)" });
  const redo = button("", () => session.redo(), { icon: "redo", title: "Redo (Ctrl+Shift+Z)" });
  const reset = button("Crossings as the pattern has them", () => session.apply({ overrides: [] }));
  const pin = button("Pin", () => {
    if (!pins.add()) announce("There is nothing to pin yet, or there are too many pins.");
  }, { icon: "pin", title: "Pin this weave to compare others with it" });
  session.steps.watch((steps) => {
    undo.disabled = !steps.undo;
    redo.disabled = !steps.redo;
  });
  session.state.watch((state) => (reset.disabled = state.overrides.length === 0));
  session.profile.watch((shown) => (pin.disabled = !shown));
  return h("div", { class: "toolbar", role: "toolbar", "aria-label": "Weave" }, undo, redo, h("span", { class: "gap" }), reset, h("span", { class: "stretch" }), pin, ...tools);
}
