import { describe, expect, it } from "vitest";
import { TERMS, termQuestion } from "../src/base/terms";
import { isTouch, tapped, touchWords } from "../src/base/touch_words";
import { cellText, editedPoint } from "../src/design/value_table";
import { familiesWithWords, parameterWords } from "../src/design/parameter_words";
import { largestState } from "../src/design/patch_stress";
import { STARTS, WELCOME_SENTENCE, WELCOME_STARTS } from "../src/design/starts";

describe("words for a first visit", () => {
  it("name each parameter of each family, and say what it does", () => {
    expect(Object.fromEntries(familiesWithWords())).toEqual({ IH01: 4, IH21: 2, IH22: 3, IH28: 2, IH29: 1, IH50: 2, IH67: 2 });
    for (const [family, count] of familiesWithWords()) {
      const words = Array.from({ length: count }, (_, k) => parameterWords(family, k));
      expect(new Set(words.map(({ name }) => name)).size, family).toBe(count);
      for (const { name, help } of words) {
        expect(name).not.toMatch(/parameter/i);
        expect(help, `${family}, ${name}`).toMatch(/^[A-Z].*\.$/);
      }
    }
  });

  it("fall back to what a definition says for a family that has none, or to the number", () => {
    expect(parameterWords("IH99", 2, "Slant of the sides")).toEqual({ name: "Slant of the sides", help: "" });
    expect(parameterWords("IH99", 2)).toEqual({ name: "Parameter 3", help: "" });
  });

  it("ask for several terms with one question", () => {
    expect(termQuestion(["strain"])).toBe("What is meant by “Strain”?");
    expect(termQuestion(["stress", "stiffness", "poisson"])).toBe("What is meant by “Stress”, “Stiffness” and “Poisson’s ratio”?");
  });

  it("define each term in sentences", () => {
    for (const { name, definition } of Object.values(TERMS)) expect(definition, name).toMatch(/^[A-Z].{30,220}\.$/);
  });

  it("offer three examples that there are", () => {
    expect(WELCOME_SENTENCE).toMatch(/^[A-Z][^.]*\.$/);
    expect(WELCOME_STARTS).toHaveLength(3);
    for (const name of WELCOME_STARTS) expect(STARTS.map((start) => start.name)).toContain(name);
  });
});

describe("words for fingers", () => {
  it("say tap for click, in each of its forms", () => {
    expect(tapped("Click a crossing; a click on it, clicked twice or double-clicked by clicking.")).toBe("Tap a crossing; a tap on it, tapped twice or double-tapped by tapping.");
  });

  it("stay as they are with a mouse", () => {
    expect(isTouch()).toBe(false);
    expect(touchWords("Click here.")).toBe("Click here.");
  });
});

describe("a cell of the table of control points", () => {
  it("changes its own column alone", () => {
    expect(editedPoint(false, [0.1, 2], 1, "3")).toEqual([0.1, 3]);
    expect(editedPoint(false, [0.1, 2], 0, "0.2")).toEqual([0.2, 2]);
    expect(editedPoint(true, [1, 2], 0, "90")).toEqual([Math.PI / 2, 2]);
    expect(editedPoint(true, [1, 2], 1, "3")).toEqual([1, 3]);
    for (const text of ["", " ", "three"]) expect(editedPoint(true, [1, 2], 1, text)).toBeNull();
  });

  it("shows directions in degrees", () => {
    expect(cellText(true, [Math.PI / 4, 1.23456789], 0)).toBe("45");
    expect(cellText(true, [Math.PI / 4, 1.23456789], 1)).toBe("1.23457");
    expect(cellText(false, [0.1, 1], 0)).toBe("0.1");
  });
});

describe("a simulated load", () => {
  it("opens at the state that is farthest from rest", () => {
    expect(largestState([-0.2, -0.1, 0, 0.1])).toBe(0);
    expect(largestState([-0.1, 0, 0.1, 0.3])).toBe(3);
    expect(largestState([-0.2, 0, 0.2])).toBe(2);
    expect(largestState([])).toBe(0);
  });
});
