// The card with the polar plots of Young's modulus and Poisson's ratio, the strain, and the state of the computation.
import { withError } from "../base/accuracy_words";
import { announce } from "../base/announce";
import { button, Segments, Slider } from "../base/controls";
import type { Curve } from "../base/curve";
import { h, replace, svg } from "../base/dom";
import { EffectChips } from "../base/effect_chips";
import { chipsOf, outdated } from "../base/effect_words";
import { degrees, digits, quantity } from "../base/format";
import { ProgressRow } from "../base/progress_row";
import { withTerm } from "../base/terms";
import type { DeformedCell } from "./deformed_cell";
import type { Pins } from "./pins";
import { type ChartView, PolarChart } from "./polar_chart";
import { extremes, gapWords, nearestDirection, poissonCurve, type Profile, youngsCurve, youngsErrorAt } from "./profile";
import { type ProfileActivity, profileKey, type WeaveSession } from "./session";
import { isPeriodic, STRAIN_LIMITS, usableStrain } from "./state";

const MIN_SIDE = 220;

export class ProfileCard {
  readonly element: HTMLElement;
  readonly charts: readonly [PolarChart, PolarChart];
  private readonly stages = [h("div", { class: "chart-stage" }), h("div", { class: "chart-stage" })];
  private readonly reading = h("p", { class: "reading" });
  private readonly legend = h("ul", { class: "legend", "aria-label": "Legend" });
  private readonly notes = h("div", { class: "notes" });
  private readonly chips = new EffectChips("What was computed", (effect, value) => this.session.setEffect(effect, value));
  private readonly status = h("div", { class: "status" });
  private readonly progressRow = new ProgressRow("Progress", () => this.session.cancel());
  private logarithmic = false;
  private scheduled = false;
  private announcedKey = "";

  constructor(
    private readonly session: WeaveSession,
    private readonly deformed: DeformedCell,
    private readonly pins: Pins,
  ) {
    const actions = {
      hover: (angle: number | null) => deformed.hover(angle),
      choose: (angle: number) => deformed.choose(angle),
      step: (count: number) => deformed.step(count),
    };
    this.charts = [
      new PolarChart({ kind: "stiffness", title: "Young’s modulus", unit: "N/m", ...actions }),
      new PolarChart({ kind: "poisson", title: "Poisson’s ratio", unit: "", ...actions }),
    ];
    this.stages.forEach((stage, k) => {
      stage.append(this.charts[k].element);
      new ResizeObserver(() => this.resize(k)).observe(stage);
    });
    this.element = h("section", { class: "card profile", "aria-label": "Stiffness over direction" }, this.controls(), h("div", { class: "charts" }, ...this.stages), this.reading,
      this.chips.element, h("div", { class: "plot-foot" }, this.legend, this.status), this.notes);
    for (const part of [session.profile, session.state, deformed.direction, pins.list]) part.watch(() => this.schedule());
    session.activity.watch((activity) => this.showActivity(activity));
    session.fault.watch(() => this.showActivity(session.activity.get()));
  }

  private controls(): HTMLElement {
    const strain = new Slider({
      label: "Strain along each direction",
      lower: STRAIN_LIMITS[0],
      upper: STRAIN_LIMITS[1],
      step: 0.005,
      digits: 4,
      changed: (value, done) => {
        this.session.preview({ strain: usableStrain(value) });
        if (done) this.session.finish();
      },
    });
    const scale = new Segments<"linear" | "log">("Scale of the modulus", [{ value: "linear", words: "Linear" }, { value: "log", words: "Logarithmic" }], (value) => {
      this.logarithmic = value === "log";
      this.schedule();
    });
    scale.value = "linear";
    this.session.state.watch((state) => (strain.value = state.strain));
    return h("div", { class: "profile-controls" }, withTerm(strain.element, "strain", "homogenization"), withTerm(scale.element, "youngs_modulus", "poisson"));
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
    const profile = this.session.profile.get();
    const direction = this.deformed.direction.get();
    const index = profile && nearestDirection(profile, direction);
    const pins = this.pins.list.get();
    const stale = profile !== null && profile.key !== profileKey(this.session.state.get());
    const view = (curve: Curve | null, part: "youngs" | "poisson"): ChartView => ({
      curve,
      provisional: stale || (profile?.provisional ?? false),
      reasons: profile?.reasons ?? [],
      pins: pins.map((pin) => ({ id: pin.id, name: pin.name, x: pin.profile.directions, y: pin.profile[part] })),
      direction,
      value: profile && index !== null ? profile[part][index] : null,
      logarithmic: this.logarithmic && part === "youngs",
    });
    this.charts[0].update(view(profile && youngsCurve(profile), "youngs"));
    this.charts[1].update(view(profile && poissonCurve(profile), "poisson"));
    this.showReading(profile, index);
    this.showLegend(profile);
    const { space, accuracy } = this.session.state.get();
    const switched = (name: string) => accuracy.switches[name] ?? "automatic";
    const settings = { buckling: switched("buckling"), out_of_plane: space, error_estimate: switched("error_estimate") };
    const chips = chipsOf(profile?.effects ?? [], settings, profile?.accuracy);
    this.chips.show(stale ? outdated(chips) : chips);
    replace(this.notes, ...notesOf(profile).map((sentence) => h("p", { class: "note" }, sentence)));
  }

