// Requests to the server. Every failure is one of two errors: Problem, which the server describes, or ConnectionLost.
import type { JobAccount } from "./jobs";
import { problemWords } from "./refusals";
import type { ProblemDocument } from "./types";

/** The server answered with application/problem+json. */
export class Problem extends Error {
  constructor(readonly document: ProblemDocument) {
    super(document.detail);
    this.name = "Problem";
  }

  get code(): string {
    return this.document.code;
  }
}

/** The server did not answer, or a proxy answered in its place. */
export class ConnectionLost extends Error {
  constructor() {
    super("The server does not answer.");
    this.name = "ConnectionLost";
  }
}

export function isAbort(error: unknown): boolean {
  return error instanceof DOMException && error.name === "AbortError";
}

/** Whether the server requires a key, or another one than was used. */
export function isUnauthorized(error: unknown): boolean {
  return error instanceof Problem && error.document.status === 401;
}

/** The status of a refusal; null for an error of another kind. */
export function statusOf(error: unknown): number | null {
  return error instanceof Problem ? error.document.status : null;
}

/** Whether a computation has ended since its job was cancelled, for example in the tray of jobs. */
export function isDismissed(error: unknown): boolean {
  return error instanceof Problem && error.code === "job.dismissed";
}

/** Whether the server did not answer or was too busy, so that the same request may succeed later. */
export function isBusy(error: unknown): boolean {
  return error instanceof ConnectionLost || [429, 503].includes(statusOf(error) ?? 0);
}

/** Called after each request with whether the server answered. */
export type ConnectionListener = (answered: boolean) => void;

export interface CallOptions {
  signal?: AbortSignal;
  headers?: Record<string, string>;
}

/** Codes of a server that is starting or shutting down. They count as a lost connection, so that the page waits. */
const NOT_SERVING: ReadonlySet<string> = new Set(["server.not_ready", "server.shutting_down"]);

async function problemOf(response: Response): Promise<Error> {
  const type = response.headers.get("Content-Type") ?? "";
  if (!type.startsWith("application/problem+json")) return new ConnectionLost(); // the answer of a proxy, not of the server
  const document = (await response.json()) as ProblemDocument;
  return NOT_SERVING.has(document.code) ? new ConnectionLost() : new Problem(document);
}

/** Whether the server answers and is neither starting nor shutting down. Any other problem counts as serving: later requests report it. */
export async function isServing(): Promise<boolean> {
  try {
    await new Client().send("GET", "/readyz");
    return true;
  } catch (error) {
    return error instanceof Problem;
  }
}

export class Client {
  constructor(
    private readonly base = "",
    private readonly listener: ConnectionListener = () => {},
    /** Resolves when the user has signed in. A request that was refused with 401 is then sent again. */
    private readonly signIn?: () => Promise<void>,
    /** Called with each answer of a computation, its path and its request. */
    readonly onAnswer: (path: string, answer: unknown, request: unknown) => void = () => {},
    /** Keeps account of the jobs of its page. */
    readonly jobs: JobAccount | null = null,
  ) {}

  /** The response to a request that succeeded. Throws Problem or ConnectionLost otherwise. */
  async send(method: string, path: string, body?: BodyInit, options: CallOptions = {}): Promise<Response> {
    try {
      return await this.sendOnce(method, path, body, options);
    } catch (error) {
      if (!this.signIn || !isUnauthorized(error)) throw error;
      await this.signIn();
      return this.sendOnce(method, path, body, options);
    }
  }

  private async sendOnce(method: string, path: string, body: BodyInit | undefined, options: CallOptions): Promise<Response> {
    let response: Response;
    try {
      response = await fetch(this.base + path, { method, body, signal: options.signal, headers: options.headers });
    } catch (error) {
      if (isAbort(error)) throw error;
      this.listener(false);
      throw new ConnectionLost();
    }
    if (response.ok) {
      this.listener(true);
      return response;
    }
    const problem = await problemOf(response);
    this.listener(problem instanceof Problem);
    throw problem;
  }

  async get<Answer>(path: string, options: CallOptions = {}): Promise<Answer> {
    return readJson<Answer>(await this.send("GET", path, undefined, options));
  }

  /** The answer of a computation that is no job. */
  async post<Answer>(path: string, document: unknown, options: CallOptions = {}): Promise<Answer> {
    const answer = await readJson<Answer>(await this.postResponse(path, document, options));
    this.onAnswer(path, answer, document);
    return answer;
  }

  async postResponse(path: string, document: unknown, options: CallOptions = {}): Promise<Response> {
    const headers = { "Content-Type": "application/json", ...options.headers };
    return this.send("POST", path, JSON.stringify(document), { ...options, headers });
  }

  /** The same client, whose answers are not reported: for what a page asks without being told to. */
  unreported(): Client {
    return new Client(this.base, this.listener, this.signIn, undefined, this.jobs);
  }

  url(path: string): string {
    return this.base + path;
  }
}

/** The body as JSON. Throws ConnectionLost if the connection breaks while it is read. */
export async function readJson<Answer>(response: Response): Promise<Answer> {
  try {
    return (await response.json()) as Answer;
  } catch (error) {
    if (isAbort(error)) throw error;
    throw new ConnectionLost();
  }
}

/** An error as sentences for the user: the place at fault in words, the fault, and a hint if there is one. */
export function explain(error: unknown): string {
  if (error instanceof Problem) return problemWords(error.document);
  return error instanceof Error ? error.message : String(error);
}
