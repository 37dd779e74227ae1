// Walkthrough: a weave of one's own, from the first strand to the G-code of a sheet (docs/walkthroughs/weave.md).
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { browser, closePage, server, setUp, until } from "./harness.mjs";
import { PATIENCE_MS, savedFile, step, WINDOW } from "./walkthrough.mjs";
import { WeavePage } from "./weave_page.mjs";

setUp({ webgl: true });

describe("the walkthrough of a weave", () => {
  it("draws strands, lets one slide, pulls a sheet, and saves the G-code of a plan that was checked", async () => {
    const weave = await WeavePage.open(browser, server.url, "", WINDOW);
    const { page } = weave;
    await page.getByLabel("Pattern").selectOption("layout");
    await until(async () => (await weave.crossings.count()) === 1, "the first layout");
    await weave.button("Remove all").click();
    const draw = async (end, ...points) => {
      const before = await page.getByRole("button", { name: /^Remove strand/ }).count();
      await weave.button("Draw a strand").click();
      for (const [x, y] of points) await weave.clickAt(x, y);
      if (before === 0) await step(page, "weave-1-drawing");
      await weave.button(end).click();
      await until(async () => (await page.getByRole("button", { name: /^Remove strand/ }).count()) === before + 1, "the strand");
    };
    await draw("Goes on →", [1, 2], [6, 3.5]);
    await draw("Goes on →", [1, 8], [6, 6.5]);
    await draw("Goes on ↑", [2.5, 0.5]);
    await draw("Goes on ↑", [7.5, 0.5]);
    await until(async () => (await weave.crossings.count()) === 4, "four crossings");
    await weave.settled();
    await weave.crossings.first().click();
    await until(async () => /slides/.test(await weave.words(0)), "a strand that slides");
    await weave.settled();
    assert.match(await page.locator(".reading").textContent(), /^At 0°: Young’s modulus [\d.]+ kN\/m(?:\s±\s[\d.]+\s%)?, Poisson’s ratio/);
    await step(page, "weave-2-stiffness");

    await weave.button("Simulate").click();
    await page.locator(".sheet .facts").waitFor({ timeout: PATIENCE_MS });
    assert.match(await page.locator(".sheet .facts dt", { hasText: "Equilibrium" }).locator("+ dd").textContent(), /stable/);
    await step(page, "weave-3-sheet", page.locator(".sheet"));

    await weave.button("Print").click();
    const dialog = page.getByRole("dialog", { name: "Print the sheet" });
    await dialog.getByText("The checker has read the G-code and finds nothing wrong.").waitFor({ timeout: PATIENCE_MS });
    await step(page, "weave-4-print");
    const { name, bytes } = await savedFile(page, () => dialog.getByRole("button", { name: "Save G-code" }).click());
    assert.equal(name, "layout-sheet.gcode");
    const moves = bytes.toString().split("\n").filter((line) => /^G1 .*E/.test(line));
    assert.ok(moves.length > 500, `${moves.length} moves that print`);
    await closePage(page);
  });
});
