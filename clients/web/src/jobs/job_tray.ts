// The tray of jobs in the header of every page: a button with the number of running ones, and below it their list. Results are kept there and
// opened on the page that they belong to.
import { announce } from "../base/announce";
import { button } from "../base/controls";
import { h } from "../base/dom";
import { menu } from "../base/menu";
import type { Connection } from "../contract/connection";
import { problemWords } from "../contract/refusals";
import type { Job } from "../contract/types";
import { JobRow, type RowActions, type RowJob } from "./job_row";
import { bestWords, endpointWords } from "./job_words";
import type { JobWatch } from "./job_watch";
import { isUnfinished, type KeptJob, type KeptJobs } from "./kept_jobs";

/** Limit of the listed jobs that were begun elsewhere. */
const MAX_OTHERS = 8;

/** A list whose rows stay in place while their jobs go on. */
class JobList {
  readonly element: HTMLUListElement;
  private readonly rows = new Map<string, JobRow>();

  /** `lostFocus`: called when the row that had the focus is taken away. */
  constructor(label: string, private readonly actionsOf: (id: string) => RowActions, private readonly lostFocus: () => void) {
    this.element = h("ul", { class: "jobs", "aria-label": label });
  }

  show(jobs: readonly RowJob[]): void {
    const ids = new Set(jobs.map(({ id }) => id));
    let hadFocus = false;
    for (const [id, row] of this.rows) {
      if (ids.has(id)) continue;
      hadFocus ||= row.element.contains(document.activeElement);
      row.element.remove();
      this.rows.delete(id);
    }
    const focused = document.activeElement;
    jobs.forEach((job, place) => {
      const row = this.rows.get(job.id) ?? new JobRow(this.actionsOf(job.id));
      this.rows.set(job.id, row);
      row.show(job);
      if (this.element.children[place] !== row.element) this.element.insertBefore(row.element, this.element.children[place] ?? null);
    });
    // A row that was moved has lost the focus.
    if (focused instanceof HTMLElement && focused !== document.activeElement && this.element.contains(focused)) focused.focus();
    this.element.hidden = jobs.length === 0;
    if (hadFocus) this.lostFocus();
  }
}

export class JobTray {
  readonly element: HTMLDetailsElement;
  private readonly notice = h("p", { class: "note", role: "status", hidden: true });
  private readonly empty = h("p", { class: "muted" }, "No jobs. What takes longer than a moment is listed here, and goes on when its page is left.");
  private readonly own: JobList;
  private readonly others: JobList;
  private readonly othersHead = h("h3", {}, "Begun elsewhere");
  private readonly clear: HTMLButtonElement;
  /** The jobs of the list that had not ended. */
  private running: ReadonlySet<string> = new Set();

  /** `open`: shows the result of a job on its page. `isShown`: whether the page of a job is the visible one, which tells its outcome itself. */
  constructor(
    private readonly jobs: KeptJobs,
    private readonly watch: JobWatch,
    connection: Connection,
    open: (job: KeptJob) => void,
    private readonly isShown: (job: KeptJob) => boolean,
  ) {
    const toSummary = (): void => this.element.querySelector("summary")?.focus();
    this.own = new JobList("Jobs", (id) => ({
      open: () => {
        const job = jobs.list.get().find((one) => one.id === id);
        if (!job) return;
        this.element.open = false;
        toSummary();
        open(job);
      },
      cancel: () => void watch.cancel(id),
      forget: () => jobs.forget(id),
    }), toSummary);
    this.others = new JobList("Jobs begun elsewhere", (id) => ({ cancel: () => void watch.cancel(id), result: `./v1/jobs/${id}/result` }), toSummary);
    this.clear = button("Remove all that have ended", () => jobs.forgetFinished(), { kind: "quiet" });
    this.element = menu("Jobs", "list",
      h("div", { class: "job-lists" }, h("h2", {}, "Jobs"), this.notice, this.empty, this.own.element, this.clear, this.othersHead, this.others.element));
    this.element.classList.add("job-tray");
    this.element.addEventListener("toggle", () => watch.setOpen(this.element.open));
    for (const part of [jobs.list, watch.others]) part.watch(() => this.show());
    let isLost = false;
    connection.lost.watch((lost) => {
      isLost = lost;
      this.tell(isLost);
    });
    watch.restarted.watch(() => this.tell(isLost));
    addEventListener("storage", () => jobs.readAgain());
  }

  private show(): void {
    const list = this.jobs.list.get();
    const running = list.filter(isUnfinished);
    this.own.show([...running, ...list.filter((job) => !isUnfinished(job))]);
    const others = this.watch.others.get().slice(0, MAX_OTHERS);
    this.others.show(others.map(rowOf));
    this.othersHead.hidden = others.length === 0;
    this.empty.hidden = list.length > 0;
    this.clear.hidden = list.length === running.length;
    this.count(running.length, list.length - running.length);
    this.announceEnds(list);
  }

  private count(running: number, ended: number): void {
    const summary = this.element.querySelector("summary");
    const label = summary?.querySelector("span");
    if (label) label.textContent = running > 0 ? `Jobs ${running}` : "Jobs";
    this.element.classList.toggle("is-running", running > 0);
    this.element.classList.toggle("is-empty", running + ended === 0);
    summary?.setAttribute("aria-label", running + ended === 0 ? "Jobs: none" : `Jobs: ${running} running, ${ended} ended`);
  }

  /** Says that a job has ended whose page is not in sight. */
  private announceEnds(list: readonly KeptJob[]): void {
    for (const job of list) {
      if (!this.running.has(job.id) || isUnfinished(job) || job.isBackground || this.isShown(job)) continue;
      announce(`${job.words}: ${job.state === "successful" ? "ready" : job.state === "failed" ? "failed" : "the server no longer has it"}.`);
    }
    this.running = new Set(list.filter(isUnfinished).map(({ id }) => id));
  }

  private tell(isLost: boolean): void {
    const restarted = this.watch.restarted.get();
    this.notice.textContent = isLost ? "The server does not answer. Jobs that it has begun go on there, and are found again."
      : restarted ?
      `The server was started again at ${restarted.toLocaleTimeString("en", { hour: "2-digit", minute: "2-digit", hour12: false })}. Jobs that had not ended begin again there.`
      : "";
    this.notice.hidden = this.notice.textContent === "";
  }
}

/** A job of the server's list. */
function rowOf(job: Job): RowJob {
  const { id, kind, state, progress, remaining_seconds: remaining, created, finished, priority } = job;
  const took = finished ? Math.max(0, (Date.parse(finished) - Date.parse(created)) / 1000) : null;
  return {
    id,
    words: endpointWords(`/v1/${kind}`),
    state,
    progress,
    remaining,
    took,
    found: job.error ? problemWords(job.error) : bestWords(job, ""),
    isBackground: priority === "background",
  };
}
