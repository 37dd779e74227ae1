// The design page, put together.
import { button } from "../base/controls";
import { copyMenu } from "../base/copy_as";
import { h } from "../base/dom";
import { late } from "../base/late";
import { shareButton } from "../base/share";
import { undoKeys } from "../base/undo_keys";
import { ConnectionLost, explain } from "../contract/client";
import type { Page, Surroundings } from "../page";
import { commandOf, curlOf, pythonOf } from "./copy_text";
import { isDrawing } from "./drawing";
import { takeDrops } from "./drops";
import { exportMenu } from "./export_menu";
import { readLink, writeLink } from "./link";
import { Measured, tableOf } from "./measured";
import { madeCard } from "./made_card";
import { measuredCard } from "./measured_card";
import { Overlays } from "./overlays";
import { parameterPanel } from "./parameter_panel";
import { Part } from "./part";
import { partCard } from "./part_card";
import { pinList } from "./pin_list";
import { Pins } from "./pins";
import { PlotPanel } from "./plot_panel";
import { regionCard } from "./region_card";
import { resultCard } from "./result_card";
import { DesignSession } from "./session";
import { startMenu } from "./start_menu";
import type { DesignState } from "./state";
import { targetControls } from "./target_controls";
import { tilingPreview } from "./tiling_preview";
import { valueTable } from "./value_table";
import { Verification } from "./verification";
import { verificationCard } from "./verification_card";

const LINK_PAUSE_MS = 250;

export function designPage({ client, link }: Surroundings): Page {
  const session = new DesignSession(client);
  const verification = new Verification(session, client);
  const pins = new Pins(session);
  const measured = new Measured(session, client);
  const part = new Part(client);
  const overlays = new Overlays(session);
  const share = shareButton("Copy a link to this design", () => link.write(writeLink(session.state.get())));
  const pin = button("Pin", () => pins.add(), { icon: "pin", title: "Pin this design to compare others with it" });
  const copied = (write: (state: DesignState, origin: string) => string) => (session.state.get().points.length > 0 ? write(session.state.get(), location.origin) : null);
  const panel: PlotPanel = new PlotPanel(session, verification, pins, overlays, measured, [
    pin, share, copyMenu([
      { words: "curl", text: () => copied(curlOf) },
      { words: "Command line", text: () => copied(commandOf) },
      { words: "Python", text: () => copied(pythonOf) },
    ]), exportMenu(session, verification, client, () => panel.plot.element),
  ]);
  const empty = h("p", { class: "card note wide", role: "alert", hidden: true }, "This server has no neural models: start it with --models and a folder of them.");
  const element = h(
    "div",
    { class: "design-page" },
    h("h1", { class: "visually-hidden" }, "Design"),
    empty,
    h("div", { class: "column left" }, targetControls(session, startMenu(session)), madeCard(session), measuredCard(measured), parameterPanel(session)),
    h("div", { class: "column middle" }, panel.element, valueTable(session)),
    h("div", { class: "column right" }, tilingPreview(session, client), partCard(session, part), regionCard(session), resultCard(session, overlays), verificationCard(session, verification), pinList(pins, client)),
  );

  takeDrops(element, (text, name, bytes) => (isDrawing(name, text) ? part.open(text, name) : measured.read(tableOf(bytes), name)));

  // All that is of an earlier decision is dimmed as one, until the answer to this one has come.
  for (const part of [session.shown, session.state]) {
    part.watch(() => {
      element.classList.toggle("outdated", session.shown.get() !== null && !session.isCurrent);
      pin.disabled = !session.isCurrent;
    });
  }

  const linkLater = late(() => link.write(writeLink(session.state.get())), LINK_PAUSE_MS);
  session.state.watch((state) => {
    if (state.points.length > 0) linkLater.ask();
  });
  // A change that is done is in the address at once: a reload must not take it back.
  session.steps.watch(() => {
    if (session.state.get().points.length > 0) linkLater.now();
  });

  const keys = undoKeys(session);
  let started = false;
  async function start(text: string): Promise<void> {
    try {
      await session.start(readLink(text));
      started = true;
      empty.hidden = session.models.length > 0;
      pins.restore();
    } catch (error) {
      // A lost connection is told by the frame, and this is tried again once the server answers.
      if (!(error instanceof ConnectionLost)) session.activity.set({ kind: "failed", sentence: explain(error) });
    }
  }

  return {
    element,
    async open(text) {
      document.addEventListener("keydown", keys);
      if (!started) return start(text);
      const linked = text === "" || text === writeLink(session.state.get()) ? null : readLink(text);
      if (linked) session.apply(linked);
      else link.write(writeLink(session.state.get()));
    },
    close() {
      document.removeEventListener("keydown", keys);
      linkLater.cancel();
    },
    reconnected() {
      if (started) session.retry();
      else void start(link.read());
    },
  };
}
