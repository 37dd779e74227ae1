// What a job is, how far it is and what it has found, in words.
import { digits, percent, seconds } from "../base/format";
import type { Job } from "../contract/types";
import { TASK_WORDS } from "../design/state";

/** What an endpoint computes. */
export const ENDPOINT_WORDS: Readonly<Record<string, string>> = {
  "/v1/designs": "Search for a design",
  "/v1/profiles": "Profile of a design",
  "/v1/simulations": "Simulation of the structure",
  "/v1/parts": "Part to make",
  "/v1/family-checks": "Check of the family",
  "/v1/family-atlases": "Atlas",
  "/v1/training-plans": "Estimate of a training",
  "/v1/trainings": "Training of a network",
  "/v1/part-simulations": "Test of the part",
  "/v1/weave-layouts": "Layout of the weave",
  "/v1/weave-homogenizations": "Stiffness of the cell",
  "/v1/weave-simulations": "Sheet under load",
  "/v1/weave-toolpaths": "Path of the printer",
  "/v1/geodesics": "Shortest paths",
  "/v1/geodesic-fields": "Distance field",
  "/v1/karcher-means": "Mean of the points",
  "/v1/networks": "Network on the surface",
  "/v1/embedded-systems": "Relaxation",
  "/v1/voronoi-diagrams": "Voronoi diagram",
  "/v1/voronoi-optimizations": "Optimization of the sites",
};

export function endpointWords(path: string): string {
  const words = path.replace("/v1/", "").replace(/-/g, " ");
  return ENDPOINT_WORDS[path] ?? words.charAt(0).toUpperCase() + words.slice(1);
}

/** The fields of requests that tell what is computed. */
interface Request {
  readonly task?: string;
  readonly family?: string;
  readonly verify?: boolean;
  readonly regions?: readonly unknown[];
  readonly effects?: { readonly polish?: string; readonly ways_out?: string };
  readonly springs?: readonly { readonly weight?: number }[];
  readonly triangles?: readonly unknown[];
  readonly definition?: { readonly id?: string };
}

/** Work on a family, whose name is told with it. */
const FAMILY_WORK: ReadonlySet<string> = new Set(["/v1/family-atlases", "/v1/training-plans", "/v1/trainings"]);

/** What a request computes, as in "Verification: stress over strain of IH29". */
export function workWords(path: string, document: unknown): string {
  const request = (document ?? {}) as Request;
  if (FAMILY_WORK.has(path)) {
    const name = request.family ?? request.definition?.id;
    return name === undefined ? endpointWords(path) : `${endpointWords(path)}: ${name}`;
  }
  if (path !== "/v1/designs") return endpointWords(path);
  if (request.regions) return `Designs of ${request.regions.length} regions`;
  const { effects = {}, verify, task, family } = request;
  const work = effects.polish === "on" ? "Polish by simulation"
    : verify ? "Verification by simulation" : effects.ways_out === "on" ? "Ways out of a missed target" : "Search for a design";
  const title = task && task in TASK_WORDS ? TASK_WORDS[task as keyof typeof TASK_WORDS].title : "";
  if (title === "") return work;
  const subject = title.charAt(0).toLowerCase() + title.slice(1);
  return `${work}: ${subject}${family && family !== "any" ? ` of ${family}` : ""}`;
}

/** The best that a running job has found so far. `before`: the words about its earlier results. */
export function bestWords({ partial }: Pick<Job, "partial">, before: string): string {
  if (!partial) return before;
  if ("errors" in partial) {
    const last = partial.errors.at(-1);
    return last ? `Best so far: a mean error of ${percent(last.error)}, with ${last.designs.toLocaleString("en")} designs` : before;
  }
  if ("round" in partial) {
    const { accepted, target_error: error } = partial.round;
    return accepted && error !== null ? `Best so far: ${percent(error)} from the target, simulated` : before;
  }
  if ("achieved" in partial) return `Best so far: ${partial.family}, ${percent(partial.error.relative_rms)} from the target by the model`;
  if ("state" in partial) return `State ${partial.number} of ${partial.states}, strain up to ${percent(partial.state.largest_strain)}`;
  return `Iteration ${partial.iteration}, energy ${digits(partial.energy, 4)}`;
}

/** What an answer says of its result: the sentence of its verdict; the words about the best so far where it has none. */
export function outcomeWords(answer: unknown, before: string): string {
  const sentence = (answer as { verdict?: { sentence?: unknown } } | null)?.verdict?.sentence;
  return typeof sentence === "string" ? sentence : before.replace(/^Best so far: /, "Best: ");
}

/** How far a job is, as in "40 %, about 12 s left". `took`: how long a finished one has run, in seconds. */
export function stateWords(
  { state, progress, remaining, took }: { readonly state: Job["state"] | "removed"; readonly progress: number; readonly remaining: number | null; readonly took: number | null },
): string {
  switch (state) {
    case "accepted":
      return "Waiting";
    case "running":
      return `${Math.floor(100 * progress)} %${remaining === null ? "" : `, about ${seconds(Math.max(1, Math.round(remaining)))} left`}`;
    case "successful":
      return took === null ? "Ready" : `Ready after ${seconds(took)}`;
    case "failed":
      return "Failed";
    case "dismissed":
      return "Cancelled";
    case "removed":
      return "The server no longer has it";
  }
}
