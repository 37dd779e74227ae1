// The room that the verdict takes at the lower edge of the window, so that the plot above it is as high as what is left.
import type { Observable } from "../base/observable";

/** Tells the styles of a page how high the verdict is. While a control point is dragged the plot keeps its height, so that the point stays under the pointer. */
export function leaveRoom(page: HTMLElement, verdict: HTMLElement, dragging: Observable<boolean>): void {
  const tell = (): void => {
    if (!dragging.get() && verdict.offsetHeight > 0) page.style.setProperty("--verdict-height", `${verdict.offsetHeight}px`);
  };
  new ResizeObserver(tell).observe(verdict);
  dragging.watch(tell);
}
