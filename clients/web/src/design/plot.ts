// The interface of both plots: the view that a plot draws, and the actions that it calls when the user edits the target.
import type { Curve } from "../base/curve";
import type { HandleActions, HandleNames, HandlesView } from "../base/handles";
import type { Task } from "../contract/types";
import type { Band, Envelope } from "./shown";
import type { ControlPoint, StrainWord } from "./state";

export interface PinnedCurve extends Curve {
  readonly id: number;
  readonly name: string;
}

export const CONTROL_POINT_NAMES: HandleNames = { group: "Control points of the target", of: (index) => `Control point ${index + 1}` };

/** The points are the control points of the target, of which those are faulty for which the server has refused it. */
export interface PlotView extends HandlesView {
  readonly task: Task;
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

export interface PlotActions extends HandleActions {
  add(at: ControlPoint): void;
  /** Called with the strain or the angle at the pointer, and with null when it leaves. */
  hover(x: number | null): void;
  /** Called when a pinch or the wheel with Ctrl has changed the visible section. */
  zoomed(isZoomed: boolean): void;
}
