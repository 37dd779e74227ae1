// What of a network is seen now: the one that was made, a state on the way, or the network at rest with its exact paths; and the
// surface that carries it, where that gives way.
import { Observable } from "../base/observable";
import type { PathPoint } from "../contract/types";
import { deformationColour, type DeformationBy, deformationOf, greatestFactor } from "./deformation";
import { facePosition, type MeshData, type Vector } from "./mesh_data";
import { exactTriangles, exactValues, materialOf, springsOf, straightTriangles, straightValues, type SpringValues, type TriangleValues } from "./network";
import type { DotKind, NetworkPicture } from "./network_drawing";
import type { Frame } from "./network_frames";
import type { NetworkSession } from "./network_session";
import { type Range, rampColour, rangeOf, shareOf } from "./spring_colours";
import { RAMP } from "./surface_material";
import type { HostPicture } from "./viewer";

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

  /** The surface that carries the network; null while it is as the mesh has it. */
  readonly host = new Observable<HostPicture | null>(null);
  readonly deformationBy = new Observable<DeformationBy>("area");
  /** Colours of the surface reach from its inverse to it. */
  readonly deformation = new Observable(1);
  /** Whether the surface is seen as the mesh has it although it gave way. */
  readonly atRest = new Observable(false);
  private hostKey: readonly unknown[] = [];

  constructor(private readonly session: NetworkSession) {
    session.relaxing.watch((relaxing) => {
      if (relaxing?.answer || !relaxing) this.frame.set(null);
      this.draw();
    });
    for (const part of [session.network, session.state, session.chosen, this.frame, this.colourBy, this.triangleColourBy, this.deformationBy, this.atRest]) part.watch(() => this.draw());
  }

  private draw(): void {
    this.drawHost();
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

  /** Of the mesh. */
  get restVertices(): number {
    return (this.session.data?.positions.length ?? 0) / 3;
  }

  /** Before the network, which lies on it. */
  private drawHost(): void {
    const vertices = this.vertices();
    const { data } = this.session;
    const by = this.deformationBy.get();
    const key = [vertices, data, by, this.atRest.get()];
    if (key.every((part, k) => part === this.hostKey[k])) return;
    this.hostKey = key;
    if (!vertices || !data) return this.host.set(null);
    const values = by === "none" ? null : deformationOf(data, vertices, by);
    const factor = values ? greatestFactor(values) : 1;
    if (values) this.deformation.set(factor);
    this.host.set({ vertices: this.atRest.get() ? null : vertices, colours: values && values.map((value) => deformationColour(value, factor)) });
  }

  /** Of a host that gave way, in the state that is seen; null where they are as in the mesh. */
  private vertices(): readonly Vector[] | null {
    const relaxing = this.session.relaxing.get();
    if (!relaxing || !this.session.network.get()) return null;
    const frame = this.frame.get();
    if (relaxing.answer && !frame) return (relaxing.answer.host?.vertices as unknown as Vector[] | undefined) ?? null;
    return (frame ?? relaxing.frames.at(-1))?.vertices ?? null;
  }

  private state(): { positions: readonly Vector[]; lines: readonly (readonly Vector[])[]; values: SpringValues; membrane: TriangleValues; straight: boolean } {
    const network = this.session.network.get();
    const relaxing = this.session.relaxing.get();
    const frame = this.frame.get();
    const pairs = network?.pairs ?? [];
    if (relaxing?.answer && !frame) {
      const { answer } = relaxing;
      const { data } = this.session;
      // Points keep their faces: on the shape at rest they are where the material that they lie on was.
      const isCarriedBack = answer.host !== undefined && this.atRest.get() && data !== null;
      const positions = isCarriedBack ? answer.points.map((point) => placeOn(data, point)) : (answer.positions as unknown as Vector[]);
      const place = (point: PathPoint) => (isCarriedBack ? placeOn(data, point) : (point.position as unknown as Vector));
      const lines = answer.springs.map(({ between: [a, b], path }) => (path && path.length > 1 ? path.map(place) : [positions[a], positions[b]]));
      return { positions, lines, values: exactValues(answer), membrane: exactTriangles(answer, materialOf(relaxing.request)), straight: relaxing.request.spring_length === "euclidean" };
    }
    const seen = frame ?? relaxing?.frames.at(-1);
    // On the way nothing tells where the points are on the shape at rest: the network is seen as it was made.
    const positions = (this.atRest.get() && seen?.vertices ? network?.positions : seen?.positions) ?? network?.positions ?? [];
    const state = this.session.state.get();
    const springs = relaxing ? (relaxing.request.springs as ReturnType<typeof springsOf>) : springsOf(state, pairs);
    const material = materialOf(relaxing?.request ?? { membrane: { youngs_modulus: state.youngsModulus, poisson_ratio: state.poissonRatio, thickness: state.thickness, rest_scale: state.restScale } });
    const membrane = network ? straightTriangles(network, positions, material, material.rest_scale) : { stretches: [], densities: [], exact: false };
    return { positions, lines: pairs.map(([a, b]) => [positions[a], positions[b]]), values: straightValues(positions, springs), membrane, straight: true };
  }
}

function placeOn(data: MeshData, { face, barycentric }: Pick<PathPoint, "face" | "barycentric">): Vector {
  return facePosition(data, face, barycentric);
}
