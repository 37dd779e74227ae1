// The controls of the target and the search: task, direction or strain, strain measure, interpolation, family, weight.
import type { AccuracyChoice } from "../base/accuracy_choice";
import { AccuracyDial } from "../base/accuracy_dial";
import { Segments, Select, Slider } from "../base/controls";
import { h } from "../base/dom";
import { withTerm } from "../base/terms";
import type { DesignSession } from "./session";
import { ANY, type DesignState, type Interpolation, isPolar, TASK_WORDS, TASKS, WEIGHT_LIMITS } from "./state";

/** `examples`: the menu of example targets. */
export function targetControls(session: DesignSession, examples: HTMLElement): HTMLElement {
  const task = new Segments(
    "What the target shows",
    TASKS.map((value) => ({ value, words: TASK_WORDS[value].short })),
    (value) => void session.targetEdits.setTask(value),
  );
  const direction = new Slider({
    label: "Direction of the load",
    lower: 0,
    upper: 180,
    step: 1,
    digits: 1,
    unit: "°",
    changed: (value, done) => change({ direction: (value * Math.PI) / 180 }, done),
  });
  const strain = new Slider({
    label: "Strain at which it is measured",
    lower: -0.1,
    upper: 0.2,
    step: 0.001,
    digits: 4,
    changed: (value, done) => change({ strain: value }, done),
  });
  const measure = new Select(
    "Measure of strain",
    [{ value: "green", words: "Green strain, 2nd Piola–Kirchhoff stress" }, { value: "engineering", words: "Engineering strain, force over width" }],
    (value) => session.targetEdits.setMeasure(value),
  );
  const curve = new Select<Interpolation>(
    "Curve between control points",
    [{ value: "cubic", words: "Smooth" }, { value: "monotone", words: "Smooth, without overshoot" }, { value: "linear", words: "Straight" }],
    (interpolation) => session.apply({ interpolation }),
  );
  const family = new Select<string>("Family of tilings", [{ value: ANY, words: "Any: the best of all" }], (value) => session.apply({ family: value, byHand: false }));

  const weight = new Slider({
    label: "Weight beside the other targets",
    lower: WEIGHT_LIMITS[0],
    upper: WEIGHT_LIMITS[1],
    step: 0.1,
    digits: 2,
    changed: (value, done) => change({ weight: value }, done),
  });

  function change(values: Partial<Pick<DesignState, "direction" | "strain" | "weight">>, done: boolean): void {
    session.preview(values);
    if (done) session.finish();
  }

  session.state.watch((state) => {
    task.value = state.task;
    direction.value = (state.direction * 180) / Math.PI;
    strain.value = state.strain;
    measure.value = state.measure;
    curve.value = state.interpolation;
    family.setChoices([
      { value: ANY, words: "Any: the best of all" },
      ...session.catalogue.familyModels.map((model) => ({ value: model.family, words: `${model.family} (${parameterCount(model.parameters.lower.length)})` })),
    ]);
    family.value = state.family;
    direction.element.hidden = isPolar(state.task);
    strain.element.hidden = !isPolar(state.task);
    weight.element.hidden = state.others.length === 0;
    weight.value = state.weight;
  });
  const more = h("details", { class: "more" }, h("summary", {}, "More"), withTerm(measure.element, "strain"), curve.element);
  return h("section", { class: "card controls", "aria-label": "Target" }, examples, withTerm(task.element, "stress", "stiffness", "poisson"), withTerm(family.element, "family"),
    direction.element, withTerm(strain.element, "strain"), weight.element, dial(session), more);
}

function dial(session: DesignSession): HTMLElement {
  const element = new AccuracyDial({
    place: "design",
    capabilities: () => ["designs"],
    measures: session.search.measures,
    choose: (level) => session.apply({ accuracy: { ...session.state.get().accuracy, level } }),
  });
  let shown: AccuracyChoice["level"] | undefined;
  session.state.watch(({ accuracy }) => {
    if (accuracy.level !== shown) element.value = accuracy.level;
    shown = accuracy.level;
  });
  return element.element;
}

function parameterCount(count: number): string {
  return `${count} parameter${count === 1 ? "" : "s"}`;
}
