// A target that no material can have at rest: the nearest possible profile in the plot, and the sentence beside the verdict.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { DesignPage } from "./design_page.mjs";
import { browser, closePage, picture, server, setUp, until } from "./harness.mjs";

setUp();

const LEGEND = "Nearest that any material can have at rest";
const link = (points) => `${server.url}/#/design?task=stiffness&family=IH29&strain=0.02&points=${points}`;

describe("a target that no material can have at rest", () => {
  it("has the nearest possible profile in the plot, and a sentence beside the verdict, also while parameters are set by hand", async () => {
    // The solid of the model's data has a modulus of 34 MPa under plane strain.
    const design = await DesignPage.open(browser, link("0,200;0.8,200;1.6,200;2.4,200"));
    const { page } = design;
    const state = page.locator(".verdict-state");
    await until(async () => /^No material at rest comes nearer than 83 % to it\.$/.test(await state.textContent()), "the sentence");
    assert.match(await design.curve("bound"), /^M/);
    assert.equal(await page.locator(".legend li", { hasText: LEGEND }).count(), 1);
    await picture(page, "design-material-bound");
    const slider = page.locator('.parameters input[type="range"]').first();
    await slider.focus();
    await page.keyboard.press("ArrowRight");
    await design.settled();
    assert.match(await design.curve("bound"), /^M/, "the target is still the same");
    await closePage(page);
  });

  it("is one of few: a target that some material has shows neither", async () => {
    const design = await DesignPage.open(browser, link("0,1;0.8,1;1.6,1;2.4,1"));
    const { page } = design;
    assert.equal(await design.curve("bound"), "");
    assert.equal(await page.locator(".legend li", { hasText: LEGEND }).count(), 0);
    assert.doesNotMatch(await page.locator(".verdict-state").textContent(), /No material/);
    await closePage(page);
  });
});
