// The card of a sheet under load: controls of sheet and load, and the results.
import { withError } from "../base/accuracy_words";
import { announce } from "../base/announce";
import { button, Select, Slider } from "../base/controls";
import { h, replace } from "../base/dom";
import { EffectChips } from "../base/effect_chips";
import { chipsOf } from "../base/effect_words";
import { download } from "../base/download";
import { digits, percent, seconds } from "../base/format";
import type { Observable } from "../base/observable";
import { ProgressRow } from "../base/progress_row";
import { TERMINATION_WORDS } from "./profile";
import type { WeaveSession } from "./session";
import { LOAD_WORDS, loadForce } from "./sheet";
import { unknownWords } from "./sheet_layout";
import { sheetKey, type SheetResult, type SheetSession } from "./sheet_session";
import { type Lines, SheetViewer } from "./sheet_viewer";
import { isPeriodic, type LoadKind, MAX_AMOUNT, MAX_CELLS, type SheetState } from "./state";
import type { Vector } from "./tubes";

/** `unprintable`: why the sheet cannot be printed, empty otherwise; `print` opens the print dialog. */
export function sheetCard(session: WeaveSession, sheet: SheetSession, unprintable: Observable<string>, print: () => void): HTMLElement {
  const body = h("div", { class: "sheet-body", hidden: true });
  const stale = h("p", { class: "note", hidden: true }, "The weave or its load has changed since: simulate again.");
  const status = h("div", { class: "status" });
  const unprinted = h("p", { class: "note", hidden: true });
  const progressRow = new ProgressRow("Progress of the simulation", () => sheet.cancel());
  let view: SheetView | null = null;

  sheet.result.watch((result) => {
    if (!result) return;
    view ??= new SheetView(sheet);
    replace(body, view.element);
    body.hidden = false;
    view.show(result);
  });
  for (const part of [session.state, sheet.result]) {
    part.watch(() => {
      const result = sheet.result.get();
      stale.hidden = !result || sheetKey(result.state) === sheetKey(session.state.get());
    });
  }
  unprintable.watch((words) => {
    unprinted.hidden = words === "";
    unprinted.textContent = words;
  });
  sheet.activity.watch((activity) => {
    if (activity.kind === "busy") return progressRow.show(status, activity.words, activity.progress);
    if (activity.kind !== "failed") return replace(status);
    announce(activity.sentence);
    replace(status, h("p", { class: "note" }, activity.sentence));
  });
  return h("section", { class: "card sheet", "aria-label": "Sheet under load" }, h("h2", {}, "Sheet under load"), sheetControls(session, sheet, print), unprinted, status, stale,
    body);
}

function sheetControls(session: WeaveSession, sheet: SheetSession, openPrint: () => void): HTMLElement {
  const change = (values: Partial<SheetState>, done: boolean) => {
    session.preview({ sheet: { ...session.state.get().sheet, ...values } });
    if (done) session.finish();
  };
  const count = (label: string, set: (value: number) => Partial<SheetState>) =>
    new Slider({ label, lower: 1, upper: MAX_CELLS, step: 1, digits: 0, changed: (value, done) => change(set(Math.round(value)), done) });
  const columns = count("Cells along x", (value) => ({ columns: value }));
  const rows = count("Cells along y", (value) => ({ rows: value }));
  const load = new Select<LoadKind>("Load", [], (value) => change({ load: value }, true));
  const amount = new Slider({
    label: "How far, in shares of the sheet",
    lower: -MAX_AMOUNT,
    upper: MAX_AMOUNT,
    step: 0.01,
    digits: 3,
    changed: (value, done) => change({ amount: value }, done),
  });
  const run = button("Simulate", () => void sheet.run(), { kind: "primary" });
  const print = button("Print", openPrint, { icon: "printer", title: "See how the sheet is printed, and save its G-code" });
  let kinds = "";
  session.state.watch((state) => {
    const offered: LoadKind[] = state.pattern === "actuated_rings" ? ["push"] : ["stretch_x", "stretch_y", "shear"];
    if (kinds !== offered.join()) load.setChoices(offered.map((value) => ({ value, words: LOAD_WORDS[value] })));
    kinds = offered.join();
    load.value = state.sheet.load;
    columns.value = state.sheet.columns;
    rows.value = state.sheet.rows;
    amount.value = state.sheet.amount;
    columns.element.hidden = rows.element.hidden = !isPeriodic(state);
  });
  session.laidOut.watch((laidOut) => (run.disabled = print.disabled = !laidOut));
  return h("div", { class: "sheet-controls" }, columns.element, rows.element, load.element, amount.element, h("div", { class: "row" }, run, print));
}

