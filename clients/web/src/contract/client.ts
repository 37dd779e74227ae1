// Requests to the server. Every failure is one of two errors: a problem that the server describes, or no connection.
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

/** The server did not answer, or something between here and there did. */
export class ConnectionLost extends Error {
  constructor() {
    super("The server does not answer.");
    this.name = "ConnectionLost";
  }
}

export function isAbort(error: unknown): boolean {
  return error instanceof DOMException && error.name === "AbortError";
}

/** Whether the server asks for a key, or for another one. */
export function isUnauthorized(error: unknown): boolean {
  return error instanceof Problem && error.document.status === 401;
}

/** Hears whether each request got an answer. */
export type ConnectionListener = (answered: boolean) => void;

export interface CallOptions {
  signal?: AbortSignal;
  headers?: Record<string, string>;
}

/** Codes of a server that is there but does not serve yet, or no more: it will, and is waited for as one that is not there. */
const NOT_SERVING: ReadonlySet<string> = new Set(["server.not_ready", "server.shutting_down"]);

async function problemOf(response: Response): Promise<Error> {
  const type = response.headers.get("Content-Type") ?? "";
  if (!type.startsWith("application/problem+json")) return new ConnectionLost(); // a proxy's words, not the server's
  const document = (await response.json()) as ProblemDocument;
  return NOT_SERVING.has(document.code) ? new ConnectionLost() : new Problem(document);
}

/** Whether there is a server and it has begun to serve. What else troubles it, it says itself to whoever asks for more. */
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
    /** Resolves once somebody has signed in; a request that the server asked a key for is then sent again. */
    private readonly signIn?: () => Promise<void>,
    /** Hears each answer of a computation, the path that it was asked at and the request. */
    readonly hear: (path: string, answer: unknown, request: unknown) => void = () => {},
  ) {}

  /** The response to a request, once it is one that the server meant as a success. */
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

  /** The answer of an immediate computation. */
  async post<Answer>(path: string, document: unknown, options: CallOptions = {}): Promise<Answer> {
    const answer = await readJson<Answer>(await this.postResponse(path, document, options));
    this.hear(path, answer, document);
    return answer;
  }

  async postResponse(path: string, document: unknown, options: CallOptions = {}): Promise<Response> {
    const headers = { "Content-Type": "application/json", ...options.headers };
    return this.send("POST", path, JSON.stringify(document), { ...options, headers });
  }

  url(path: string): string {
    return this.base + path;
  }
}

/** The body as JSON; a connection that breaks off within it is a lost one. */
export async function readJson<Answer>(response: Response): Promise<Answer> {
  try {
    return (await response.json()) as Answer;
  } catch (error) {
    if (isAbort(error)) throw error;
    throw new ConnectionLost();
  }
}

/** An error as sentences for a person: the field at fault, what is wrong there, what may help. */
export function explain(error: unknown): string {
  if (error instanceof Problem) {
    const { detail, errors, hint } = error.document;
    const pointer = errors?.[0]?.pointer ?? "";
    const sentence = pointer.length > 1 && !detail.includes(pointer) ? `${pointer}: ${detail}` : detail;
    if (!hint || detail.includes(hint)) return sentence;
    return `${sentence}${/[.!?)]$/.test(sentence) ? "" : "."} ${hint}`;
  }
  return error instanceof Error ? error.message : String(error);
}

/** The same of a file that was sent as text: that the fault lies in the text needs no saying. */
export function explainFile(error: unknown): string {
  return explain(error).replace(/^\/text: /, "");
}
