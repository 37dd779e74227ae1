import { describe, expect, it, vi } from "vitest";
import { digits, fixed, percent, plain, quantity, seconds, suitedUnit } from "../src/base/format";
import { History } from "../src/base/history";
import { debounce } from "../src/base/debounce";
import { Sentences } from "../src/base/sentences";
import { EventReader } from "../src/contract/jobs";
import { heightDomain, radialDomain, widthDomain } from "../src/base/domains";

describe("numbers", () => {
  it("are short and have a true minus", () => {
    expect(digits(0.0123456)).toBe("0.0123");
    expect(digits(-1.5)).toBe("−1.5");
    expect(digits(1200000)).toBe("1200000");
    expect(digits(167312)).toBe("167000");
    expect(digits(0.00012345)).toBe("0.000123");
    expect(digits(2.5e8)).toBe("2.5e8");
    expect(digits(-1.25e-9)).toBe("−1.25e−9");
    expect(digits(3)).toBe("3");
    expect(digits(100)).toBe("100");
    expect(digits(NaN)).toBe("–");
    expect(fixed(-0.0001, 2)).toBe("0.00");
    expect(percent(0.0123)).toBe("1.2 %");
    expect([0.0321, 12.34, 125, 12_345].map(seconds)).toEqual(["32 ms", "12 s", "2 min 5 s", "3 h 25 min"]);
    expect(plain(0.1 + 0.2)).toBe("0.3");
  });
});

describe("sentences that wait to be said", () => {
  it("are the last of each topic, so that an outcome does not silence what led to it", () => {
    const waiting = new Sentences();
    waiting.set("outcome", "Young’s modulus 1.");
    waiting.set("change", "Crossing 2: strand 1 slides.");
    waiting.set("outcome", "Young’s modulus 2.");
    expect(waiting.take()).toBe("Crossing 2: strand 1 slides. Young’s modulus 2.");
    expect(waiting.take()).toBe("");
  });
});

describe("the history", () => {
  it("undoes and redoes, and a new step ends what could be redone", () => {
    const history = new History("a");
    history.push("b");
    history.push("c");
    expect([history.undo(), history.current]).toEqual([true, "b"]);
    expect([history.redo(), history.current]).toEqual([true, "c"]);
    history.undo();
    history.push("d");
    expect(history.redo()).toBe(false);
    expect([history.undo(), history.undo(), history.undo()]).toEqual([true, true, false]);
    expect(history.current).toBe("a");
  });

  it("amends the present without a step", () => {
    const history = new History(1);
    history.push(2);
    history.amend(3);
    history.undo();
    expect(history.current).toBe(1);
    history.redo();
    expect(history.current).toBe(3);
  });
});

describe("server-sent events", () => {
  it("are read from pieces that end anywhere", () => {
    const text = ': alive\n\nevent: progress\ndata: {"a":1}\n\nevent: finished\r\ndata: {"a":2}\r\n\r\n';
    for (const size of [1, 3, 7, 1000]) {
      const reader = new EventReader();
      const events = [];
      for (let k = 0; k < text.length; k += size) events.push(...reader.read(text.slice(k, k + size)));
      expect(events).toEqual([{ name: "progress", data: '{"a":1}' }, { name: "finished", data: '{"a":2}' }]);
    }
  });
});

describe("what a plot shows", () => {
  it("holds all values, zero, and room to drag into", () => {
    const [lower, upper] = heightDomain([0.5, 2, null]);
    expect(lower).toBeLessThan(0);
    expect(upper).toBeGreaterThan(2.4);
    expect(widthDomain([0, 1])[1]).toBeGreaterThan(1);
    expect(radialDomain("stiffness", [3, 5])[0]).toBe(0);
    expect(radialDomain("poisson", [0.2, 0.3])[0]).toBeLessThan(-0.1);
    for (const domain of [heightDomain([]), widthDomain([]), radialDomain("poisson", [])]) {
      expect(domain[1]).toBeGreaterThan(domain[0]);
    }
  });
});

describe("an action that waits for a pause", () => {
  it("runs once after the last request, at once when told, and never once cancelled", () => {
    vi.useFakeTimers();
    const action = vi.fn();
    const waiting = debounce(action, 100);
    waiting.schedule();
    vi.advanceTimersByTime(99);
    waiting.schedule();
    vi.advanceTimersByTime(99);
    expect(action).toHaveBeenCalledTimes(0);
    vi.advanceTimersByTime(1);
    expect(action).toHaveBeenCalledTimes(1);
    waiting.schedule();
    waiting.flush();
    vi.advanceTimersByTime(200);
    expect(action).toHaveBeenCalledTimes(2);
    waiting.schedule();
    waiting.cancel();
    vi.advanceTimersByTime(200);
    expect(action).toHaveBeenCalledTimes(2);
    vi.useRealTimers();
  });
});

describe("a value with its unit", () => {
  it("has the prefix that suits it", () => {
    expect(quantity(1.673e5, "N/m", 4)).toBe("167.3 kN/m");
    expect(quantity(2.5e7, "N/m")).toBe("25 MN/m");
    expect(quantity(0.00064, "MPa")).toBe("640 Pa");
    expect(quantity(35_000, "MPa")).toBe("35 GPa");
    expect(quantity(-0.002, "N")).toBe("−2 mN");
  });

  it("keeps an ordinary value, zero, and a unit without prefixes", () => {
    expect(quantity(2000, "MPa")).toBe("2000 MPa");
    expect(quantity(0, "N/m")).toBe("0 N/m");
    expect(quantity(20_000, "")).toBe("20000");
    expect(quantity(20_000, "mm")).toBe("20000 mm");
    expect(suitedUnit(0.5, "MPa")).toEqual({ unit: "MPa", factor: 1 });
  });
});
