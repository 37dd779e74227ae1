// The plot with its tools, its legend and what is going on.
import { announce } from "../base/announce";
import { button } from "../base/controls";
import { h, replace, svg } from "../base/dom";
import { percent } from "../base/format";
import { Working } from "../base/working";
import { CartesianPlot } from "./cartesian_plot";
import { drawnBehind, type Measured } from "./measured";
import { readFile } from "./measured_card";
import type { Pins } from "./pins";
import type { PlotView, PlotWishes } from "./plot";
import { PolarPlot } from "./polar_plot";
import type { ProfilePlot } from "./profile_plot";
import { isReached } from "./result_card";
import type { Activity, DesignSession } from "./session";
import { errorBand, modelError } from "./shown";
import { targetCurve } from "./spline";
import { type ControlPoint, isPolar, sameProfile, STRAIN_WORDS } from "./state";
import { addPoint, fewestPoints, movePoint, removePoint, roomAfter } from "./targets";
import type { Verification } from "./verification";

export class PlotPanel {
  readonly element: HTMLElement;
  private readonly stage = h("div", { class: "stage" });
  private readonly legend = h("ul", { class: "legend", "aria-label": "Legend" });
  private readonly status = h("div", { class: "status" });
  private readonly working = new Working("Progress of the search", () => this.session.cancel());
  private readonly cartesian: ProfilePlot;
  private readonly polar: ProfilePlot;
  private readonly remove = button("", () => this.removeSelected(), { icon: "minus", title: "Remove the selected control point" });
  private selected: number | null = null;
  private dragging = false;
  private scheduled = false;

  constructor(
    private readonly session: DesignSession,
    private readonly verification: Verification,
    private readonly pins: Pins,
    private readonly measured: Measured,
    tools: HTMLElement[],
  ) {
    const wishes = this.wishes();
    this.cartesian = new CartesianPlot(wishes);
    this.polar = new PolarPlot(wishes);
    const undo = button("", () => session.undo(), { icon: "undo", title: "Undo (Ctrl+Z)" });
    const redo = button("", () => session.redo(), { icon: "redo", title: "Redo (Ctrl+Shift+Z)" });
    const add = button("", () => this.addAfterSelected(), { icon: "plus", title: "Add a control point" });
    const adopt = button("Take as target", () => session.adoptAsTarget(), { title: "Make the design’s response the target" });
    const toolbar = h("div", { class: "toolbar", role: "toolbar", "aria-label": "Plot" }, undo, redo, h("span", { class: "gap" }), add, this.remove, adopt, h("span", { class: "stretch" }), ...tools);
    this.element = h("section", { class: "card plot-card", "aria-label": "Target and response" }, toolbar, this.stage, h("div", { class: "plot-foot" }, this.legend, this.status));
    session.steps.watch((steps) => {
      undo.disabled = !steps.undo;
      redo.disabled = !steps.redo;
    });
    for (const part of [session.state, session.shown, session.before, session.envelope, verification.state, pins.list, measured.data]) {
      part.watch(() => this.schedule());
    }
    session.activity.watch((activity) => this.showActivity(activity));
    this.takeDroppedFiles();
    new ResizeObserver(() => this.resize()).observe(this.stage);
  }

  get plot(): ProfilePlot {
    return isPolar(this.session.state.get().task) ? this.polar : this.cartesian;
  }

  /** A file of measured data that is dropped onto the plot becomes the target. */
  private takeDroppedFiles(): void {
    const over = (event: DragEvent, is: boolean) => {
      event.preventDefault();
      this.stage.classList.toggle("dropping", is);
    };
    this.stage.addEventListener("dragover", (event) => over(event, true));
    this.stage.addEventListener("dragleave", (event) => over(event, false));
    this.stage.addEventListener("drop", (event) => {
      over(event, false);
      const file = event.dataTransfer?.files[0];
      if (file) void readFile(this.measured, file);
    });
  }

  private wishes(): PlotWishes {
    const { session } = this;
    return {
      begin: () => {
        this.dragging = true;
        session.gesture();
      },
      move: (index, to) => this.move(index, to),
      end: () => {
        this.dragging = false;
        session.finish();
        this.schedule();
      },
      add: (at) => this.add(at),
      remove: (index) => this.removePoint(index),
      select: (index) => {
        this.selected = index;
        this.schedule();
      },
    };
  }

  private move(index: number, to: ControlPoint): void {
    const { task, points } = this.session.state.get();
    const [moved, at] = movePoint(task, points, index, to, this.session.extent);
    this.session.preview({ points: moved, byHand: false });
    if (at === index) return;
    this.selected = at;
    this.draw(); // the handles take their new places before one of them is held on to
    this.plot.follow(at);
  }

