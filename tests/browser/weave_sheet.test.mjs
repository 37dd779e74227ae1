// Sheets of the weave page: simulation, 3D view, and files.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { browser, closePage, picture, server, setUp, until } from "./harness.mjs";
import { saved, WeavePage } from "./weave_page.mjs";

setUp({ webgl: true });

const fact = (page, term) => page.locator(".sheet .facts dt", { hasText: term }).locator("+ dd").textContent();

describe("a sheet under load", () => {
  it("is simulated with the crossings that were changed, looked at state by state, and saved", async () => {
    const weave = await WeavePage.open(browser, server.url, "pattern=regular&type=1&pitch=4&radius=0.25&strain=0.1&sheet=3,3,shear,0.3");
    const { page } = weave;
    await weave.crossings.first().click();
    await until(async () => /slides/.test(await weave.words(0)), "a changed crossing");
    // The cards above grow with their answer, and would move the button away while it is pressed.
    await weave.settled();
    const asked = page.waitForRequest((request) => request.url().endsWith("/v1/weave-simulations"));
    await weave.button("Simulate").click();
    const request = (await asked).postDataJSON();
    assert.equal(request.weave.overrides.length, 9, "one crossing of each cell");
    await page.locator(".sheet .facts").waitFor();
    assert.equal(await fact(page, "Shear"), "30 %");
    const force = await fact(page, "Force");
    await page.locator(".sheet").scrollIntoViewIfNeeded();
    await picture(page, "weave-sheet");
    await weave.enter("State along the load", 4);
    assert.equal(await fact(page, "Shear"), "15 %");
    assert.notEqual(await fact(page, "Force"), force);
    assert.match((await saved(page, () => weave.button("OBJ").click())).text, /^(#.*\n)*v /);
    const vtu = await saved(page, () => weave.button("VTU").click());
    assert.match(vtu.text, /UnstructuredGrid/);
    assert.equal(vtu.name, "sheet-4.vtu");
    await weave.enter("How far, in shares of the sheet", 0.1);
    await page.locator(".sheet .note", { hasText: "changed since" }).waitFor();
    await weave.settled();
    await closePage(page);
  });

  it("of strands that were drawn is tiled from their cell", async () => {
    const weave = await WeavePage.open(browser, server.url);
    const { page } = weave;
    await page.getByLabel("Pattern").selectOption("layout");
    await until(async () => (await weave.crossings.count()) === 1, "the first layout");
    await weave.settled();
    await weave.button("Simulate").click();
    await page.locator(".sheet .facts").waitFor();
    assert.equal(await page.locator(".sheet .notes .note").count(), 0);
    assert.match(await fact(page, "Equilibrium"), /stable/);
    await picture(page, "weave-layout");
    await closePage(page);
  });
});
