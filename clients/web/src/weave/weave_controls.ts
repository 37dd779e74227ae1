// The controls of the weave: pattern, type and lengths; under "More" the settings of the computation.
import { AccuracyDial } from "../base/accuracy_dial";
import { Select, Slider } from "../base/controls";
import { h, replace } from "../base/dom";
import { type LengthName, lengthLimits, LENGTH_WORDS, type PatternId, PATTERN_IDS, PATTERNS, withLength } from "./patterns";
import type { WeaveSession } from "./session";
import { type LoadKind, MAX_SEGMENTS, type WeaveState } from "./state";

export function weaveControls(session: WeaveSession): HTMLElement {
  const pattern = new Select<PatternId>("Pattern", PATTERN_IDS.map((value) => ({ value, words: PATTERNS[value].words })), (value) => choose(value));
  const type = new Select<string>("Connections of its crossings", [], (value) => session.apply({ type: Number(value), overrides: [] }));
  const lengths = h("div", { class: "parameters" });
  const radius = lengthSlider("radius");
  let shownPattern: PatternId | null = null;
  let sliders: [LengthName, Slider][] = [["radius", radius]];

  function choose(value: PatternId): void {
    const { sheet } = session.state.get();
    const load: LoadKind = value === "actuated_rings" ? "push" : sheet.load === "push" ? "stretch_x" : sheet.load;
    session.apply({ pattern: value, type: 1, overrides: [], sheet: { ...sheet, load } });
  }

  function lengthSlider(name: LengthName): Slider {
    const [lower, upper] = lengthLimits(name, session.state.get().lengths);
    return new Slider({
      label: LENGTH_WORDS[name],
      lower,
      upper,
      digits: 3,
      unit: "mm",
      changed: (value, done) => {
        session.preview({ lengths: withLength(session.state.get().lengths, name, value) });
        if (done) session.finish();
      },
    });
  }

  function build(state: WeaveState): void {
    const { lengths: names, types } = PATTERNS[state.pattern];
    shownPattern = state.pattern;
    type.setChoices(types.map((words, k) => ({ value: String(k + 1), words })));
    type.element.hidden = types.length === 0;
    sliders = [...names.map((name): [LengthName, Slider] => [name, lengthSlider(name)]), ["radius", radius]];
    replace(lengths, ...sliders.map(([, slider]) => slider.element));
  }

  session.state.watch((state) => {
    if (shownPattern !== state.pattern) build(state);
    pattern.value = state.pattern;
    type.value = String(state.type);
    for (const [name, slider] of sliders) {
      slider.limit(...lengthLimits(name, state.lengths));
      slider.value = state.lengths[name];
    }
  });
  return h("section", { class: "card controls", "aria-label": "Weave" }, pattern.element, type.element, lengths, dial(session), moreControls(session));
}

/** The dial of accuracy; a number of pieces of rod is a value of one's own. */
function dial(session: WeaveSession): HTMLElement {
  const segments = new Slider({
    label: "Pieces of rod between crossings",
    lower: 1,
    upper: MAX_SEGMENTS,
    step: 1,
    digits: 0,
    changed: (value, done) => {
      session.preview({ segments: Math.round(value), accuracy: { ...session.state.get().accuracy, level: "own" } });
      if (done) session.finish();
    },
  });
  const element = new AccuracyDial({
    place: "weave",
    capabilities: () => ["weaves"],
    measures: session.measures,
    choose: (level) => session.apply({ accuracy: { ...session.state.get().accuracy, level } }),
    own: { words: "Own values", controls: [segments.element] },
  });
  session.state.watch((state) => {
    segments.value = state.segments;
    element.value = state.accuracy.level;
  });
  return element.element;
}

function moreControls(session: WeaveSession): HTMLElement {
  const modulus = new Slider({
    label: "Young’s modulus of the material",
    lower: 1,
    upper: 10_000,
    step: 1,
    digits: 2,
    unit: "MPa",
    changed: (value, done) => change({ youngsModulus: value }, done),
  });
  const shear = new Select<WeaveState["shear"]>(
    "Shear across the load",
    [{ value: "free", words: "Free: uniaxial stress" }, { value: "suppressed", words: "Suppressed, as some publications have it" }],
    (value) => session.apply({ shear: value }),
  );
  const space = new Select<WeaveState["space"]>(
    "Out of the plane",
    [{ value: "automatic", words: "Where it buckles" }, { value: "on", words: "Always" }, { value: "off", words: "Never" }],
    (value) => session.apply({ space: value }),
  );

  function change(values: Partial<WeaveState>, done: boolean): void {
    session.preview(values);
    if (done) session.finish();
  }

  session.state.watch((state) => {
    modulus.value = state.youngsModulus;
    shear.value = state.shear;
    space.value = state.space;
  });
  return h("details", { class: "more" }, h("summary", {}, "More"), modulus.element, shear.element, space.element);
}
