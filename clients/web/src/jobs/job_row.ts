// A row of the tray: what a job is, how far it is, the best so far, and buttons. It keeps its elements, since buttons that are replaced would lose the focus.
import { button } from "../base/controls";
import { h } from "../base/dom";
import { stateWords } from "./job_words";
import { isUnfinished, type KeptJob } from "./kept_jobs";

/** What a row shows of a job. */
export type RowJob = Pick<KeptJob, "id" | "words" | "state" | "progress" | "remaining" | "took" | "found" | "isBackground">;

export interface RowActions {
  /** Shows the result, or what there is of it; absent if there is no page for it. */
  readonly open?: () => void;
  readonly cancel: () => void;
  /** Takes a finished job from the list; absent if it stays. */
  readonly forget?: () => void;
  /** Address of the result as a file, of a job without a page. */
  readonly result?: string;
}

export class JobRow {
  readonly element: HTMLLIElement;
  private readonly words = h("strong", {});
  private readonly state = h("span", { class: "muted" });
  private readonly bar = h("progress", { max: 1 });
  private readonly found = h("p", { class: "muted" });
  private readonly open: HTMLButtonElement | null;
  private readonly cancel: HTMLButtonElement;
  private readonly forget: HTMLButtonElement | null;
  private readonly result: HTMLAnchorElement | null;

  constructor(actions: RowActions) {
    this.open = actions.open ? button("Open", actions.open) : null;
    this.cancel = button("Cancel", actions.cancel, { kind: "quiet" });
    this.forget = actions.forget ? button("Remove", actions.forget, { kind: "quiet" }) : null;
    this.result = actions.result === undefined ? null : h("a", { href: actions.result, download: "result.json" }, "Result as a file");
    this.element = h("li", { class: "job" }, h("div", { class: "job-head" }, this.words, this.state), this.bar, this.found,
      h("div", { class: "row" }, this.open, this.result, this.cancel, this.forget));
  }

  show(job: RowJob): void {
    const isRunning = isUnfinished(job);
    this.element.dataset.state = job.state;
    this.words.textContent = job.words;
    this.state.textContent = `${stateWords(job)}${job.isBackground && isRunning ? ", in the background" : ""}`;
    this.bar.hidden = !isRunning;
    this.bar.value = job.progress;
    this.bar.setAttribute("aria-label", `Progress: ${job.words}`);
    this.found.textContent = job.found;
    this.found.hidden = job.found === "";
    this.name(this.open, isRunning ? "Show" : "Open", job);
    this.name(this.cancel, "Cancel", job);
    this.name(this.forget, "Remove", job);
    this.cancel.hidden = !isRunning;
    if (this.open) this.open.hidden = job.state === "failed" || job.state === "removed";
    if (this.forget) this.forget.hidden = isRunning;
    if (this.result) this.result.hidden = job.state !== "successful";
  }

  /** Each button of the list says what it belongs to. */
  private name(element: HTMLButtonElement | null, verb: string, { words }: RowJob): void {
    if (!element) return;
    const label = element.querySelector("span");
    if (label) label.textContent = verb;
    element.setAttribute("aria-label", `${verb}: ${words}`);
  }
}
