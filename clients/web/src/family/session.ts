// The family session: the state, its changes, what the server has, and its check of the definition. It does not depend on elements of the page.
import { debounce } from "../base/debounce";
import { EditedState } from "../base/edited_state";
import { Observable } from "../base/observable";
import { Redraws } from "../base/redraws";
import { type Client, ConnectionLost, explain } from "../contract/client";
import { JobRunner } from "../contract/runner";
import type { Family, FamilyCheck, FamilyCheckRequest, FamilyDefinition, IsohedralType, Model } from "../contract/types";
import { definitionKey } from "./definition_key";
import { type Drag, dragOf, type DragMode, type Handle } from "./drags";
import type { Edited } from "./edits";
import { type Finding, findingsOf } from "./findings";
import { EMPTY_STATE, type FamilyState, familyOfType, FIRST_TYPE, stateOf } from "./state";
import { type DrawnFamily, drawnFamily } from "./tiling";

/** Pause in the changes after which the definition is checked. */
const CHECK_PAUSE_MS = 250;

/** What the server said of a definition. */
export interface Checked {
  readonly definition: FamilyDefinition;
  readonly findings: readonly Finding[];
}

/** A vertex that was dragged, with the families before and after: the drag may become a parameter. */
export interface LastDrag {
  readonly before: DrawnFamily;
  readonly after: DrawnFamily;
  readonly vertex: number;
}

export class FamilySession {
  readonly edited = new EditedState<FamilyState>(EMPTY_STATE);
  readonly state = this.edited.state;
  readonly steps = this.edited.steps;
  /** The present definition with its tile; null before the table of types has come, and for a definition that cannot be drawn. */
  readonly drawn = new Observable<DrawnFamily | null>(null);
  readonly types = new Observable<readonly IsohedralType[]>([]);
  readonly families = new Observable<readonly Family[]>([]);
  readonly models = new Observable<readonly Model[]>([]);
  readonly mode = new Observable<DragMode>("parameters");
  /** The handle that pointer or keys have chosen; null for none. */
  readonly selected = new Observable<Handle | null>(null);
  /** The latest answer. It is of an earlier definition until the server has answered. */
  readonly checked = new Observable<Checked | null>(null);
  /** The last change, if it was a drag of a vertex that has changed the tile. */
  readonly lastDrag = new Observable<LastDrag | null>(null);
  /** Why the page cannot begin; empty if it can. */
  readonly fault = new Observable("");
  readonly redraws = new Redraws(() => this.edited.isBeingChanged);
  readonly checks: JobRunner;
  private readonly checkLater = debounce(() => this.check(), CHECK_PAUSE_MS);
  private drag: { readonly handle: Handle; readonly move: Drag | null; readonly before: DrawnFamily } | null = null;

  constructor(private readonly client: Client) {
    this.checks = new JobRunner(client.unreported());
    // Whatever changes the state, the tile is drawn and checked anew.
    this.state.watch(({ definition }) => this.redefine(definition));
  }

  get isStarted(): boolean {
    return this.types.get().length > 0;
  }

  /** Loads what the server has, and begins with the state of a link or with a type. */
  async start(linked: FamilyState | null): Promise<void> {
    try {
      const [{ types }] = await Promise.all([this.client.get<{ types: IsohedralType[] }>("/v1/isohedral-types"), this.loadFamilies()]);
      this.types.set(types);
      const first = types.find(({ number }) => number === FIRST_TYPE) ?? types[0];
      this.edited.begin(linked ?? stateOf(familyOfType(first)));
      this.fault.set("");
    } catch (error) {
      // The frame reports a lost connection, and the page tries again when the server answers.
      if (!(error instanceof ConnectionLost)) this.fault.set(explain(error));
    }
  }

  /** Asks which families and models the server has now. */
  async loadFamilies(): Promise<void> {
    const [{ families }, { models }] = await Promise.all([
      this.client.get<{ families: Family[] }>("/v1/families"),
      this.client.get<{ models: Model[] }>("/v1/models"),
    ]);
    this.families.set(families);
    this.models.set(models);
  }

  /** The server's family of the definition's name; null if there is none. */
  get namesake(): Family | null {
    const { id } = this.state.get().definition;
    return this.families.get().find((family) => family.id === id) ?? null;
  }

