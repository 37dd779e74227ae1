// The dial of accuracy: draft, normal, sure, or values of one's own, with the seconds and the error that each takes on this machine.
import { announce } from "./announce";
import { type AccuracyChoice, rememberLevel } from "./accuracy_choice";
import { type Capability, estimate, levelRow, type LevelMeasures, LEVELS } from "./accuracy_levels";
import { estimateSentence, levelErrorWords, secondsWords } from "./accuracy_words";
import { h, uniqueId, writeText } from "./dom";

type Choice = AccuracyChoice["level"];

const WORDS: Record<Choice, string> = { draft: "Draft", normal: "Normal", sure: "Sure", own: "Own" };

export interface DialOptions {
  /** Where the choice is remembered. */
  readonly place: string;
  /** What is computed at the level. The numbers at the buttons are those of the first. */
  readonly capabilities: () => readonly Capability[];
  readonly measures: LevelMeasures;
  readonly choose: (level: Choice) => void;
  /** The controls of one's own values; without them there are none to choose. `words`: their heading. */
  readonly own?: { readonly words: string; readonly controls: readonly HTMLElement[] };
}

export class AccuracyDial {
  readonly element: HTMLElement;
  private readonly inputs = new Map<Choice, HTMLInputElement>();
  private readonly details = new Map<Choice, HTMLElement>();
  private readonly words = h("p", { class: "muted dial-words" });
  private level: Choice = "normal";

  constructor(private readonly options: DialOptions) {
    const name = uniqueId("accuracy");
    const row = h("div", { class: "segment-row" });
    const choices: readonly Choice[] = options.own ? [...LEVELS, "own"] : LEVELS;
    for (const value of choices) {
      const detail = h("small", { id: uniqueId("level") });
      const input = h("input", { type: "radio", name, value, "aria-label": WORDS[value], "aria-describedby": detail.id, onchange: () => this.choose(value) });
      this.inputs.set(value, input);
      this.details.set(value, detail);
      row.append(h("label", {}, input, h("span", {}, WORDS[value], detail)));
    }
    const { own } = options;
    this.element = h("div", { class: "accuracy-dial" }, h("fieldset", { class: "segments" }, h("legend", {}, "Accuracy"), row), this.words,
      own && h("details", { class: "more own-values" }, h("summary", {}, own.words), ...own.controls));
    options.measures.last.watch(() => this.update());
  }

  set value(level: Choice) {
    this.level = level;
    // A link may choose values of one's own where there are none.
    const input = this.inputs.get(level) ?? this.inputs.get("normal");
    if (input) input.checked = true;
    this.update();
  }

  /** Shows seconds and errors again, for example because something else is computed. */
  update(): void {
    const { capabilities, measures } = this.options;
    const parts = capabilities();
    this.element.hidden = parts.length === 0;
    if (parts.length === 0) return;
    for (const [level, detail] of this.details) {
      const known = estimate(parts[0], level, measures.of(parts[0]));
      writeText(detail, [secondsWords(known), levelErrorWords(level, known.error)].filter((words) => words).join(", "));
    }
    writeText(this.words, parts.map((part) => this.sentence(part)).join(" "));
    this.words.title = levelRow(parts[0], this.level)?.task ?? "";
  }

  private sentence(capability: Capability): string {
    const row = levelRow(capability, this.level);
    const told = estimateSentence(capability, this.level, estimate(capability, this.level, this.options.measures.of(capability)), row?.error_of ?? "");
    return row ? `${told} ${row.why}` : told;
  }

  private choose(level: Choice): void {
    rememberLevel(this.options.place, level);
    this.options.choose(level);
    const details = this.element.querySelector("details");
    if (level === "own" && details) details.open = true;
    announce(`Accuracy: ${WORDS[level]}.`, "change");
  }
}
