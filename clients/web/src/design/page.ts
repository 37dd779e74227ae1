// The design page: makes its parts and connects them.
import { button } from "../base/controls";
import { copyMenu } from "../base/copy_as";
import { h } from "../base/dom";
import { handleDrops } from "../base/drops";
import { shareButton } from "../base/share";
import { StateLink } from "../base/state_link";
import { undoKeys } from "../base/undo_keys";
import { type Client, ConnectionLost, explain } from "../contract/client";
import type { Page, PageContext } from "../page";
import { commandOf, curlOf, pythonOf } from "./copy_text";
import { isDrawing } from "./drawing";
import { exportMenu } from "./export_menu";
import { readLink, writeLink } from "./link";
import { Measured, tableOf } from "./measured";
import { specificationCard } from "./specification_card";
import { measuredCard } from "./measured_card";
import { Overlays } from "./overlays";
import { parameterPanel } from "./parameter_panel";
import { Part } from "./part";
import { partCard } from "./part_card";
import { pinList } from "./pin_list";
import { Pins } from "./pins";
import { PlotPanel } from "./plot_panel";
import { regionCard } from "./region_card";
import { regionsRequest } from "./requests";
import { resultCard } from "./result_card";
import { DesignSession } from "./session";
import { beginWith, startMenu } from "./start_menu";
import { Background } from "./background";
import { judgedDesign } from "./judged";
import type { DesignState } from "./state";
import { targetControls } from "./target_controls";
import { tilingPreview } from "./tiling_preview";
import { valueTable } from "./value_table";
import { verdictLine } from "./verdict_line";
import { leaveRoom } from "./verdict_room";
import { Verification } from "./verification";
import { verificationCard } from "./verification_card";
import { WaysOut } from "./ways_out";
import { welcome } from "./welcome";

export function designPage({ client, link }: PageContext): Page {
  const session = new DesignSession(client);
  const hasTarget = () => session.state.get().points.length > 0;
  const address = new StateLink(link, session.edited, { write: writeLink, read: readLink }, hasTarget);
  const verification = new Verification(session, client);
  const waysOut = new WaysOut(session, client.unreported());
  const background = new Background(session, verification, waysOut);
  const pins = new Pins(session, verification);
  const measured = new Measured(session, client);
  const part = new Part(client);
  const overlays = new Overlays(session);
  const pin = button("Pin", () => pins.add(), { icon: "pin", title: "Pin this design to compare others with it" });
  const panel: PlotPanel = new PlotPanel(session, verification, pins, overlays, measured, [
    pin,
    ...sharing(session, verification, address),
    exportMenu(session, verification, client, () => panel.plot.element),
  ]);
  const parts = partCard(session, part);
  const line = verdictLine(session, verification, waysOut, background, () => openPart(parts));
  const heading = h("h1", { class: "visually-hidden", tabindex: -1 }, "Design");
  const empty = h("p", { class: "card note wide", role: "alert", hidden: true }, "This server has no neural models: start it with --models and a folder of them.");
  const element = h(
    "div",
    { class: "design-page" },
    heading,
    empty,
    welcome((start) => beginWith(session, start), () => heading.focus()),
    h("div", { class: "column left" }, targetControls(session, startMenu(session)), specificationCard(session), measuredCard(measured), parameterPanel(session)),
    h("div", { class: "column middle" }, panel.element, line, valueTable(session)),
    h("div", { class: "column right" }, tilingPreview(session, verification, client), parts, regionCard(session, verification),
      resultCard(session, overlays, verification, waysOut, background), verificationCard(session, verification, waysOut), pinList(pins, client)),
  );

  handleDrops(element, (text, name, bytes) => (isDrawing(name, text) ? part.open(text, name) : measured.read(tableOf(bytes), name)));

  leaveRoom(element, line, panel.dragging);
  dimOutdated(session, element, pin);

  const keys = undoKeys(session);
  let started = false;
  async function start(text: string): Promise<void> {
    try {
      await session.start(readLink(text));
      started = true;
      empty.hidden = session.catalogue.models.length > 0;
      pins.restore();
    } catch (error) {
      // The frame reports a lost connection, and `reconnected` tries again.
      if (!(error instanceof ConnectionLost)) session.search.activity.set({ kind: "failed", sentence: explain(error) });
    }
  }

  return {
    element,
    async open(text) {
      document.addEventListener("keydown", keys);
      background.setOpen(true);
      if (!started) return start(text);
      const linked = address.follow(text);
      if (linked) await session.follow(linked);
    },
    close() {
      document.removeEventListener("keydown", keys);
      background.setOpen(false);
      address.close();
    },
    resume(path) {
      resumeRegions(session, client, path);
    },
    reconnected() {
      if (started) {
        session.search.retry();
        background.reconnected();
      } else void start(link.read());
    },
  };
}

/** Results of an earlier state are dimmed together until the answer to the present state has arrived. */
function dimOutdated(session: DesignSession, element: HTMLElement, pin: HTMLButtonElement): void {
  session.redraws.follow([session.results.shown, session.state], () => {
    element.classList.toggle("outdated", session.results.shown.get() !== null && !session.results.isCurrent);
    pin.disabled = !session.results.isCurrent;
  });
}

/** Goes on with the job for all regions if there is one. The link alone asks for the selected region. */
function resumeRegions(session: DesignSession, client: Client, path: string): void {
  const regions = session.regionEdits.all;
  const known = client.jobs?.known(path, regionsRequest(regions, "")) ?? null;
  if (regions.length > 1 && known !== null) session.search.searchRegions();
}

/** Buttons that copy a link to the shown design, or the request for it. */
function sharing(session: DesignSession, verification: Verification, address: StateLink<DesignState>): HTMLElement[] {
  /** What a simulation says of the shown design; null without one. */
  function simulatedVerdict(): string | null {
    const shown = session.results.shown.get();
    const judgement = shown && session.results.isCurrent ? judgedDesign(session, verification, shown) : null;
    return judgement?.source === "simulation" ? judgement.sentence : null;
  }
  const copied = (write: (state: DesignState, origin: string, verdict: string | null) => string) => {
    const state = session.state.get();
    return state.points.length > 0 ? write(state, location.origin, simulatedVerdict()) : null;
  };
  return [
    shareButton("Copy a link to this design", () => {
      address.write();
      return undefined;
    }),
    copyMenu([
      { words: "curl", text: () => copied(curlOf) },
      { words: "Command line", text: () => copied(commandOf) },
      { words: "Python", text: () => copied(pythonOf) },
    ]),
  ];
}

/** Opens the card of the part and brings it into sight. */
function openPart(card: HTMLElement): void {
  if (card instanceof HTMLDetailsElement) card.open = true;
  card.scrollIntoView({ block: "start" });
  card.querySelector("summary")?.focus({ preventScroll: true });
}