  private add(at: ControlPoint): void {
    const { task, points } = this.session.state.get();
    const added = addPoint(task, points, at, this.session.extent);
    if (!added) return announce("There is no room for a control point there.");
    this.session.apply({ points: added[0], byHand: false });
    this.selected = added[1];
    this.draw();
    this.plot.focus(added[1]);
  }

  private addAfterSelected(): void {
    const { task, points, interpolation } = this.session.state.get();
    const x = roomAfter(task, points, this.selected ?? Math.floor((points.length - 1) / 2));
    this.add([x, targetCurve(isPolar(task), points, interpolation)(x)]);
  }

  private removeSelected(): void {
    if (this.selected !== null) this.removePoint(this.selected);
  }

  private removePoint(index: number): void {
    const { task, points } = this.session.state.get();
    const left = removePoint(task, points, index);
    if (left === points) return announce(`A target needs ${fewestPoints(task)} control points.`);
    this.selected = null;
    this.session.apply({ points: left, byHand: false });
  }

  /** Draws once before the next picture, however much has changed. */
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
      this.resize();
    }
    const view = this.view();
    plot.update(view);
    this.remove.disabled = this.selected === null || view.points.length <= fewestPoints(view.task);
    this.showLegend(view);
  }

  private view(): PlotView {
    const state = this.session.state.get();
    const found = this.session.shown.get();
    const shown = found && sameProfile(found, state) ? found : null;
    const envelope = this.session.envelope.get();
    const verified = this.verification.state.get();
    const before = this.session.before.get();
    const fits = envelope && sameProfile(envelope, state) && envelope.family === shown?.found.family;
    return {
      task: state.task,
      points: state.points,
      selected: this.selected,
      target: targetCurve(isPolar(state.task), state.points, state.interpolation),
      achieved: shown && { x: shown.x, y: shown.achieved },
      provisional: shown?.provisional ?? false,
      before: before && sameProfile(before, state) ? before : null,
      envelope: fits ? envelope : null,
      doubt: shown && errorBand(shown, modelError(this.session.model(shown.found.family), shown)),
      verified: verified.kind === "done" ? verified.curve : null,
      measured: drawnBehind(this.measured.data.get(), state),
      pins: this.pins.list.get().flatMap((pin) => pin.curve ?? []),
      missed: shown && !this.dragging ? shown.x.flatMap((x, k): ControlPoint[] => (shown.reached[k] ? [] : [[x, shown.target[k]]])) : [],
      strainWord: STRAIN_WORDS[state.measure],
      dragging: this.dragging,
    };
  }

  private resize(): void {
    const box = this.stage.getBoundingClientRect();
    this.plot.resize(Math.max(240, Math.floor(box.width)), Math.max(240, Math.floor(box.height)));
  }

  private showLegend(view: PlotView): void {
    const entry = (shown: boolean, key: string, words: string, mark = "M0 5H22") =>
      shown && h("li", {}, svg("svg", { viewBox: "0 0 22 10", class: `key ${key}`, "aria-hidden": "true" }, svg("path", { d: mark })), words);
    replace(
      this.legend,
      entry(true, "target", "Target"),
      entry(view.measured.length > 0, "measured", "Measured", "M3 5h0M8 3h0M13 7h0M18 4h0"),
      entry(view.achieved !== null, "achieved", view.doubt ? `Design, with ${this.session.shown.get()?.errorBar ? "error bars (90 %)" : "the model’s mean error"}` : "Design"),
      entry(view.before !== null, "before", "Before"),
      entry(view.verified !== null, "simulated", "Simulated", "M11 0L16 5 11 10 6 5Z"),
      entry(view.envelope !== null, "reachable", `Within reach of ${view.envelope?.family ?? ""}`, "M0 0H22V10H0Z"),
      entry(view.missed.length > 0, "out", "Missed", "M7 1L15 9M15 1L7 9"),
    );
  }

  private showActivity(activity: Activity): void {
    const { session } = this;
    this.element.setAttribute("aria-busy", String(activity.kind === "busy"));
    if (activity.kind === "failed") {
      announce(activity.sentence);
      replace(this.status, h("p", { class: "note" }, activity.sentence), button("Try again", () => session.retry()));
    } else if (activity.kind === "busy" && activity.effort === "search") {
      this.working.show(this.status, activity.stage ? `Searching: ${activity.stage}` : "Searching", activity.progress);
    } else if (activity.kind === "idle") {
      replace(this.status);
      this.tellOutcome();
    }
  }

  private tellOutcome(): void {
    const shown = this.session.shown.get();
    if (!shown || this.dragging) return;
    const how = isReached(shown) ? "Target reached" : `Deviation ${percent(shown.deviation)}`;
    announce(`${shown.found.family}, parameters ${shown.found.parameters.map((value) => Number(value.toPrecision(3))).join(", ")}. ${how}.`);
  }
}