/** The view of a result: its states, beginning with rest, in 3D and as facts. */
class SheetView {
  readonly element = h("div", { class: "sheet-view" });
  private readonly facts = h("dl", { class: "facts" });
  private readonly notes = h("div", { class: "notes" });
  private readonly chips = new EffectChips("What was computed of the sheet");
  private readonly slider = h("div");
  private readonly files: HTMLButtonElement[];
  private readonly viewer: SheetViewer | null;
  private result: SheetResult | null = null;
  private states: Lines[] = [];
  private index = 0;

  constructor(private readonly sheet: SheetSession) {
    this.viewer = makeViewer();
    this.files = (["obj", "vtu"] as const).map((kind) =>
      button(kind.toUpperCase(), () => void this.save(kind), { icon: "download", title: `Save this state as ${kind.toUpperCase()}` })
    );
    const stage = this.viewer?.element ?? h("p", { class: "note" }, "This browser shows no 3D drawings (WebGL is missing); results are given as numbers.");
    this.element.append(stage,
      h("div", { class: "sheet-side" }, this.slider, this.facts, this.chips.element, this.notes, h("div", { class: "row" }, ...this.files),
        h("p", { class: "muted" }, "Drag to turn, scroll to come nearer; with the keyboard: arrows and + −.")));
  }

  show(result: SheetResult): void {
    this.result = result;
    const rest = result.layout.strands.map(({ polyline }) => polyline.map(([x, y]): Vector => [x, y, 0]));
    this.states = [rest, ...result.answer.states.map((state) => (state.strands ?? []) as unknown as Lines)];
    this.index = this.states.length - 1;
    const slider = new Slider({
      label: "State along the load",
      lower: 0,
      upper: Math.max(1, this.index),
      step: 1,
      digits: 0,
      changed: (value) => {
        this.index = Math.round(value);
        this.draw();
      },
    });
    slider.value = this.index;
    slider.disabled = this.states.length < 2;
    replace(this.slider, slider.element);
    this.viewer?.setSheet([rest, this.states[this.index]]);
    this.chips.show(chipsOf(result.answer.effects, {}, result.answer.accuracy));
    replace(this.notes, ...notesOf(result).map((sentence) => h("p", { class: "note" }, sentence)));
    this.draw();
    announce(this.factsNow().map(([term, value]) => `${term}: ${value}`).join(". "));
  }

  private draw(): void {
    const { result } = this;
    if (!result) return;
    const facts = this.factsNow();
    const radii = result.layout.strands.map((strand) => strand.radius);
    this.viewer?.setStrands(this.states[this.index], radii, `Sheet. ${facts.map(([term, value]) => `${term}: ${value}`).join(", ")}`);
    replace(this.facts, ...facts.flatMap(([term, value]) => [h("dt", {}, term), h("dd", {}, value)]));
    for (const file of this.files) file.disabled = this.index === 0;
  }

  private factsNow(): [string, string][] {
    const { result, index } = this;
    if (!result) return [];
    const { load, amount } = result.state.sheet;
    if (index === 0) return [["Load", "none: at rest"]];
    const state = result.answer.states[index - 1];
    const heights = (state.strands ?? []).flatMap((line) => line.map((place) => Math.abs(place[2])));
    const rise = heights.reduce((max, height) => Math.max(max, height), 0);
    return [
      [LOAD_WORDS[load], percent(amount * state.share)],
      ["Force", withError(`${digits(loadForce(result.answer, index - 1, load))} N`, forceError(result.answer))],
      ["Elastic energy", `${digits(state.energy)} N mm`],
      ["Rise out of the plane", state.out_of_plane ? `${digits(rise)} mm` : "none"],
      ["Equilibrium", state.stopped === "converged" ? (state.stable ? "stable" : "not stable") : TERMINATION_WORDS[state.stopped]],
      ["Time", seconds(result.answer.cost.seconds)],
    ];
  }

  private save(kind: "obj" | "vtu"): Promise<void> {
    const name = `sheet-${this.index}.${kind}`;
    return this.sheet.file(kind, this.index - 1, (text) => download(name, kind === "obj" ? "model/obj" : "application/xml", text));
  }
}

/** The estimated error of forces; null where the answer does not state one. */
function forceError({ accuracy }: { readonly accuracy: object }): number | null {
  const { discretization_error } = accuracy as { discretization_error?: { reactions?: number } | null };
  return discretization_error?.reactions ?? null;
}

function makeViewer(): SheetViewer | null {
  try {
    return new SheetViewer();
  } catch {
    return null;
  }
}

function notesOf(result: SheetResult): string[] {
  return [result.answer.message, unknownWords(result)].filter((words) => words !== "");
}
