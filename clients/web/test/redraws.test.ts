import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { Observable } from "../src/base/observable";
import { Redraws } from "../src/base/redraws";

const FRAME_MS = 16;

describe("redraws of a card", () => {
  beforeEach(() => {
    vi.useFakeTimers();
    vi.stubGlobal("requestAnimationFrame", (draw: () => void) => setTimeout(draw, FRAME_MS));
  });
  afterEach(() => {
    vi.unstubAllGlobals();
    vi.useRealTimers();
  });

  function card() {
    const drag = { isUnderWay: false };
    const parts = [new Observable(0), new Observable(0)] as const;
    const drawn: string[] = [];
    new Redraws(() => drag.isUnderWay).follow(parts, () => drawn.push(parts.map((part) => part.get()).join()));
    return { drag, parts, drawn };
  }

  it("take place at once, and then once before a repaint however many values have changed", () => {
    const { parts: [first, second], drawn } = card();
    expect(drawn).toEqual(["0,0"]);
    first.set(1);
    second.set(2);
    first.set(3);
    expect(drawn).toEqual(["0,0"]);
    vi.advanceTimersByTime(FRAME_MS);
    expect(drawn).toEqual(["0,0", "3,2"]);
    vi.advanceTimersByTime(1000);
    expect(drawn).toHaveLength(2);
  });

  it("wait while something is dragged, for a while only, and no longer than until it is released", () => {
    const { drag, parts: [first], drawn } = card();
    drag.isUnderWay = true;
    first.set(1);
    vi.advanceTimersByTime(100);
    first.set(2);
    expect(drawn).toEqual(["0,0"]);
    vi.advanceTimersByTime(50 + FRAME_MS);
    expect(drawn).toEqual(["0,0", "2,0"]);
    first.set(3);
    drag.isUnderWay = false;
    first.set(4);
    vi.advanceTimersByTime(FRAME_MS);
    expect(drawn).toEqual(["0,0", "2,0", "4,0"]);
    vi.advanceTimersByTime(1000);
    expect(drawn).toHaveLength(3);
  });
});
