// Computations that run as jobs. They are followed by server-sent events, or by polling: those in the background, those of a hidden page, and
// those for which there is no event stream.
import { type Client, ConnectionLost, Problem, isAbort, readJson } from "./client";
import type { Job } from "./types";

const POLL_MS = 400;
/** Time between two questions after a job that nobody waits for. */
const BACKGROUND_POLL_MS = 1000;
/** Limit of the event streams of a page. A browser has six connections to a host for all of its tabs, and other requests need them. */
const MAX_STREAMS = 2;
const UNFINISHED = new Set(["accepted", "running"]);

let streamCount = 0;

/** Keeps account of the jobs that requests of a page have become. */
export interface JobAccount {
  /** The id of a job that computes this request already, or has its result; null if there is none. */
  known(path: string, request: unknown): string | null;
  /** A job is followed from now on. */
  begin(job: Pick<Job, "id"> & Partial<Job>, path: string, request: unknown): void;
  /** What the server says of a job. */
  tell(job: Job): void;
  /** A job is no longer followed. `answer`: its result, undefined without one. */
  end(id: string, answer: unknown): void;
  /** A job was dismissed. */
  drop(id: string): void;
  /** Whether the user has cancelled a job elsewhere than on its page. */
  wasCancelled(id: string): boolean;
  /** The link under which the result of a job is shown has changed. */
  place(id: string, link: string): void;
}

export interface JobOptions {
  signal: AbortSignal;
  onProgress?: (job: Job) => void;
  /** Seconds that the server may take for an immediate answer. Without it, the computation is a job from the start. */
  wait?: number;
  /** Whether nobody waits for the job; by default if its request has the priority `background`. */
  isBackground?: () => boolean;
}

/** The answer of a computation of any duration. Aborting the signal dismisses the job. */
export async function runJob<Answer>(client: Client, path: string, document: unknown, options: JobOptions): Promise<Answer> {
  const id = client.jobs?.known(path, document) ?? null;
  const known = id === null ? null : await followable(client, id, options.signal);
  if (known) return followJob(client, known, path, document, options);
  const prefer = options.wait === undefined ? "respond-async" : `wait=${options.wait}`;
  const response = await client.postResponse(path, document, { headers: { Prefer: prefer }, signal: options.signal });
  if (response.status !== 202) {
    const answer = await readJson<Answer>(response);
    client.onAnswer(path, answer, document);
    return answer;
  }
  return followJob(client, await readJson<Job>(response), path, document, options);
}

/** A job that has not ended without a result and that the server still has; null if there is none. */
async function followable(client: Client, id: string, signal: AbortSignal): Promise<Job | null> {
  try {
    const job = await client.get<Job>(`/v1/jobs/${id}`, { signal });
    return UNFINISHED.has(job.state) || job.state === "successful" ? job : null;
  } catch (error) {
    if (error instanceof Problem) return null; // it was removed meanwhile
    throw error;
  }
}

/** The answer of a job that was started before, for example by a page that was left. `path`, `document`: of the request that started it. */
export async function followJob<Answer>(client: Client, job: Pick<Job, "id"> & Partial<Job>, path: string, document: unknown, options: JobOptions): Promise<Answer> {
  const { jobs } = client;
  jobs?.begin(job, path, document);
  const tell = (state: Job): void => {
    jobs?.tell(state);
    options.onProgress?.(state);
  };
  if (job.state) options.onProgress?.(job as Job);
  let answer: Answer | undefined;
  const dismiss = () => {
    jobs?.drop(job.id);
    client.send("DELETE", `/v1/jobs/${job.id}`).catch(() => {}); // the job has ended, or the server is gone: nothing is left to do
  };
  if (options.signal.aborted) dismiss();
  options.signal.addEventListener("abort", dismiss);
  try {
    const isBackground = options.isBackground ?? (() => (document as { priority?: string } | null)?.priority === "background");
    await waitForEnd(client, job, { ...options, onProgress: tell, isBackground });
    answer = await client.get<Answer>(`/v1/jobs/${job.id}/result`, { signal: options.signal });
    client.onAnswer(path, answer, document);
    return answer;
  } finally {
    jobs?.end(job.id, answer);
    options.signal.removeEventListener("abort", dismiss);
  }
}

async function waitForEnd(client: Client, job: Pick<Job, "id">, options: JobOptions): Promise<void> {
  const isHidden = typeof document !== "undefined" && document.hidden;
  if (!options.isBackground?.() && !isHidden && streamCount < MAX_STREAMS) {
    ++streamCount;
    try {
      if (await followEvents(client, job, options)) return;
    } catch (error) {
      if (isAbort(error) || (error instanceof Problem && ![429, 503].includes(error.document.status))) throw error;
      if (error instanceof ConnectionLost) throw error;
    } finally {
      --streamCount;
    }
  }
  await poll(client, job, options);
}

/** True when the event `finished` has arrived, false if the stream ended without it. */
async function followEvents(client: Client, job: Pick<Job, "id">, options: JobOptions): Promise<boolean> {
  const response = await client.send("GET", `/v1/jobs/${job.id}/events`, undefined, { signal: options.signal });
  const events = new EventReader();
  const reader = response.body?.pipeThrough(new TextDecoderStream()).getReader();
  if (!reader) return false;
  for (;;) {
    const { value, done } = await reader.read();
    if (done) return false;
    for (const event of events.read(value)) {
      options.onProgress?.(JSON.parse(event.data) as Job);
      if (event.name === "finished") {
        void reader.cancel();
        return true;
      }
    }
  }
}

async function poll(client: Client, job: Pick<Job, "id">, options: JobOptions): Promise<void> {
  for (;;) {
    const current = await client.get<Job>(`/v1/jobs/${job.id}`, { signal: options.signal });
    options.onProgress?.(current);
    if (!UNFINISHED.has(current.state)) return;
    await pause(options.isBackground?.() ? BACKGROUND_POLL_MS : POLL_MS, options.signal);
  }
}

/** Waits, but no longer than until the signal is aborted: the next request then throws. */
function pause(milliseconds: number, signal: AbortSignal): Promise<void> {
  return new Promise((resolve) => {
    const end = (): void => {
      clearTimeout(timer);
      signal.removeEventListener("abort", end);
      resolve();
    };
    const timer = setTimeout(end, milliseconds);
    signal.addEventListener("abort", end);
  });
}

export interface ServerEvent {
  name: string;
  data: string;
}

/** Parses a stream of server-sent events from chunks that may end anywhere. */
export class EventReader {
  private buffer = "";

  read(chunk: string): ServerEvent[] {
    this.buffer += chunk;
    const blocks = this.buffer.split(/\r?\n\r?\n/);
    this.buffer = blocks.pop() ?? "";
    return blocks.map(parseEvent).filter((event) => event.data !== "");
  }
}

function parseEvent(block: string): ServerEvent {
  const event = { name: "message", data: "" };
  for (const line of block.split(/\r?\n/)) {
    const colon = line.indexOf(":");
    if (colon <= 0) continue; // a comment
    const field = line.slice(0, colon);
    const value = line.slice(colon + 1).replace(/^ /, "");
    if (field === "event") event.name = value;
    if (field === "data") event.data += (event.data && "\n") + value;
  }
  return event;
}
