// The jobs of this browser: what each computes, how far it is, and on which page its result is shown. They are kept in the browser's storage, so
// that a reload loses none, and a request that one of them computes already is not computed again.
import { Observable } from "../base/observable";
import { textKey } from "../base/text_key";
import { problemWords } from "../contract/refusals";
import type { JobAccount } from "../contract/jobs";
import type { Job } from "../contract/types";
import { bestWords, outcomeWords, workWords } from "./job_words";

const KEY = "supple-jobs";
/** Limit of the finished jobs that are listed. */
const MAX_FINISHED = 12;
/** Ids of this browser's jobs that are remembered, listed or not. */
const MAX_IDS = 200;
/** Finished jobs that have taken less time, in seconds, are not kept if a page has followed them. */
const MIN_KEPT_SECONDS = 2;
/** Time between two writings of progress to the storage. */
const WRITING_MS = 2000;
/** Fields of requests on which the result does not depend. */
const WITHOUT_EFFECT = ["session", "priority", "deadline"];

/** A page with the text of its link. */
export interface PagePlace {
  readonly page: string;
  readonly link: string;
}

export interface KeptJob extends PagePlace {
  readonly id: string;
  /** Path of the request. */
  readonly path: string;
  /** Key of the request. */
  readonly key: string;
  /** The tab of the browser that has begun or followed it last. */
  readonly tab: string;
  readonly words: string;
  readonly isBackground: boolean;
  /** `removed`: the server no longer has it. */
  readonly state: Job["state"] | "removed";
  readonly progress: number;
  /** Estimated seconds until it ends; null if they are not known. */
  readonly remaining: number | null;
  /** Seconds that a finished job has taken; null while it has not ended. */
  readonly took: number | null;
  /** The best so far, the outcome, or why it has failed. */
  readonly found: string;
}

interface Stored {
  readonly jobs: readonly KeptJob[];
  readonly ids: readonly string[];
  /** When the server has started, in milliseconds; null if that is not known. */
  readonly serverStart: number | null;
}

export function isUnfinished({ state }: Pick<KeptJob, "state">): boolean {
  return state === "accepted" || state === "running";
}

export class KeptJobs {
  /** The newest first. */
  readonly list: Observable<readonly KeptJob[]>;
  /** When the server has started, in milliseconds; null before it was asked. */
  serverStart: number | null;
  private ids: readonly string[];
  /** Jobs that a page of this tab follows now. */
  private readonly followed = new Set<string>();
  /** Jobs that were taken from the list, so that what another tab has stored does not bring them back. */
  private readonly forgotten = new Set<string>();
  /** Jobs that the user has cancelled in the tray. */
  private readonly cancelled = new Set<string>();
  /** The finished job whose result the next equal request gets. */
  private wanted = "";
  private lastWriting = 0;

  /** `tab`: a name of the tab, which stays after a reload. */
  constructor(private readonly tab: string = tabName()) {
    const { jobs, ids, serverStart } = read();
    this.list = new Observable(jobs);
    this.ids = ids;
    this.serverStart = serverStart;
  }

  /** The account of the jobs of one page. `place`: the page as it is now. */
  of(place: () => PagePlace): JobAccount {
    return {
      known: (path, request) => this.known(path, request),
      begin: (job, path, request) => this.begin(job, path, request, place()),
      tell: (job) => this.tell(job),
      end: (id, answer) => this.end(id, answer),
      drop: (id) => this.forget(id),
      wasCancelled: (id) => this.cancelled.has(id),
      place: (id, link) => this.change(id, (job) => ({ ...job, link })),
    };
  }

  /** Whether this browser has begun a job, also one that is not listed. */
  isOwn(id: string): boolean {
    return this.ids.includes(id);
  }

  isFollowed(id: string): boolean {
    return this.followed.has(id);
  }

  /** The next request that equals that of this job gets its result. */
  want(id: string): void {
    this.wanted = id;
  }

  /** What the server says of a job. */
  tell(job: Job): void {
    const before = this.list.get().find(({ id }) => id === job.id);
    if (!before) return;
    const { state, progress, remaining_seconds: remaining, error, created, finished } = job;
    if (state === "dismissed" || error?.code === "design.superseded") return this.forget(job.id);
    const took = finished ? Math.max(0, (Date.parse(finished) - Date.parse(created)) / 1000) : null;
    // The page that follows a short job shows its result at once.
    if (state === "successful" && took !== null && took < MIN_KEPT_SECONDS && this.followed.has(job.id)) return this.forget(job.id);
    const found = error ? problemWords(error) : state === "successful" ? outcomeWords(null, before.found) : bestWords(job, before.found);
    this.change(job.id, (kept) => ({ ...kept, state, progress, remaining, took, found }), state !== before.state);
  }

  /** The server no longer has a job. */
  tellRemoved(id: string): void {
    this.change(id, (job) => ({ ...job, state: "removed", remaining: null }));
  }

  /** Takes a job from the list. */
  forget(id: string): void {
    this.forgotten.add(id);
    this.followed.delete(id);
    this.set(this.list.get().filter((job) => job.id !== id));
  }

