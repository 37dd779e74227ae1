// What of a network is seen now: the one that was made, a state on the way, or the network at rest with its exact paths.
import { Observable } from "../base/observable";
import type { Vector } from "./mesh_data";
import { exactTriangles, exactValues, materialOf, springsOf, straightTriangles, straightValues, type SpringValues, type TriangleValues } from "./network";
import type { DotKind, NetworkPicture } from "./network_drawing";
import type { Frame } from "./network_frames";
import type { NetworkSession } from "./network_session";
import { type Range, rampColour, rangeOf, shareOf } from "./spring_colours";
import { RAMP } from "./surface_material";

export type ColourBy = "energy" | "length";
export type TriangleColourBy = "stretch" | "density";

/** The least and the greatest principal stretch of all triangles. */
export interface StretchRange extends Range {
  /** Of shortest paths instead of segments through space. */
  readonly exact: boolean;
}

export class NetworkView {
  readonly picture = new Observable<NetworkPicture | null>(null);
  readonly colourBy = new Observable<ColourBy>("energy");
  /** Of the values that are coloured. */
  readonly range = new Observable<Range>({ least: 0, most: 0 });
  readonly triangleColourBy = new Observable<TriangleColourBy>("stretch");
  readonly triangleRange = new Observable<Range>({ least: 0, most: 0 });
  /** Null where there are no triangles. */
  readonly stretches = new Observable<StretchRange | null>(null);
  /** An earlier state that is looked at; null for the newest. */
  readonly frame = new Observable<Frame | null>(null);

  constructor(private readonly session: NetworkSession) {
    session.relaxing.watch((relaxing) => {
      if (relaxing?.answer || !relaxing) this.frame.set(null);
      this.draw();
    });
    for (const part of [session.network, session.state, session.chosen, this.frame, this.colourBy, this.triangleColourBy]) part.watch(() => this.draw());
  }

  private draw(): void {
    const network = this.session.network.get();
    if (!network) return this.picture.set(null);
    const { positions, lines, values, membrane, straight } = this.state();
    const triangles = membrane.stretches.length > 0 ? network.triangles : [];
    this.stretches.set(triangles.length > 0 ? { ...rangeOf(membrane.stretches.flat()), exact: membrane.exact } : null);
    const shown = this.triangleColourBy.get() === "stretch" ? membrane.stretches.map(([greater]) => greater) : membrane.densities;
    const triangleRange = rangeOf(shown);
    this.triangleRange.set(triangleRange);
    const coloured = this.colourBy.get() === "energy" ? values.energies : values.lengths;
    const range = rangeOf(coloured);
    this.range.set(range);
    const { fixed } = this.session.state.get();
    const kinds = positions.map((): DotKind => "free");
    for (const point of fixed) if (point < kinds.length) kinds[point] = "fixed";
    const chosen = this.session.chosen.get();
    if (chosen !== null && chosen < kinds.length) kinds[chosen] = "chosen";
    const triangleColours = shown.map((value) => rampColour(shareOf(value, triangleRange), RAMP));
    this.picture.set({ positions, kinds, lines, colours: coloured.map((value) => rampColour(shareOf(value, range))), triangles, triangleColours, straight });
  }

  private state(): { positions: readonly Vector[]; lines: readonly (readonly Vector[])[]; values: SpringValues; membrane: TriangleValues; straight: boolean } {
    const network = this.session.network.get();
    const relaxing = this.session.relaxing.get();
    const frame = this.frame.get();
    const pairs = network?.pairs ?? [];
    if (relaxing?.answer && !frame) {
      const positions = relaxing.answer.positions as unknown as Vector[];
      const lines = relaxing.answer.springs.map(({ between: [a, b], path }) => (path && path.length > 1 ? path.map((point) => point.position as unknown as Vector) : [positions[a], positions[b]]));
      return { positions, lines, values: exactValues(relaxing.answer), membrane: exactTriangles(relaxing.answer, materialOf(relaxing.request)), straight: relaxing.request.spring_length === "euclidean" };
    }
    const positions = (frame ?? relaxing?.frames.at(-1))?.positions ?? network?.positions ?? [];
    const state = this.session.state.get();
    const springs = relaxing ? (relaxing.request.springs as ReturnType<typeof springsOf>) : springsOf(state, pairs);
    const material = materialOf(relaxing?.request ?? { membrane: { youngs_modulus: state.youngsModulus, poisson_ratio: state.poissonRatio, thickness: state.thickness, rest_scale: state.restScale } });
    const membrane = network ? straightTriangles(network, positions, material, material.rest_scale) : { stretches: [], densities: [], exact: false };
    return { positions, lines: pairs.map(([a, b]) => [positions[a], positions[b]]), values: straightValues(positions, springs), membrane, straight: true };
  }
}
