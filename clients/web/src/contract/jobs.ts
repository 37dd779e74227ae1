// Computations that run as jobs. They are followed by server-sent events, or by polling if the server offers no more event streams.
import { type Client, ConnectionLost, Problem, isAbort, readJson } from "./client";
import type { Job } from "./types";

const POLL_MS = 400;
const UNFINISHED = new Set(["accepted", "running"]);

export interface JobOptions {
  signal: AbortSignal;
  onProgress?: (job: Job) => void;
  /** Seconds that the server may take for an immediate answer. Without it, the computation is a job from the start. */
  wait?: number;
}

/** The answer of a computation of any duration. Aborting the signal dismisses the job. */
export async function runJob<Answer>(client: Client, path: string, document: unknown, options: JobOptions): Promise<Answer> {
  const prefer = options.wait === undefined ? "respond-async" : `wait=${options.wait}`;
  const response = await client.postResponse(path, document, { headers: { Prefer: prefer }, signal: options.signal });
  if (response.status !== 202) {
    const answer = await readJson<Answer>(response);
    client.onAnswer(path, answer, document);
    return answer;
  }
  return followJob(client, await readJson<Job>(response), path, document, options);
}

/** The answer of a job that was started before, for example by a page that was left. `path`, `document`: of the request that started it. */
export async function followJob<Answer>(client: Client, job: Pick<Job, "id"> & Partial<Job>, path: string, document: unknown, options: JobOptions): Promise<Answer> {
  if (job.state) options.onProgress?.(job as Job);
  const dismiss = () => {
    client.send("DELETE", `/v1/jobs/${job.id}`).catch(() => {}); // the job has ended, or the server is gone: nothing is left to do
  };
  if (options.signal.aborted) dismiss();
  options.signal.addEventListener("abort", dismiss);
  try {
    await waitForEnd(client, job, options);
    const answer = await client.get<Answer>(`/v1/jobs/${job.id}/result`, { signal: options.signal });
    client.onAnswer(path, answer, document);
    return answer;
  } finally {
    options.signal.removeEventListener("abort", dismiss);
  }
}

async function waitForEnd(client: Client, job: Pick<Job, "id">, options: JobOptions): Promise<void> {
  try {
    if (await followEvents(client, job, options)) return;
  } catch (error) {
    if (isAbort(error) || (error instanceof Problem && ![429, 503].includes(error.document.status))) throw error;
    if (error instanceof ConnectionLost) throw error;
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
    await new Promise((resolve) => setTimeout(resolve, POLL_MS));
  }
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
