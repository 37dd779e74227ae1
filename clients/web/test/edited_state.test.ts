import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { EditedState } from "../src/base/edited_state";
import { StateLink } from "../src/base/state_link";

interface Drawing {
  readonly x: number;
  readonly name: string;
}

const START: Drawing = { x: 0, name: "" };
const newState = () => new EditedState<Drawing>(START);

describe("an edited state", () => {
  it("makes one step of a change with intermediate states", () => {
    const edited = newState();
    expect([edited.beginChange(), edited.beginChange()]).toEqual([true, false]);
    for (const x of [1, 2, 3]) edited.change({ x });
    expect(edited.endChange()).toBe(true);
    edited.push();
    expect(edited.endChange()).toBe(false);
    expect(edited.state.get()).toEqual({ x: 3, name: "" });
    edited.undo((state) => edited.state.set(state));
    expect(edited.state.get()).toBe(START);
    expect(edited.steps.get()).toEqual({ undo: false, redo: true });
    edited.redo((state) => edited.state.set(state));
    expect(edited.state.get().x).toBe(3);
  });

  it("takes what was amended into the present step, but not while a change is under way", () => {
    const edited = newState();
    edited.change({ x: 1 });
    edited.push();
    edited.amend({ x: 1, name: "found" });
    edited.beginChange();
    edited.amend({ x: 1.5, name: "on the way" });
    edited.change({ x: 2 });
    edited.endChange();
    edited.push();
    edited.undo((state) => edited.state.set(state));
    expect(edited.state.get()).toEqual({ x: 1, name: "found" });
  });

  it("tells of a step once the state is restored", () => {
    const edited = newState();
    edited.change({ x: 1 });
    edited.push();
    const seen: number[] = [];
    edited.steps.watch(() => seen.push(edited.state.get().x));
    edited.undo((state) => edited.state.set(state));
    expect(seen).toEqual([1, 0]);
  });
});

describe("the link of a state", () => {
  beforeEach(() => void vi.useFakeTimers());
  afterEach(() => void vi.useRealTimers());

  function linked(isReady: () => boolean) {
    const edited = newState();
    const written: string[] = [];
    const text = { write: ({ x }: Drawing) => (x < 10 ? `x=${x}` : ""), read: (link: string) => (link.startsWith("x=") ? { ...START, x: Number(link.slice(2)) } : null) };
    return { edited, written, link: new StateLink({ write: (link) => void written.push(link) }, edited, text, isReady) };
  }

  it("is written after a pause, at once with a step, and not before there is anything to share", () => {
    let ready = false;
    const { edited, written } = linked(() => ready);
    edited.change({ x: 1 });
    vi.advanceTimersByTime(1000);
    expect(written).toEqual([]);
    ready = true;
    for (const x of [2, 3]) edited.change({ x });
    expect(written).toEqual([]);
    vi.advanceTimersByTime(1000);
    expect(written).toEqual(["x=3"]);
    edited.change({ x: 4 });
    edited.push();
    expect(written).toEqual(["x=3", "x=4"]);
  });

  it("is not written during a drag, but with the step that ends it", () => {
    const { edited, written } = linked(() => true);
    vi.advanceTimersByTime(1000);
    written.length = 0;
    edited.beginChange();
    edited.change({ x: 5 });
    vi.advanceTimersByTime(1000);
    expect(written).toEqual([]);
    edited.endChange();
    edited.push();
    expect(written).toEqual(["x=5"]);
  });

  it("is followed if it has another state; otherwise the address shows the present one again", () => {
    const { link, written } = linked(() => false);
    expect(link.follow("x=5")).toEqual({ x: 5, name: "" });
    expect(written).toEqual([]);
    for (const text of ["", "x=0", "nonsense"]) expect(link.follow(text)).toBeNull();
    expect(written).toEqual(["x=0", "x=0", "x=0"]);
  });
});
