// Zoom of a plot by pinching or by the wheel with Ctrl. A factor of 1 shows the whole plot.

export const MAX_ZOOM = 40;
/** Zoom of a wheel's notch of 100 units, and of a trackpad's pinch, which browsers report as a wheel with Ctrl. */
const WHEEL_RATE = 0.004;

export type Range = readonly [lower: number, upper: number];

/** The section of an axis that is shown: by what it is magnified, and which fraction of the whole axis is in its middle. */
export interface AxisZoom {
  readonly factor: number;
  readonly middle: number;
}

export const WHOLE: AxisZoom = { factor: 1, middle: 0.5 };

/** The zoom after a change by `by` that keeps the value at fraction `at` of the visible section where it is. */
export function zoomedAt(zoom: AxisZoom, by: number, at: number): AxisZoom {
  const factor = Math.max(1, Math.min(MAX_ZOOM, zoom.factor * by));
  const value = zoom.middle + (at - 0.5) / zoom.factor;
  return within({ factor, middle: value - (at - 0.5) / factor });
}

/** The zoom moved by a fraction of the visible section. */
export function panned(zoom: AxisZoom, by: number): AxisZoom {
  return within({ factor: zoom.factor, middle: zoom.middle - by / zoom.factor });
}

function within({ factor, middle }: AxisZoom): AxisZoom {
  const half = 0.5 / factor;
  return { factor, middle: Math.max(half, Math.min(1 - half, middle)) };
}

/** The visible section of a domain. */
export function section([lower, upper]: Range, { factor, middle }: AxisZoom): Range {
  const width = upper - lower;
  return [lower + (middle - 0.5 / factor) * width, lower + (middle + 0.5 / factor) * width];
}

export interface ZoomActions {
  /** `by`: the change of the factor; `at`: the pointer in the element's pixels; `moved`: its movement in pixels. */
  zoom(by: number, at: readonly [number, number], moved: readonly [number, number]): void;
}

/** Listens for pinches and for the wheel with Ctrl. Other wheels scroll the page. */
export function listenForZoom(element: Element, actions: ZoomActions): void {
  const pixels = (x: number, y: number): [number, number] => {
    const { left, top } = element.getBoundingClientRect();
    return [x - left, y - top];
  };
  element.addEventListener("wheel", (event) => {
    const { ctrlKey, metaKey, deltaY, clientX, clientY } = event as WheelEvent;
    if (!ctrlKey && !metaKey) return;
    event.preventDefault();
    actions.zoom(Math.exp(-WHEEL_RATE * deltaY), pixels(clientX, clientY), [0, 0]);
  }, { passive: false });
  const touches = new Map<number, readonly [number, number]>();
  const measure = () => {
    const [a, b] = [...touches.values()];
    return { distance: Math.hypot(a[0] - b[0], a[1] - b[1]), middle: [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2] as const };
  };
  element.addEventListener("pointerdown", (event) => {
    const { pointerType, pointerId, clientX, clientY } = event as PointerEvent;
    if (pointerType === "touch") touches.set(pointerId, [clientX, clientY]);
  });
  element.addEventListener("pointermove", (event) => {
    const { pointerId, clientX, clientY } = event as PointerEvent;
    if (!touches.has(pointerId)) return;
    const before = touches.size === 2 ? measure() : null;
    touches.set(pointerId, [clientX, clientY]);
    if (!before || before.distance === 0) return;
    const after = measure();
    actions.zoom(after.distance / before.distance, pixels(...before.middle), [after.middle[0] - before.middle[0], after.middle[1] - before.middle[1]]);
  });
  for (const end of ["pointerup", "pointercancel", "pointerleave"]) element.addEventListener(end, (event) => touches.delete((event as PointerEvent).pointerId));
}
