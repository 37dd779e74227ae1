// What both plots show and tell. A plot draws views; what is dragged in it comes back as wishes.
import type { Curve } from "../base/curve";
import type { Task } from "../contract/types";
import type { Band, Envelope } from "./shown";
import type { ControlPoint, StrainWord } from "./state";

export interface PinnedCurve extends Curve {
  readonly id: number;
  readonly name: string;
}

export interface PlotView {
  readonly task: Task;
  readonly points: readonly ControlPoint[];
  readonly selected: number | null;
  readonly target: (x: number) => number;
  readonly achieved: Curve | null;
  readonly provisional: boolean;
  readonly before: Curve | null;
  readonly envelope: Envelope | null;
  /** The model's error about what is achieved. */
  readonly doubt: Band | null;
  readonly verified: Curve | null;
  /** Measured points that the target was made of. */
  readonly measured: readonly ControlPoint[];
  /** Pinned designs and overlaid families. */
  readonly pins: readonly PinnedCurve[];
  /** The strain or the angle that the pointer is at. */
  readonly hovered: number | null;
  /** Samples of the target that the design does not reach. */
  readonly missed: readonly ControlPoint[];
  readonly strainWord: StrainWord;
  /** While a point is dragged the axes stand still. */
  readonly dragging: boolean;
}

export interface PlotWishes {
  begin(): void;
  move(index: number, to: ControlPoint): void;
  end(): void;
  add(at: ControlPoint): void;
  remove(index: number): void;
  select(index: number | null): void;
  /** The pointer is at a strain or an angle; nowhere with null. */
  hover(x: number | null): void;
}

/** Which way an arrow key moves a point: shares of the plot's width and height. */
export function keyStep(event: KeyboardEvent): readonly [number, number] | null {
  const size = event.shiftKey ? 0.05 : 0.01;
  switch (event.key) {
    case "ArrowLeft": return [-size, 0];
    case "ArrowRight": return [size, 0];
    case "ArrowUp": return [0, size];
    case "ArrowDown": return [0, -size];
    default: return null;
  }
}
