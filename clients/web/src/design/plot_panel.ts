// The plot with its toolbar, its legend and the state of the search.
import { announce } from "../base/announce";
import { button } from "../base/controls";
import { h, replace, replaceChanged, svg, uniqueId } from "../base/dom";
import { degrees, digits, percent } from "../base/format";
import { Observable } from "../base/observable";
import { ProgressRow } from "../base/progress_row";
import { touchWords } from "../base/touch_words";
import { Problem } from "../contract/client";
import { entriesAtFault } from "../contract/refusals";
import { CartesianPlot } from "./cartesian_plot";
import { drawnBehind, type Measured } from "./measured";
import type { Overlays } from "./overlays";
import type { Pins } from "./pins";
import type { PlotView, PlotActions } from "./plot";
import { PolarPlot } from "./polar_plot";
import type { ProfilePlot } from "./profile_plot";
import { regionTabs } from "./region_tabs";
import { labelOf } from "./result_card";
import type { SearchActivity } from "./search";
import type { DesignSession } from "./session";
import { judgedDesign, judgedResponse } from "./judged";
import { errorBand, freshness, modelError } from "./shown";
import { openCurve, periodicCurve, targetCurve } from "./spline";
import { type ControlPoint, isPolar, sameProfile, STRAIN_WORDS, TASK_WORDS } from "./state";
import { addPoint, minPoints, movePoint, removePoint, middleOfGapAfter } from "./targets";
import { targetWords } from "./target_list";
import { targetTabs } from "./target_tabs";
import { limits } from "./verdict_words";
import type { Verification } from "./verification";

export class PlotPanel {
  readonly element: HTMLElement;
  private readonly stage = h("div", { class: "stage", role: "tabpanel", id: uniqueId("target") });
  private readonly legend = h("ul", { class: "legend", "aria-label": "Legend" });
  private readonly status = h("div", { class: "status" });
  private readonly reading = h("p", { class: "reading muted" });
  private hovered: number | null = null;
  private readonly progressRow = new ProgressRow("Progress of the search", () => this.session.search.cancel());
  private readonly cartesian: ProfilePlot;
  private readonly polar: ProfilePlot;
  private readonly remove = button("", () => this.removeSelected(), { icon: "minus", title: "Remove the selected control point" });
  private readonly whole = button("", () => this.plot.resetZoom(), { icon: "fit", title: "Show the whole plot" });
  private selected: number | null = null;
  /** Whether a control point is being dragged. */
  readonly dragging = new Observable(false);
  private scheduled = false;

  constructor(
    private readonly session: DesignSession,
    private readonly verification: Verification,
    private readonly pins: Pins,
    private readonly overlays: Overlays,
    private readonly measured: Measured,
    tools: HTMLElement[],
  ) {
    const actions = this.actions();
    this.cartesian = new CartesianPlot(actions);
    this.polar = new PolarPlot(actions);
    const undo = button("", () => session.undo(), { icon: "undo", title: "Undo (Ctrl+Z)" });
    const redo = button("", () => session.redo(), { icon: "redo", title: "Redo (Ctrl+Shift+Z)" });
    const add = button("", () => this.addAfterSelected(), { icon: "plus", title: "Add a control point" });
    const adopt = button("Take as target", () => session.targetEdits.adopt(), { icon: "target", title: "Make the design’s response the target" });
    adopt.classList.add("adopt");
    const toolbar = h("div", { class: "toolbar", role: "toolbar", "aria-label": "Plot" }, undo, redo, h("span", { class: "gap" }), add, this.remove, adopt, this.whole,
      h("span", { class: "stretch" }), ...tools);
    this.whole.hidden = true;
    const region = h("div", { class: "region-panel", id: uniqueId("region") });
    const { element: regions, divide } = regionTabs(session, region);
    const targets = targetTabs(session, verification, this.stage);
    targets.append(h("span", { class: "stretch" }), divide);
    region.append(targets, toolbar, this.stage, this.reading, h("div", { class: "plot-foot" }, this.legend, this.status));
    this.element = h("section", { class: "card plot-card", "aria-label": "Target and response" }, regions, region);
    session.steps.watch((steps) => {
      undo.disabled = !steps.undo;
      redo.disabled = !steps.redo;
    });
    // Another target has other control points, so that none is selected.
    let shownKey = "0 0";
    session.state.watch(({ at, regionAt }) => {
      if (shownKey !== `${at} ${regionAt}`) this.selected = null;
      shownKey = `${at} ${regionAt}`;
    });
    for (
      const part of [session.state, session.results.shown, session.results.previous, session.results.envelope, verification.state, verification.rounds.list, pins.list,
        overlays.list, measured.data]
    ) {
      part.watch(() => this.schedule());
    }
    session.search.activity.watch((activity) => this.showActivity(activity));
    new ResizeObserver(() => this.resize()).observe(this.stage);
  }

