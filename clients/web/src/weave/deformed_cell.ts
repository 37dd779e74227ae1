// The direction that is looked at, and the deformed cell that belongs to it.
import { Latest } from "../base/latest";
import { Observable } from "../base/observable";
import { type Client, explain, isAbort } from "../contract/client";
import { runJob } from "../contract/jobs";
import type { WeaveHomogenization } from "../contract/types";
import type { Polyline } from "./geometry";
import { nearestDirection, STOP_WORDS } from "./profile";
import { cellRequest, hasStrands } from "./requests";
import { profileKey, type WeaveSession } from "./session";
import { isPeriodic, type Lattice, type WeaveState } from "./state";

export interface Cell {
  readonly state: WeaveState;
  /** Radians. */
  readonly direction: number;
  readonly lattice: Lattice;
  readonly strands: readonly Polyline[];
  /** Why the cell is that of a smaller strain; empty where it is not. */
  readonly note: string;
}

export class DeformedCell {
  /** Radians in [0, pi), where the pointer is or what was chosen. */
  readonly direction = new Observable(0);
  readonly cell = new Observable<Cell | null>(null);
  readonly fault = new Observable("");
  private chosen = 0;
  private readonly requests = new Latest();
  private asked = "";

  constructor(
    private readonly session: WeaveSession,
    private readonly client: Client,
  ) {
    session.state.watch(() => this.refresh());
    // The cells of the pattern before are no longer those of this weave.
    session.state.watch((state) => {
      if (!isPeriodic(state) || !hasStrands(state)) this.cell.set(null);
    });
    this.direction.watch(() => this.refresh());
  }

  /** The pointer is at an angle, or nowhere: back to what was chosen. */
  hover(angle: number | null): void {
    this.direction.set(angle === null ? this.chosen : this.snapped(angle));
  }

  choose(angle: number): void {
    this.chosen = this.snapped(angle);
    this.direction.set(this.chosen);
  }

  /** On by so many of the profile's directions. */
  step(count: number): void {
    const profile = this.session.profile.get();
    if (!profile) return;
    const size = profile.directions.length;
    const index = nearestDirection(profile, this.chosen) + count;
    this.choose(profile.directions[((index % size) + size) % size]);
  }

  retry(): void {
    this.asked = "";
    this.refresh();
  }

  private snapped(angle: number): number {
    const profile = this.session.profile.get();
    return profile ? profile.directions[nearestDirection(profile, angle)] : angle;
  }

  private refresh(): void {
    const state = this.session.state.get();
    const direction = this.direction.get();
    if (!isPeriodic(state) || !hasStrands(state)) {
      this.asked = "";
      return this.requests.cancel();
    }
    const key = `${profileKey(state)} ${direction}`;
    if (key === this.asked) return;
    this.asked = key;
    this.requests.submit(async (signal) => {
      try {
        const request = cellRequest(state, direction);
        const answer = await runJob<WeaveHomogenization>(this.client, "/v1/weave-homogenizations", request, { signal, wait: 5 });
        if (!signal.aborted) this.show(state, direction, answer);
      } catch (error) {
        if (isAbort(error)) return;
        this.asked = "";
        this.fault.set(explain(error));
      }
    });
  }

  private show(state: WeaveState, direction: number, answer: WeaveHomogenization): void {
    const [cell] = answer.cells;
    const stop = answer.stopped[0];
    this.fault.set("");
    this.cell.set({
      state,
      direction,
      lattice: cell.lattice as unknown as Lattice,
      strands: cell.strands,
      note: stop === "converged" ? "" : `The cell where the path ended: ${STOP_WORDS[stop]}.`,
    });
  }
}
