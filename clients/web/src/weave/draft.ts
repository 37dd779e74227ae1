// The draft of a strand that the user is drawing point by point.
import { Observable } from "../base/observable";
import { type Ends, strandOf, withStrand } from "./layout_edit";
import type { WeaveSession } from "./session";
import type { Point } from "./state";

export class Draft {
  /** Points of the draft; null while no strand is drawn. */
  readonly points = new Observable<readonly Point[] | null>(null);

  constructor(private readonly session: WeaveSession) {
    session.state.watch((state) => {
      if (state.pattern !== "layout") this.points.set(null);
    });
  }

  begin(): void {
    this.points.set([]);
  }

  /** Adds a point, unless it is equal to the last one. */
  add(point: Point): void {
    const points = this.points.get() ?? [];
    const last = points[points.length - 1];
    if (!last || Math.hypot(point[0] - last[0], point[1] - last[1]) > 0) this.points.set([...points, point]);
  }

  removeLast(): void {
    this.points.set((this.points.get() ?? []).slice(0, -1));
  }

  cancel(): void {
    this.points.set(null);
  }

  /** Adds the strand to the layout. Returns false if it has too few points for such ends. */
  finish(ends: Ends): boolean {
    const { layout } = this.session.state.get();
    const strand = strandOf(this.points.get() ?? [], ends, layout.lattice);
    if (!strand) return false;
    this.points.set(null);
    this.session.setLayout(withStrand(layout, strand));
    return true;
  }

  /** Handles keys while a strand is drawn: Enter ends it, Backspace removes the last point, Escape cancels the draft. */
  key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (this.points.get() === null || target.matches("input, textarea, select, button, [role=button]")) return;
    if (event.key === "Enter") this.finish("open");
    else if (event.key === "Backspace") this.removeLast();
    else if (event.key === "Escape") this.cancel();
    else return;
    event.preventDefault();
  }
}
