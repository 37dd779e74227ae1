// The states that a network went through, as many as memory allows.
import type { Vector } from "./mesh_data";

export interface Frame {
  readonly iteration: number;
  readonly positions: readonly Vector[];
  /** Of a host that gives way; absent where they are as in the mesh, or not told. */
  readonly vertices?: readonly Vector[];
}

/** Numbers that all frames together keep at most: 8 bytes each, and what arrays cost. */
const MOST_NUMBERS = 3_000_000;

export class Frames {
  private kept: Frame[] = [];
  /** Only every so many frames is kept. */
  private every = 1;
  private count = 0;

  get all(): readonly Frame[] {
    return this.kept;
  }

  add(frame: Frame): void {
    if (this.count++ % this.every !== 0) return;
    this.kept.push(frame);
    const places = frame.positions.length + (frame.vertices?.length ?? 0);
    if (3 * places * this.kept.length <= MOST_NUMBERS || this.kept.length < 3) return;
    this.kept = this.kept.filter((_, k) => k % 2 === 0);
    this.every *= 2;
  }
}

/** The frame that is nearest to an iteration; null where the end of all iterations is nearer. */
export function frameAt(frames: readonly Frame[], iterations: number, iteration: number): Frame | null {
  let found: Frame | null = null;
  let least = Math.abs(iterations - iteration);
  for (const frame of frames) {
    const away = Math.abs(frame.iteration - iteration);
    if (away < least) [found, least] = [frame, away];
  }
  return found;
}