  get plot(): ProfilePlot {
    return isPolar(this.session.state.get().task) ? this.polar : this.cartesian;
  }

  private actions(): PlotActions {
    const { session } = this;
    return {
      begin: () => {
        this.dragging.set(true);
        session.gesture();
      },
      move: (index, to) => this.move(index, to),
      end: () => {
        this.dragging.set(false);
        session.finish();
        this.schedule();
      },
      add: (at) => this.add(at),
      remove: (index) => this.removePoint(index),
      select: (index) => {
        this.selected = index;
        this.schedule();
      },
      hover: (x) => {
        this.hovered = x;
        this.schedule();
      },
      zoomed: (isZoomed) => (this.whole.hidden = !isZoomed),
    };
  }

  private move(index: number, to: ControlPoint): void {
    const { task, points } = this.session.state.get();
    const [moved, at] = movePoint(task, points, index, to, this.session.targetEdits.extent);
    this.session.preview({ points: moved, byHand: false });
    if (at === index) return;
    this.selected = at;
    this.draw(); // the handles must have their new order before `follow` moves the focus
    this.plot.follow(at);
  }

  private add(at: ControlPoint): void {
    const { task, points } = this.session.state.get();
    const added = addPoint(task, points, at, this.session.targetEdits.extent);
    if (!added) return announce("There is no room for a control point there.");
    this.session.apply({ points: added[0], byHand: false });
    this.selected = added[1];
    this.draw();
    this.plot.focus(added[1]);
  }

  private addAfterSelected(): void {
    const { task, points, interpolation } = this.session.state.get();
    const x = middleOfGapAfter(task, points, this.selected ?? Math.floor((points.length - 1) / 2));
    this.add([x, targetCurve(isPolar(task), points, interpolation)(x)]);
  }

  private removeSelected(): void {
    if (this.selected !== null) this.removePoint(this.selected);
  }

  private removePoint(index: number): void {
    const { task, points } = this.session.state.get();
    const left = removePoint(task, points, index);
    if (left === points) return announce(`A target needs ${minPoints(task)} control points.`);
    this.selected = null;
    this.session.apply({ points: left, byHand: false });
  }