  /** Whether the server has this very definition. */
  get isStored(): boolean {
    const { namesake } = this;
    return namesake !== null && namesake.definition !== null && definitionKey(namesake.definition) === definitionKey(this.state.get().definition);
  }

  /** The model of this very family; null if there is none. */
  get model(): Model | null {
    const { id } = this.state.get().definition;
    return this.isStored ? (this.models.get().find(({ family }) => family === id) ?? null) : null;
  }

  /** Begins with another definition, as a step. */
  open(definition: FamilyDefinition): void {
    this.apply(stateOf(definition, this.state.get()));
  }

  openType(type: IsohedralType): void {
    this.open(familyOfType(type));
  }

  /** Shows an intermediate state of a change. It ends with `finish`. */
  preview(change: Partial<FamilyState>): void {
    this.edited.beginChange();
    this.edited.change(change);
  }

  /** Ends a change, which becomes one step of the history. */
  finish(): void {
    const { drag } = this;
    this.drag = null;
    if (!this.edited.endChange()) return;
    this.edited.push();
    this.note(drag);
  }

  /** Makes a change without intermediate states. */
  apply(change: Partial<FamilyState>): void {
    this.finish();
    this.edited.change(change);
    this.edited.push();
    this.lastDrag.set(null);
  }

  /** Makes an edit of the family that can be drawn. */
  edit(change: (family: DrawnFamily, edited: Edited) => Edited): void {
    const family = this.drawn.get();
    if (family) this.apply(change(family, this.state.get()));
  }

  /** Takes what the server has made of the definition, which is the same family, without a step. */
  adopt(definition: FamilyDefinition): void {
    this.edited.amend({ ...this.state.get(), definition });
  }

  undo(): void {
    this.finish();
    this.edited.undo((state) => this.restore(state));
  }

  redo(): void {
    this.finish();
    this.edited.redo((state) => this.restore(state));
  }

  /** Drags a handle to where it is moved by a vector from the beginning of the drag. Returns false if it cannot be moved. */
  dragBy(handle: Handle, by: readonly [number, number]): boolean {
    const family = this.drawn.get();
    if (!family) return false;
    if (!this.drag || !isSameHandle(this.drag.handle, handle)) {
      this.finish();
      this.drag = { handle, move: dragOf(family, this.state.get(), handle, this.mode.get()), before: family };
    }
    const { move } = this.drag;
    if (!move) return false;
    this.preview(move(by));
    return true;
  }

  /** The findings of the present definition; null until the server has checked it. */
  get findings(): readonly Finding[] | null {
    const checked = this.checked.get();
    return checked?.definition === this.state.get().definition ? checked.findings : null;
  }

  /** Repeats what a lost connection has ended. */
  retry(): void {
    if (this.checks.hasFailed || this.findings === null) this.check();
  }

  private restore(state: FamilyState): void {
    this.lastDrag.set(null);
    this.state.set(state);
  }

  private note(drag: { readonly handle: Handle; readonly before: DrawnFamily } | null): void {
    const after = this.drawn.get();
    const isOfTile = drag?.handle.kind === "vertex" && after !== null && after.definition !== drag.before.definition && this.mode.get() === "tile";
    this.lastDrag.set(drag && isOfTile && drag.handle.kind === "vertex" ? { before: drag.before, after, vertex: drag.handle.vertex } : null);
  }

  private redefine(definition: FamilyDefinition): void {
    if (!this.isStarted) return;
    if (this.drawn.get()?.definition === definition) return;
    this.drawn.set(drawnFamily(definition, this.types.get()));
    this.checkLater.schedule();
  }

  private check(): void {
    const { definition } = this.state.get();
    if (!this.isStarted || this.checked.get()?.definition === definition) return;
    const request: FamilyCheckRequest = { definition, priority: "interactive" };
    this.checks.follow(async (run) => {
      run.tell({ words: "Checking" });
      const answer = await run.post<FamilyCheck>("/v1/family-checks", request);
      this.checked.set({ definition, findings: findingsOf(answer) });
    }, (error) => {
      this.checks.tellFault(error);
      if (!(error instanceof ConnectionLost)) this.checked.set(null);
    });
  }
}

function isSameHandle(a: Handle, b: Handle): boolean {
  return JSON.stringify(a) === JSON.stringify(b);
}
