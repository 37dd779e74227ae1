import { describe, expect, it } from "vitest";
import { MAX_ZOOM, panned, section, WHOLE, zoomedAt } from "../src/base/plot_zoom";

const within = ([lower, upper]: readonly [number, number], at: number) => lower + at * (upper - lower);

describe("the zoom of a plot", () => {
  it("keeps the value under the pointer where it is", () => {
    const domain = [-2, 6] as const;
    const before = within(section(domain, WHOLE), 0.3);
    const once = zoomedAt(WHOLE, 2, 0.3);
    const twice = zoomedAt(once, 1.5, 0.3);
    expect(within(section(domain, once), 0.3)).toBeCloseTo(before);
    expect(within(section(domain, twice), 0.3)).toBeCloseTo(before);
    expect(twice.factor).toBeCloseTo(3);
  });

  it("ends at the whole plot and at the largest factor", () => {
    expect(zoomedAt(zoomedAt(WHOLE, 8, 0.9), 0.01, 0.2)).toEqual(WHOLE);
    expect(zoomedAt(WHOLE, 1e6, 0.5).factor).toBe(MAX_ZOOM);
  });

  it("moves the visible section, and not beyond the ends", () => {
    const zoomed = zoomedAt(WHOLE, 4, 0.5);
    expect(section([0, 1], panned(zoomed, -0.5))).toEqual([0.5, 0.75]);
    expect(section([0, 1], panned(zoomed, -9))).toEqual([0.75, 1]);
    expect(panned(WHOLE, 0.3)).toEqual(WHOLE);
  });
});