  /** The user cancels a job. */
  cancel(id: string): void {
    this.cancelled.add(id);
    this.forget(id);
  }

  /** Takes all that have ended from the list. */
  forgetFinished(): void {
    for (const job of this.list.get()) if (!isUnfinished(job)) this.forget(job.id);
  }

  setServerStart(start: number): void {
    this.serverStart = start;
    this.write();
  }

  /** Takes over what another tab has stored. What this tab follows itself stays. */
  readAgain(): void {
    const own = this.list.get().filter(({ id }) => this.followed.has(id));
    const others = read().jobs.filter(({ id }) => !this.followed.has(id) && !this.forgotten.has(id));
    this.list.set([...own, ...others]);
  }

  /** The job that computes a request, or has computed it and is wanted; null if there is none. Jobs of other tabs count only if they are wanted. */
  private known(path: string, request: unknown): string | null {
    const candidates = this.list.get().filter((job) => job.path === path && !this.followed.has(job.id) && (job.id === this.wanted || (job.tab === this.tab && isUnfinished(job))));
    if (candidates.length === 0) return null;
    const key = textKey(request, WITHOUT_EFFECT);
    return candidates.find((job) => job.key === key)?.id ?? null;
  }

  private begin({ id, ...job }: Pick<Job, "id"> & Partial<Job>, path: string, request: unknown, place: PagePlace): void {
    this.followed.add(id);
    this.forgotten.delete(id);
    if (id === this.wanted) this.wanted = "";
    if (this.list.get().some((kept) => kept.id === id)) return this.change(id, (kept) => ({ ...kept, tab: this.tab }));
    const isBackground = (job.priority ?? (request as { priority?: string } | null)?.priority) === "background";
    const { state = "accepted", progress = 0, remaining_seconds: remaining = null } = job;
    const kept: KeptJob = {
      id,
      path,
      key: textKey(request, WITHOUT_EFFECT),
      tab: this.tab,
      words: workWords(path, request),
      isBackground,
      state,
      progress,
      remaining,
      took: null,
      found: "",
      ...place,
    };
    this.ids = [id, ...this.ids.filter((other) => other !== id)].slice(0, MAX_IDS);
    this.set([kept, ...this.list.get()]);
  }

  /** A page no longer follows a job. `answer`: its result, if the page has received it. */
  private end(id: string, answer: unknown): void {
    this.followed.delete(id);
    if (answer !== undefined) this.change(id, (job) => ({ ...job, state: "successful", progress: 1, remaining: null, found: outcomeWords(answer, job.found) }));
  }

  private change(id: string, changed: (job: KeptJob) => KeptJob, isUrgent = true): void {
    if (!this.list.get().some((job) => job.id === id)) return;
    this.set(this.list.get().map((job) => (job.id === id ? changed(job) : job)), isUrgent);
  }

  private set(jobs: readonly KeptJob[], isUrgent = true): void {
    const finished = jobs.filter((job) => !isUnfinished(job));
    const tooMany = new Set(finished.slice(MAX_FINISHED));
    this.list.set(jobs.filter((job) => !tooMany.has(job)));
    if (isUrgent || Date.now() - this.lastWriting > WRITING_MS) this.write();
  }

  /** Stores the list, with what other tabs have stored meanwhile. */
  private write(): void {
    this.lastWriting = Date.now();
    const jobs = this.list.get();
    const listed = new Set(jobs.map(({ id }) => id));
    const others = read().jobs.filter((job) => !listed.has(job.id) && !this.forgotten.has(job.id) && isUnfinished(job));
    try {
      localStorage.setItem(KEY, JSON.stringify({ jobs: [...jobs, ...others], ids: this.ids, serverStart: this.serverStart } satisfies Stored));
    } catch {
      // storage is blocked or full: the list lasts as long as the page
    }
  }
}

/** A name of this tab, which stays after a reload. */
function tabName(): string {
  const fresh = crypto.getRandomValues(new Uint32Array(2)).join("-");
  try {
    const name = sessionStorage.getItem(KEY) ?? fresh;
    sessionStorage.setItem(KEY, name);
    return name;
  } catch {
    return fresh; // storage is blocked: a reload is another tab
  }
}

/** What is in the browser's storage. It may be of another version, so that jobs of another shape are left out. */
function read(): Stored {
  try {
    const { jobs, ids, serverStart } = JSON.parse(localStorage.getItem(KEY) ?? "{}") as Partial<Stored>;
    return { jobs: (jobs ?? []).filter(isJob), ids: (ids ?? []).filter((id) => typeof id === "string"), serverStart: typeof serverStart === "number" ? serverStart : null };
  } catch {
    return { jobs: [], ids: [], serverStart: null };
  }
}

function isJob({ id, path, page, link, words, found, state, progress }: KeptJob): boolean {
  return /^[\w-]+$/.test(id) && [path, page, link, words, found, state].every((text) => typeof text === "string") && Number.isFinite(progress);
}
