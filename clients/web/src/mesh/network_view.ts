// What of a network is seen now: the one that was made, a state on the way, or the network at rest with its exact paths.
import { Observable } from "../base/observable";
import type { Vector } from "./mesh_data";
import { exactValues, springsOf, straightValues, type SpringValues } from "./network";
import type { DotKind, NetworkPicture } from "./network_drawing";
import type { Frame } from "./network_frames";
import type { NetworkSession } from "./network_session";
import { type Range, rampColour, rangeOf, shareOf } from "./spring_colours";

export type ColourBy = "energy" | "length";

export class NetworkView {
  readonly picture = new Observable<NetworkPicture | null>(null);
  readonly colourBy = new Observable<ColourBy>("energy");
  /** Of the values that are coloured. */
  readonly range = new Observable<Range>({ least: 0, most: 0 });
  /** An earlier state that is looked at; null for the newest. */
  readonly frame = new Observable<Frame | null>(null);

  constructor(private readonly session: NetworkSession) {
    session.relaxing.watch((relaxing) => {
      if (relaxing?.answer || !relaxing) this.frame.set(null);
      this.draw();
    });
    for (const part of [session.network, session.state, session.chosen, this.frame, this.colourBy]) part.watch(() => this.draw());
  }

  private draw(): void {
    const network = this.session.network.get();
    if (!network) return this.picture.set(null);
    const { positions, lines, values, straight } = this.state();
    const coloured = this.colourBy.get() === "energy" ? values.energies : values.lengths;
    const range = rangeOf(coloured);
    this.range.set(range);
    const { fixed } = this.session.state.get();
    const kinds = positions.map((): DotKind => "free");
    for (const point of fixed) if (point < kinds.length) kinds[point] = "fixed";
    const chosen = this.session.chosen.get();
    if (chosen !== null && chosen < kinds.length) kinds[chosen] = "chosen";
    this.picture.set({ positions, kinds, lines, colours: coloured.map((value) => rampColour(shareOf(value, range))), straight });
  }

  private state(): { positions: readonly Vector[]; lines: readonly (readonly Vector[])[]; values: SpringValues; straight: boolean } {
    const network = this.session.network.get();
    const relaxing = this.session.relaxing.get();
    const frame = this.frame.get();
    const pairs = network?.pairs ?? [];
    if (relaxing?.answer && !frame) {
      const positions = relaxing.answer.positions as unknown as Vector[];
      const lines = relaxing.answer.springs.map(({ between: [a, b], path }) => (path && path.length > 1 ? path.map((point) => point.position as unknown as Vector) : [positions[a], positions[b]]));
      return { positions, lines, values: exactValues(relaxing.answer), straight: relaxing.request.spring_length === "euclidean" };
    }
    const positions = (frame ?? relaxing?.frames.at(-1))?.positions ?? network?.positions ?? [];
    const springs = relaxing ? (relaxing.request.springs as ReturnType<typeof springsOf>) : springsOf(this.session.state.get(), pairs);
    return { positions, lines: pairs.map(([a, b]) => [positions[a], positions[b]]), values: straightValues(positions, springs), straight: true };
  }
}
