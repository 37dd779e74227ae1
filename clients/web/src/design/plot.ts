// The interface of both plots: the view that a plot draws, and the actions that it calls when the user edits the target.
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
  /** Control points for which the server has refused the target. */
  readonly faulty: readonly number[];
  readonly target: (x: number) => number;
  readonly achieved: Curve | null;
  readonly provisional: boolean;
  readonly previous: Curve | null;
  readonly envelope: Envelope | null;
  /** The nearest that any material can have at rest, where it differs from the target. */
  readonly bound: Curve | null;
  /** Error band of the model around the achieved curve. */
  readonly uncertainty: Band | null;
  readonly verified: Curve | null;
  /** The curves of the rounds of a running polish. */
  readonly rounds: readonly (Curve & { readonly isBest: boolean })[];
  /** Measured points from which the target was made. */
  readonly measured: readonly ControlPoint[];
  /** Curves of pinned designs and overlaid families. */
  readonly pins: readonly PinnedCurve[];
  /** The strain or the angle at the pointer; null if the pointer is outside. */
  readonly hovered: number | null;
  /** Samples of the target that the design misses. */
  readonly missed: readonly ControlPoint[];
  readonly strainWord: StrainWord;
  /** Whether a control point is being dragged; the axes then keep their domains. */
  readonly dragging: boolean;
}

export interface PlotActions {
  begin(): void;
  move(index: number, to: ControlPoint): void;
  end(): void;
  add(at: ControlPoint): void;
  remove(index: number): void;
  select(index: number | null): void;
  /** Called with the strain or the angle at the pointer, and with null when it leaves. */
  hover(x: number | null): void;
  /** Called when a pinch or the wheel with Ctrl has changed the visible section. */
  zoomed(isZoomed: boolean): void;
}

/** The step of an arrow key, in fractions of the plot's width and height; null for other keys. */
export function keyStep(event: KeyboardEvent): readonly [number, number] | null {
  const size = event.shiftKey ? 0.05 : 0.01;
  switch (event.key) {
    case "ArrowLeft":
      return [-size, 0];
    case "ArrowRight":
      return [size, 0];
    case "ArrowUp":
      return [0, size];
    case "ArrowDown":
      return [0, -size];
    default:
      return null;
  }
}