  /** Schedules one drawing before the next repaint of the browser. */
  private schedule(): void {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => {
      this.scheduled = false;
      this.draw();
    });
  }

  private draw(): void {
    const { plot } = this;
    if (plot.element.parentNode !== this.stage) {
      this.stage.replaceChildren(plot.element);
      plot.resetZoom();
      this.resize();
    }
    const view = this.view();
    plot.update(view);
    this.remove.disabled = this.selected === null || view.points.length <= minPoints(view.task);
    this.showLegend(view);
    this.showReading(view);
  }

  private view(): PlotView {
    const state = this.session.state.get();
    const found = this.session.results.shown.get();
    const fresh = freshness(found, state);
    // An outdated design of this family and kind stays visible, dimmed. One of another family is hidden; its curve is the previous one.
    const shown = fresh === "other" ? null : found;
    const polar = isPolar(state.task);
    const envelope = this.session.results.envelope.get();
    const previous = this.session.results.previous.get();
    const fits = envelope && sameProfile(envelope, state) && envelope.family === shown?.found.family;
    return {
      task: state.task,
      points: state.points,
      selected: this.selected,
      faulty: this.faultyPoints(),
      target: targetCurve(polar, state.points, state.interpolation),
      achieved: shown && { x: shown.x, y: shown.achieved },
      provisional: shown?.provisional ?? false,
      previous: previous && sameProfile(previous, state) ? previous : null,
      envelope: fits ? envelope : null,
      bound: shown?.bound && shown.points === state.points && shown.bound.deviation > limits.sample ? shown.bound : null,
      uncertainty: shown && errorBand(shown, modelError(this.session.catalogue.model(shown.found.family), shown)),
      verified: this.verification.simulated?.curve ?? null,
      rounds: this.verification.rounds.list.get().flatMap(({ curve, isBest }) => (curve ? [{ ...curve, isBest }] : [])),
      measured: drawnBehind(this.measured.data.get(), state),
      pins: [...this.pins.list.get().flatMap((pin) => pin.curve ?? []), ...this.overlays.list.get()],
      hovered: this.hovered === null || polar ? this.hovered : Math.max(state.points[0]?.[0] ?? 0, Math.min(state.points.at(-1)?.[0] ?? 0, this.hovered)),
      // Missed samples are marked only where the target is not reached.
      missed: shown && fresh === "current" && !this.dragging.get() && judgedResponse(this.session, this.verification, shown).grade !== "reached"
        ? shown.x.flatMap((x, k): ControlPoint[] => (shown.reached[k] ? [] : [[x, shown.target[k]]])) : [],
      strainWord: STRAIN_WORDS[state.measure],
      dragging: this.dragging.get(),
    };
  }

  /** The control points of the shown target for which the server has refused the last request. */
  private faultyPoints(): readonly number[] {
    const activity = this.session.search.activity.get();
    if (activity.kind !== "failed" || !(activity.error instanceof Problem)) return [];
    const errors = activity.error.document.errors?.filter(({ pointer }) => !pointer?.includes("/also/"));
    return entriesAtFault({ errors }, "control_points", { list: "regions", index: this.session.state.get().regionAt });
  }

  private resize(): void {
    const box = this.stage.getBoundingClientRect();
    this.plot.resize(Math.max(240, Math.floor(box.width)), Math.max(240, Math.floor(box.height)));
  }

  private showLegend(view: PlotView): void {
    const entry = (shown: boolean, key: string, words: string, mark = "M0 5H22", title = "") =>
      shown && h("li", { title: title || null }, svg("svg", { viewBox: "0 0 22 10", class: `key ${key}`, "aria-hidden": "true" }, svg("path", { d: mark })), words);
    replaceChanged(
      this.legend,
      entry(true, "target", "Target"),
      entry(view.measured.length > 0, "measured", "Measured", "M3 5h0M8 3h0M13 7h0M18 4h0"),
      entry(view.achieved !== null, "achieved",
        view.uncertainty ? `Design, with ${this.session.results.shown.get()?.errorBar ? "error bars (90 %)" : "the model’s mean error"}` : "Design"),
      entry(view.previous !== null, "before", "Before"),
      entry(view.rounds.length > 0, "round", "Rounds of the polish, the best one solid"),
      entry(view.verified !== null, "simulated", "Simulated", "M11 0L16 5 11 10 6 5Z"),
      entry(view.envelope !== null, "reachable", `What ${view.envelope?.family ?? ""} reaches, each value by itself`, "M0 0H22V10H0Z",
        "At each place some design of the family reaches every value in here; one design need not reach a whole curve in here."),
      entry(view.bound !== null, "bound", "Nearest that any material can have at rest", "M0 5H22",
        "Stiffness and Poisson’s ratio over direction follow from one compliance at rest, whatever the structure. With strain a structure may come a little nearer."),
      entry(view.missed.length > 0, "out", "Missed", "M7 1L15 9M15 1L7 9"),
      ...view.pins.map((pin) => entry(true, `pin pin-${pin.id % 6}`, pin.name)),
    );
  }

  /** Shows the values of the curves at the pointer. */
  private showReading(view: PlotView): void {
    const x = view.hovered;
    if (x === null) {
      return replaceChanged(this.reading, this.dragging.get() ? ""
        : touchWords("Point at the plot to read its values; pinch, or turn the wheel with Ctrl, to zoom.", "Touch the plot to read its values, and pinch it to zoom."));
    }
    const polar = isPolar(view.task);
    const { y, unit } = TASK_WORDS[view.task];
    const value = (number: number | null) => (number === null ? "none" : `${digits(number)}${unit && ` ${unit}`}`);
    const at = (curve: { x: readonly number[]; y: readonly (number | null)[] }) => valueAt(curve, x, polar);
    const parts = [`target ${value(view.target(x))}`];
    if (view.achieved) {
      const found = this.session.results.shown.get();
      const bar = found?.errorBar ? at({ x: found.x, y: found.errorBar }) : null;
      parts.push(`${this.session.results.isCurrent ? "design" : "design before"} ${value(at(view.achieved))}${bar === null ? "" : ` ± ${digits(bar, 2)}`}`);
    }
    if (view.verified) parts.push(`simulated ${value(at(view.verified))}`);
    if (view.bound) parts.push(`any material at rest ${value(at(view.bound))}`);
    for (const pin of view.pins) parts.push(`${pin.name.split(",")[0]} ${value(at(pin))}`);
    replaceChanged(this.reading, `${y} at ${polar ? degrees(x) : `a strain of ${digits(x)}`}: ${parts.join(", ")}.`);
  }

  private showActivity(activity: SearchActivity): void {
    const { session } = this;
    this.element.setAttribute("aria-busy", String(activity.kind === "busy"));
    if (activity.kind === "failed") {
      announce(activity.sentence);
      this.schedule(); // control points at fault are marked
      replace(this.status, h("p", { class: "note" }, activity.sentence), button("Try again", () => session.search.retry()));
    } else if (activity.kind === "stopped") {
      replace(this.status, h("p", { class: "muted" }, session.results.isCurrent ? "The search was stopped." : "The search was stopped: what is dimmed is of an earlier target."),
        button("Search again", () => session.search.retry()));
    } else if (activity.kind === "busy" && activity.effort === "search") {
      this.progressRow.show(this.status, activity.stage ? `Searching: ${activity.stage}` : "Searching", activity.progress);
    } else if (activity.kind === "idle") {
      replace(this.status);
      this.tellOutcome();
    }
  }

  private tellOutcome(): void {
    const shown = this.session.results.shown.get();
    if (!shown || this.dragging.get()) return;
    const judgement = judgedDesign(this.session, this.verification, shown);
    const several = shown.targets.length > 1 ? ` ${targetWords(this.session.state.get())}; ${percent(shown.overall)} from all targets` : "";
    const inSight = judgedResponse(this.session, this.verification, shown);
    const off = inSight.source === "simulation" && inSight.deviation !== null ? inSight.deviation : shown.deviation;
    const how = `${labelOf(shown, judgement)}: ${percent(off)} from the target${several}`;
    announce(`${shown.found.family}, parameters ${shown.found.parameters.map((value) => Number(value.toPrecision(3))).join(", ")}. ${how}.`);
  }
}

/** A curve's value by linear interpolation; null outside its samples and for a curve with gaps. */
function valueAt({ x, y }: { x: readonly number[]; y: readonly (number | null)[] }, at: number, polar: boolean): number | null {
  const known = x.flatMap((place, k): ControlPoint[] => (y[k] === null || y[k] === undefined ? [] : [[place, y[k] as number]]));
  if (known.length < x.length || known.length < 2) return null;
  if (polar) return periodicCurve(known[known.length - 1][0] - known[0][0] > Math.PI - 1e-6 ? known.slice(0, -1) : known, "linear")(at);
  const tolerance = 1e-9;
  return at < known[0][0] - tolerance || at > known[known.length - 1][0] + tolerance ? null : openCurve(known, "linear")(at);
}
