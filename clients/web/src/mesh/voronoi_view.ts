// What is drawn of a Voronoi diagram: sites, borders and coloured cells, or an intermediate state of the optimization.
import { Observable } from "../base/observable";
import type { CellPicture } from "./cell_drawing";
import type { Vector } from "./mesh_data";
import type { DotKind, NetworkPicture } from "./network_drawing";
import { type Range, rampColour, rangeOf, type Rgb, fractionOf } from "./spring_colours";
import { RAMP } from "./surface_material";
import type { DiagramResult, VoronoiSession } from "./voronoi_session";

export type CellColourBy = "cells" | "area" | "none";

/** Colours of cells, in linear light. */
export const CELL_COLOURS: readonly Rgb[] = [
  [0.62, 0.75, 0.72],
  [0.86, 0.66, 0.42],
  [0.52, 0.6, 0.78],
  [0.8, 0.52, 0.5],
  [0.6, 0.72, 0.42],
  [0.72, 0.56, 0.74],
  [0.87, 0.8, 0.5],
  [0.45, 0.68, 0.75],
];
const BORDER_COLOUR: Rgb = [0.02, 0.03, 0.04];

/** The index of a colour for each cell, by greedy colouring: the first one that no earlier neighbour has. `colours`: number of colours. */
export function cellColours(neighbours: readonly (readonly number[])[], colours: number): number[] {
  const chosen: number[] = [];
  neighbours.forEach((others, cell) => {
    const taken = new Set(others.filter((other) => other < cell).map((other) => chosen[other]));
    const free = Array.from({ length: colours }, (_, k) => k).find((k) => !taken.has(k));
    chosen.push(free ?? cell % colours);
  });
  return chosen;
}

export class VoronoiView {
  /** Sites as points and borders as lines. */
  readonly picture = new Observable<NetworkPicture | null>(null);
  readonly cells = new Observable<CellPicture | null>(null);
  readonly colourBy = new Observable<CellColourBy>("cells");
  /** Range of the areas of the cells. */
  readonly range = new Observable<Range>({ min: 0, max: 0 });
  private colourKey: readonly unknown[] = [];

  constructor(private readonly session: VoronoiSession) {
    for (const part of [session.sites, session.state, session.chosen, session.result, session.optimizing, this.colourBy]) part.watch(() => this.draw());
  }

  private draw(): void {
    const { session } = this;
    const optimizing = session.optimizing.get();
    const partial = optimizing && !optimizing.answer ? optimizing.partial : null;
    const sites = session.sites.get();
    const diagram = session.result.get()?.diagram ?? null;
    this.drawCells(partial ? null : diagram);
    if (sites.length === 0 || !session.data) return this.picture.set(null);
    const positions = (partial?.site_positions as readonly unknown[] as readonly Vector[] | undefined) ?? sites.map((site) => session.position(site));
    const places = (partial?.positions ?? diagram?.positions ?? []) as readonly unknown[] as readonly Vector[];
    const borders = partial?.borders ?? diagram?.edges.map((edge) => edge.points) ?? [];
    const { fixed } = session.state.get();
    const kinds = positions.map((): DotKind => "free");
    for (const site of fixed) if (site < kinds.length) kinds[site] = "fixed";
    const chosen = session.chosen.get();
    if (chosen !== null && chosen < kinds.length) kinds[chosen] = "chosen";
    const lines = borders.map((border) => border.map((k) => places[k]));
    this.picture.set({ positions, kinds, lines, colours: lines.map(() => BORDER_COLOUR), triangles: [], triangleColours: [], straight: false });
  }

  private drawCells(diagram: DiagramResult["diagram"] | null): void {
    const by = this.colourBy.get();
    const key = [diagram, by];
    if (key.every((part, k) => part === this.colourKey[k])) return;
    this.colourKey = key;
    if (!diagram?.pieces || by === "none") return this.cells.set(null);
    const areas = diagram.cells.map((cell) => cell.area);
    const range = rangeOf(areas);
    this.range.set(range);
    const chosen = cellColours(diagram.cells.map((cell) => cell.neighbours), CELL_COLOURS.length);
    const colours = by === "area" ? areas.map((area) => rampColour(fractionOf(area, range), RAMP)) : chosen.map((k) => CELL_COLOURS[k]);
    this.cells.set({
      faceSites: diagram.pieces.face_sites,
      pieces: diagram.pieces.cut_faces.map(({ site, face, corners }) => ({ site, face, corners: corners as unknown as Vector[] })),
      colours,
    });
  }
}
