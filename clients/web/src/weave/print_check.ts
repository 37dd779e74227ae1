// Whether the sheet of the present weave can be printed, which the server is asked in the background once the weave rests.
import { debounce } from "../base/debounce";
import { Observable } from "../base/observable";
import { type Client, Problem } from "../contract/client";
import { JobRunner } from "../contract/runner";
import { faultsIn } from "../contract/refusals";
import type { ProblemDocument, WeaveToolpath } from "../contract/types";
import { type PrintSettings, toolpathRequest } from "./printer";
import type { WeaveSession } from "./session";
import { layOutSheet } from "./sheet_layout";

/** Time without a change after which the server is asked. */
const PAUSE_MS = 1000;
/** Time in seconds after which the check becomes a job. */
const IMMEDIATE_SECONDS = 2;

/** Why a sheet cannot be printed, for the card: the first fault, and how many there are. */
export function unprintableWords(document: Pick<ProblemDocument, "detail" | "errors">): string {
  const faults = faultsIn(document);
  const first = faults[0]?.sentence ?? document.detail;
  const others = faults.length > 1 ? ` So it is at ${faults.length - 1} more ${faults.length === 2 ? "place" : "places"}.` : "";
  return `This sheet does not print as it is. ${/[.!?)]$/.test(first) ? first : `${first}.`}${others} Print shows where, and offers repairs.`;
}

export class PrintCheck {
  /** Why the sheet cannot be printed; empty if it can, or if that is not known. */
  readonly words = new Observable("");
  private readonly runner: JobRunner;
  private readonly later = debounce(() => this.ask(), PAUSE_MS);

  constructor(
    private readonly session: WeaveSession,
    private readonly settings: Observable<PrintSettings>,
    client: Client,
  ) {
    this.runner = new JobRunner(client);
    for (const part of [session.laidOut, session.state, settings]) {
      part.watch(() => {
        this.runner.cancel();
        this.words.set("");
        if (session.laidOut.get()) this.later.schedule();
      });
    }
  }

  /** Drops the check, for a page that is left. */
  end(): void {
    this.later.cancel();
    this.runner.cancel();
  }

  private ask(): void {
    void this.runner.start(
      async (run) => {
        const { weave } = await layOutSheet(run, this.session.state.get());
        const request = { ...toolpathRequest(weave, this.settings.get(), []), priority: "background" };
        await run.job<WeaveToolpath>("/v1/weave-toolpaths", request, { wait: IMMEDIATE_SECONDS });
      },
      (error) => {
        // What else fails is told where the user asks for it.
        if (error instanceof Problem && error.code === "weave.not_printable") this.words.set(unprintableWords(error.document));
      },
    );
  }
}
