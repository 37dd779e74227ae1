// Walkthrough: an auxetic target that is missed, what the page says of it, and a way out (docs/walkthroughs/auxetic.md).
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { DesignPage } from "./design_page.mjs";
import { browser, closePage, server, setUp, until } from "./harness.mjs";
import { PATIENCE_MS, step, WINDOW } from "./walkthrough.mjs";

setUp({ models: ["ih28.h5", "ih29.h5"] });

/** A sheet that becomes wider when it is pulled along 0 or 90 degrees. The family can do that, but along 20 degrees. */
const LINK = "#/design?task=poisson&family=IH28&strain=0.02&points=0,-0.57;0.2618,-0.02;0.5236,0.47;0.7854,0.61;1.0472,0.56;1.309,0.21;" +
  "1.5708,-0.57;1.8326,-0.02;2.0944,0.47;2.3562,0.61;2.618,0.56;2.8798,0.21";

describe("the walkthrough of an auxetic target", () => {
  it("is told that the target is missed, and turns the structure by one click", async () => {
    const design = await DesignPage.open(browser, `${server.url}/${LINK}`, WINDOW);
    const { page } = design;
    const verdict = page.locator(".verdict-words");
    const grade = () => page.locator(".verdict-line").getAttribute("data-grade");
    await design.settled(PATIENCE_MS);
    assert.equal(await grade(), "missed");
    const missedBy = await design.deviation();
    assert.ok(missedBy > 15, `${missedBy} %`);
    assert.equal(await page.locator(".result .chip.good").count(), 0, "no green on a target that is missed");
    await step(page, "auxetic-1-missed");

    await page.getByLabel("Check by itself").check();
    const ways = page.locator(".ways-out button");
    await ways.first().waitFor({ timeout: PATIENCE_MS });
    await step(page, "auxetic-2-ways-out", page.locator(".plot-card"));
    const turn = ways.filter({ hasText: /^Turn/ }).first();
    await turn.click();
    await until(async () => (await grade()) !== "missed" && (await grade()) !== "", "a target that is not missed", PATIENCE_MS);
    await design.settled(PATIENCE_MS);
    assert.ok((await design.deviation()) < missedBy / 2, `${await design.deviation()} % instead of ${missedBy} %`);
    await until(async () => /^Simulated: /.test(await verdict.textContent()), "the simulation", PATIENCE_MS);
    await step(page, "auxetic-3-turned");
    await closePage(page);
  });
});
