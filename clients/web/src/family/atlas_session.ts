// The atlas of the present family: requested as a job, with the atlases of the families that it is compared with.
import { Observable } from "../base/observable";
import { type Client, ConnectionLost } from "../contract/client";
import { type Activity, JobRunner, type WorkInWords } from "../contract/runner";
import type { FamilyAtlas, FamilyAtlasRequest, FamilyDefinition } from "../contract/types";
import { definitionKey } from "./definition_key";
import type { FamilySession } from "./session";

export interface ShownAtlas {
  readonly definition: FamilyDefinition;
  readonly atlas: FamilyAtlas;
}

export class AtlasSession {
  readonly shown = new Observable<ShownAtlas | null>(null);
  /** Atlases of the families that the shown one is compared with, as far as they have arrived. */
  readonly others = new Observable<readonly FamilyAtlas[]>([]);
  /** Index of the chosen sample; null for none. */
  readonly chosen = new Observable<number | null>(null);
  readonly activity: Observable<Activity<WorkInWords>>;
  private readonly runner: JobRunner;
  private readonly known = new Map<string, FamilyAtlas>();

  constructor(private readonly session: FamilySession, private readonly client: Client) {
    this.runner = new JobRunner(client);
    this.activity = this.runner.activity;
  }

  /** Whether the shown atlas is that of the present definition. */
  get isCurrent(): boolean {
    const shown = this.shown.get();
    return shown !== null && definitionKey(shown.definition) === definitionKey(this.session.state.get().definition);
  }

  /** Requests the atlas. What the server keeps of its own families and of added ones comes at once. */
  make(): Promise<void> {
    const { definition } = this.session.state.get();
    const request: FamilyAtlasRequest = this.session.isStored ? { family: definition.id } : { definition };
    return this.runner.begin({ words: "Making the atlas" }, async (run) => {
      const atlas = await run.job<FamilyAtlas>("/v1/family-atlases", request, {
        onJob: ({ stage, progress }) => run.tell({ words: stage ? `Making the atlas: ${stage}` : "Making the atlas" }, progress),
      });
      this.chosen.set(null);
      this.shown.set({ definition, atlas });
      this.others.set([]);
      await this.loadOthers(atlas);
    });
  }

  cancel(): void {
    this.runner.cancel();
  }

  /** Repeats what a lost connection has ended. */
  retry(): void {
    const activity = this.activity.get();
    if (activity.kind === "failed" && activity.error instanceof ConnectionLost) void this.make();
  }

  /** Chooses a sample, whose tiling is drawn if the atlas is that of the present definition. */
  choose(index: number | null): void {
    this.chosen.set(index);
    const sample = index === null ? undefined : this.shown.get()?.atlas.samples[index];
    if (sample && this.isCurrent && this.session.state.get().shown.length === sample.parameters.length) this.session.apply({ shown: sample.parameters });
  }

  /** The atlases of other families are drawn behind the shown one. The server has them already, and without them the plots only show less. */
  private async loadOthers({ comparison }: FamilyAtlas): Promise<void> {
    for (const family of comparison?.families ?? []) {
      const atlas = this.known.get(family) ?? (await this.client.unreported().get<FamilyAtlas>(`/v1/families/${family}/atlas`).catch(() => null));
      if (!atlas) continue;
      this.known.set(family, atlas);
      if (this.shown.get()?.atlas.comparison === comparison) this.others.set([...this.others.get(), atlas]);
    }
  }
}
