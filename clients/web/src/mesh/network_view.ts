// What is drawn of a network: the constructed network, an intermediate state, or the equilibrium with exact paths, together with the
// deformed surface of its host.
import { Observable } from "../base/observable";
import type { PathPoint } from "../contract/types";
import { deformationColour, type DeformationBy, deformationOf, greatestFactor } from "./deformation";
import { facePosition, type MeshData, type Vector } from "./mesh_data";
import { exactTriangles, exactValues, materialOf, springsOf, straightTriangles, straightValues, type SpringValues, type TriangleValues } from "./network";
import { faultyPoints } from "./network_faults";
import type { DotKind, NetworkPicture } from "./network_drawing";
import type { Frame } from "./network_frames";
import type { NetworkSession } from "./network_session";
import { type Range, rampColour, rangeOf, fractionOf } from "./spring_colours";
import { RAMP } from "./surface_material";
import type { HostPicture } from "./viewer";

export type ColourBy = "energy" | "length";
export type TriangleColourBy = "stretch" | "density";

/** The smallest and the largest principal stretch of all triangles. */
export interface StretchRange extends Range {
  /** Whether the values are of shortest paths; otherwise of straight segments in space. */
  readonly exact: boolean;
}

export class NetworkView {
  readonly picture = new Observable<NetworkPicture | null>(null);
  readonly colourBy = new Observable<ColourBy>("energy");
  /** Range of the values by which springs are coloured. */
  readonly range = new Observable<Range>({ min: 0, max: 0 });
  readonly triangleColourBy = new Observable<TriangleColourBy>("stretch");
  readonly triangleRange = new Observable<Range>({ min: 0, max: 0 });
  /** Null if there are no triangles. */
  readonly stretches = new Observable<StretchRange | null>(null);
  /** The intermediate state to be drawn; null for the newest. */
  readonly frame = new Observable<Frame | null>(null);

  /** The deformed surface of the host; null while it is undeformed. */
  readonly host = new Observable<HostPicture | null>(null);
  readonly deformationBy = new Observable<DeformationBy>("area");
  /** The factor at the end of the colour scale; its inverse is at the beginning. */
  readonly deformation = new Observable(1);
  /** Whether a deformed surface is drawn in its shape at rest. */
  readonly atRest = new Observable(false);
  private hostKey: readonly unknown[] = [];
  /** The points at fault, which are marked. */
  private faulty: readonly number[] = [];

  constructor(private readonly session: NetworkSession) {
    session.relaxing.watch((relaxing) => {
      if (relaxing?.answer || !relaxing) this.frame.set(null);
      this.draw();
    });
    for (const part of [session.network, session.state, session.chosen, this.frame, this.colourBy, this.triangleColourBy, this.deformationBy, this.atRest]) {
      part.watch(() => this.draw());
    }
    session.activity.watch((activity) => {
      const faulty = faultyPoints(activity, session.state.get(), session.network.get());
      if (faulty.join() === this.faulty.join()) return;
      this.faulty = faulty;
      this.draw();
    });
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
    for (const point of this.faulty) if (point < kinds.length) kinds[point] = "faulty";
    const triangleColours = shown.map((value) => rampColour(fractionOf(value, triangleRange), RAMP));
    this.picture.set({ positions, kinds, lines, colours: coloured.map((value) => rampColour(fractionOf(value, range))), triangles, triangleColours, straight });
  }

  /** Number of vertices of the mesh. */
  get restVertices(): number {
    return (this.session.data?.positions.length ?? 0) / 3;
  }

  /** Draws the host. It comes before the network, which lies on it. */
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
    this.host.set({ vertices: this.atRest.get() ? null : vertices, colours: values?.map((value) => deformationColour(value, factor)) ?? null });
  }

  /** The vertices of a deformed host in the drawn state; null if it is undeformed. */
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
      // Points keep faces and barycentric coordinates, which gives their positions on the shape at rest.
      const isMappedToRest = answer.host !== undefined && this.atRest.get() && data !== null;
      const positions = isMappedToRest ? answer.points.map((point) => placeOn(data, point)) : (answer.positions as unknown as Vector[]);
      const place = (point: PathPoint) => (isMappedToRest ? placeOn(data, point) : (point.position as unknown as Vector));
      const lines = answer.springs.map(({ between: [a, b], path }) => (path && path.length > 1 ? path.map(place) : [positions[a], positions[b]]));
      return {
        positions,
        lines,
        values: exactValues(answer),
        membrane: exactTriangles(answer, materialOf(relaxing.request)),
        straight: relaxing.request.spring_length === "euclidean",
      };
    }
    const drawnFrame = frame ?? relaxing?.frames.at(-1);
    // Intermediate states have no faces of the points: on the shape at rest the constructed network is drawn.
    const positions = (this.atRest.get() && drawnFrame?.vertices ? network?.positions : drawnFrame?.positions) ?? network?.positions ?? [];
    const state = this.session.state.get();
    const springs = relaxing ? (relaxing.request.springs as ReturnType<typeof springsOf>) : springsOf(state, pairs);
    const material = materialOf(
      relaxing?.request ?? { membrane: { youngs_modulus: state.youngsModulus, poisson_ratio: state.poissonRatio, thickness: state.thickness, rest_scale: state.restScale } },
    );
    const membrane = network ? straightTriangles(network, positions, material, material.rest_scale) : { stretches: [], densities: [], exact: false };
    return { positions, lines: pairs.map(([a, b]) => [positions[a], positions[b]]), values: straightValues(positions, springs), membrane, straight: true };
  }
}

function placeOn(data: MeshData, { face, barycentric }: Pick<PathPoint, "face" | "barycentric">): Vector {
  return facePosition(data, face, barycentric);
}
