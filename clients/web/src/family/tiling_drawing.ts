// How the plane of a tiling lies in a drawing: the section that is seen, and which copies of the cell fill it. Lengths of drawings are pixels,
// and y points down there.
import { type Box, boxAround, latticeCoordinates, latticePoint, pathOf } from "../base/plane";
import type { Vector } from "./expressions";
import type { Tiling } from "./tiling";

export interface Camera {
  readonly width: number;
  readonly height: number;
  /** The place of the plane in the middle of the drawing. */
  readonly centre: Vector;
  /** Pixels for each tiling unit. */
  readonly scale: number;
}

/** Part of the drawing that the tile takes up when it is brought into sight, and between which it is left where it is. */
const FILLED = 0.42;
const KEPT: readonly [number, number] = [0.2, 0.72];
/** How far the tile's middle may be from that of the drawing, in parts of the drawing. */
const KEPT_OFFSET = 0.2;
/** Limit of the copies of a cell. A lattice that is nearly a line would have very many. */
const MAX_COPIES = 900;

export function toPixels({ width, height, centre, scale }: Camera, [x, y]: Vector): Vector {
  return [width / 2 + scale * (x - centre[0]), height / 2 - scale * (y - centre[1])];
}

export function toPlane({ width, height, centre, scale }: Camera, [x, y]: Vector): Vector {
  return [centre[0] + (x - width / 2) / scale, centre[1] - (y - height / 2) / scale];
}

function middleOf({ x, y, width, height }: Box): Vector {
  return [x + width / 2, y + height / 2];
}

/** A camera that sees the tile in its middle. `filled`: the part of the drawing that the tile takes up. */
export function cameraOn({ outline }: Tiling, width: number, height: number, filled = FILLED): Camera {
  const box = boxAround(outline);
  const scale = filled * Math.min(width / Math.max(box.width, 1e-9), height / Math.max(box.height, 1e-9));
  return { width, height, centre: middleOf(box), scale };
}

/** Whether the tile is well in sight, so that the camera stays where it is. */
export function isInSight({ outline }: Tiling, camera: Camera): boolean {
  const box = boxAround(outline);
  const size = Math.max((box.width * camera.scale) / camera.width, (box.height * camera.scale) / camera.height);
  const [x, y] = toPixels(camera, middleOf(box));
  const isCentred = Math.abs(x / camera.width - 0.5) < KEPT_OFFSET && Math.abs(y / camera.height - 0.5) < KEPT_OFFSET;
  return size > KEPT[0] && size < KEPT[1] && isCentred;
}

/** The translations of the cell, as multiples of the two, with which it is seen. */
export function copiesOf({ tiles, lattice }: Tiling, camera: Camera): Vector[] {
  const cell = boxAround(tiles.flat());
  const [left, bottom] = toPlane(camera, [0, camera.height]);
  const [right, top] = toPlane(camera, [camera.width, 0]);
  // A copy is seen if its translation lies in this box.
  const [x, y, width, height] = [left - cell.x - cell.width, bottom - cell.y - cell.height, right - left + cell.width, top - bottom + cell.height];
  const corners = [[x, y], [x + width, y], [x, y + height], [x + width, y + height]].map((corner) => latticeCoordinates(lattice, corner));
  const range = (axis: 0 | 1) => [Math.ceil(Math.min(...corners.map((corner) => corner[axis]))), Math.floor(Math.max(...corners.map((corner) => corner[axis])))] as const;
  const [[firstI, lastI], [firstK, lastK]] = [range(0), range(1)];
  // A lattice that is nearly a line.
  if (!((lastI - firstI + 1) * (lastK - firstK + 1) < 20 * MAX_COPIES)) return [[0, 0]];
  const found: Vector[] = [];
  for (let i = firstI; i <= lastI; ++i) {
    for (let k = firstK; k <= lastK; ++k) {
      const [u, v] = latticePoint(lattice, i, k);
      if (u >= x && u <= x + width && v >= y && v <= y + height) found.push([i, k]);
    }
  }
  return found.length > MAX_COPIES ? [[0, 0]] : found;
}

/** Closed outlines as the data of a path, in pixels from the plane's origin. */
export function outlinesPath(outlines: readonly (readonly Vector[])[], scale: number): string {
  return outlines.map((outline) => `${pathOf(outline.map(([x, y]) => [scale * x, -scale * y]))}Z`).join("");
}

/** A translation in pixels. */
export function shiftOf({ lattice }: Tiling, [i, k]: Vector, scale: number): Vector {
  const [x, y] = latticePoint(lattice, i, k);
  return [scale * x, -scale * y];
}

/** The copy of a place that is nearest to the middle of the drawing. */
export function nearestCopy({ lattice }: Tiling, { centre }: Camera, [x, y]: Vector): Vector {
  const [u, v] = latticeCoordinates(lattice, [centre[0] - x, centre[1] - y]);
  const [dx, dy] = latticePoint(lattice, Math.round(u), Math.round(v));
  return [x + dx, y + dy];
}

export function isFiniteTiling({ outline, lattice, tiles }: Tiling): boolean {
  return [...outline, ...lattice, ...tiles.flat()].every(([x, y]) => Number.isFinite(x) && Number.isFinite(y));
}
