// The intermediate states of a relaxation. They are thinned out when they use too much memory.
import type { Vector } from "./mesh_data";

export interface Frame {
  readonly iteration: number;
  readonly positions: readonly Vector[];
  /** Vertices of a deformable host; absent if they are those of the mesh, or not reported. */
  readonly vertices?: readonly Vector[];
}

/** Limit of the number of coordinates in all frames together, 8 bytes each plus the overhead of arrays. */
const MAX_NUMBERS = 3_000_000;

export class Frames {
  private retained: Frame[] = [];
  /** One of `stride` frames is stored. */
  private stride = 1;
  private count = 0;

  get all(): readonly Frame[] {
    return this.retained;
  }

  add(frame: Frame): void {
    if (this.count++ % this.stride !== 0) return;
    this.retained.push(frame);
    const places = frame.positions.length + (frame.vertices?.length ?? 0);
    if (3 * places * this.retained.length <= MAX_NUMBERS || this.retained.length < 3) return;
    this.retained = this.retained.filter((_, k) => k % 2 === 0);
    this.stride *= 2;
  }
}

/** The frame nearest to an iteration; null if the final state is nearer. */
export function frameAt(frames: readonly Frame[], iterations: number, iteration: number): Frame | null {
  let found: Frame | null = null;
  let minDifference = Math.abs(iterations - iteration);
  for (const frame of frames) {
    const difference = Math.abs(frame.iteration - iteration);
    if (difference < minDifference) [found, minDifference] = [frame, difference];
  }
  return found;
}
