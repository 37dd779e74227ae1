// The selected direction, and the deformed cell under strain along it.
import { Observable } from "../base/observable";
import type { Polyline } from "../base/plane";
import { type Client, explain } from "../contract/client";
import { JobRunner } from "../contract/runner";
import type { WeaveHomogenization } from "../contract/types";
import { nearestDirection, TERMINATION_WORDS } from "./profile";
import { cellRequest, hasStrands } from "./requests";
import { profileKey, type WeaveSession } from "./session";
import { isPeriodic, type Lattice, type WeaveState } from "./state";

export interface Cell {
  readonly state: WeaveState;
  /** Direction of the strain, in radians. */
  readonly direction: number;
  readonly lattice: Lattice;
  readonly strands: readonly Polyline[];
  /** Why the cell is that of a smaller strain; empty if it is not. */
  readonly note: string;
}

export class DeformedCell {
  /** The direction at the pointer, or else the chosen one, in radians in [0, pi). */
  readonly direction = new Observable(0);
  readonly cell = new Observable<Cell | null>(null);
  readonly fault = new Observable("");
  private chosen = 0;
  private readonly requests: JobRunner;
  private requestedKey = "";

  constructor(
    private readonly session: WeaveSession,
    client: Client,
  ) {
    this.requests = new JobRunner(client);
    session.state.watch(() => this.refresh());
    // A state without a periodic cell or without strands has no deformed cell.
    session.state.watch((state) => {
      if (!isPeriodic(state) || !hasStrands(state)) this.cell.set(null);
    });
    this.direction.watch(() => this.refresh());
  }

  /** Follows the pointer; null returns to the chosen direction. */
  hover(angle: number | null): void {
    this.direction.set(angle === null ? this.chosen : this.nearestSampled(angle));
  }

  choose(angle: number): void {
    this.chosen = this.nearestSampled(angle);
    this.direction.set(this.chosen);
  }

  /** Chooses another direction, `count` samples of the profile further. */
  step(count: number): void {
    const profile = this.session.profile.get();
    if (!profile) return;
    const size = profile.directions.length;
    const index = nearestDirection(profile, this.chosen) + count;
    this.choose(profile.directions[((index % size) + size) % size]);
  }

  retry(): void {
    this.requestedKey = "";
    this.refresh();
  }

  private nearestSampled(angle: number): number {
    const profile = this.session.profile.get();
    return profile ? profile.directions[nearestDirection(profile, angle)] : angle;
  }

  private refresh(): void {
    const state = this.session.state.get();
    const direction = this.direction.get();
    if (!isPeriodic(state) || !hasStrands(state)) {
      this.requestedKey = "";
      return this.requests.stop();
    }
    const key = `${profileKey(state)} ${direction}`;
    if (key === this.requestedKey) return;
    this.requestedKey = key;
    this.requests.follow(async (run) => {
      this.show(state, direction, await run.job<WeaveHomogenization>("/v1/weave-homogenizations", cellRequest(state, direction), { wait: 5 }));
    }, (error) => {
      this.requestedKey = "";
      this.fault.set(explain(error));
    });
  }

  private show(state: WeaveState, direction: number, answer: WeaveHomogenization): void {
    const [cell] = answer.cells;
    const termination = answer.stopped[0];
    this.fault.set("");
    this.cell.set({
      state,
      direction,
      lattice: cell.lattice as unknown as Lattice,
      strands: cell.strands,
      note: termination === "converged" ? "" : `The cell where the path ended: ${TERMINATION_WORDS[termination]}.`,
    });
  }
}