  private showReading(profile: Profile | null, index: number | null): void {
    if (!profile || index === null) return replace(this.reading);
    const [youngs, poisson] = [profile.youngs[index], profile.poisson[index]];
    const value = (number: number | null, unit: string) => h("strong", {}, number === null ? "–" : quantity(number, unit, 4));
    const told = (error: string) => error !== "" && h("span", { class: "number-error" }, ` ${error}`);
    replace(this.reading, `At ${degrees(profile.directions[index])}: Young’s modulus `, value(youngs, "N/m"), told(withError("", youngsErrorAt(profile, index)).trim()),
      ", Poisson’s ratio ", value(poisson, ""), told(absoluteError(profile.poissonError[index])), ".");
  }

  private showLegend(profile: Profile | null): void {
    const entry = (key: string, words: string, mark = "M0 5H22") =>
      h("li", {}, svg("svg", { viewBox: "0 0 22 10", class: `key ${key}`, "aria-hidden": "true" }, svg("path", { d: mark })), words);
    const pins = this.pins.list.get().map((pin) => entry(`pin pin-${pin.id % 6}`, pin.name));
    const gaps = profile?.reasons.some((reason) => reason !== null) ? [entry("out", "No value", "M7 1L15 9M15 1L7 9")] : [];
    replace(this.legend, entry("achieved", "This weave"), ...pins, ...gaps);
  }

  private resize(index: number): void {
    const { width, height } = this.stages[index].getBoundingClientRect();
    this.charts[index].resize(Math.max(MIN_SIDE, Math.floor(width)), Math.max(MIN_SIDE, Math.floor(height)));
  }

  private showActivity(activity: ProfileActivity): void {
    const { session } = this;
    this.element.setAttribute("aria-busy", String(activity.kind === "busy"));
    if (activity.kind === "failed") {
      // A fault that the layout reports, too, is not repeated here.
      if (activity.sentence === session.fault.get()) return replace(this.status);
      announce(activity.sentence);
      replace(this.status, h("p", { class: "note" }, activity.sentence), button("Try again", () => session.retry()));
    } else if (activity.kind === "busy") {
      this.progressRow.show(this.status, `${activity.directions} directions`, activity.progress);
    } else {
      replace(this.status);
      this.tellOutcome();
    }
  }

  private tellOutcome(): void {
    const profile = this.session.profile.get();
    if (!profile || profile.key === this.announcedKey || !isPeriodic(this.session.state.get())) return;
    this.announcedKey = profile.key;
    const [youngs, poisson] = [extremes(profile.youngs), extremes(profile.poisson)];
    if (youngs && poisson) {
      announce(`Young’s modulus ${digits(youngs[0])} to ${digits(youngs[1])} newton per metre, Poisson’s ratio ${digits(poisson[0])} to ${digits(poisson[1])}.`);
    }
  }
}

/** An error in the unit of its number; empty where it is not known. */
function absoluteError(error: number | null | undefined): string {
  return error === null || error === undefined ? "" : `± ${digits(error, 2)}`;
}

function notesOf(profile: Profile | null): string[] {
  if (!profile) return [];
  const words = gapWords(profile);
  const count = profile.directions.length;
  if (profile.outOfPlane > 0) words.push(`Along ${profile.outOfPlane} of ${count} directions the weave leaves its plane.`);
  if (profile.unstable > 0) words.push(`Along ${profile.unstable} of ${count} directions the equilibrium is not stable.`);
  if (profile.shortOfLimits > 0) {
    const error = profile.limitError === null ? "" : `: energies may be up to ${digits(100 * profile.limitError, 2)} % too high`;
    words.push(`Along ${profile.shortOfLimits} of ${count} directions sliders stand short of their limits${error}.`);
  }
  return words;
}
