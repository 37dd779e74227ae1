// Ways out of a target that is missed: they are looked for in the background, shown as buttons, and made by one click.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { DesignPage } from "./design_page.mjs";
import { browser, closePage, picture, server, setUp, until } from "./harness.mjs";
import { answerWays, MISSED, refuseVerifications, WAY } from "./missed_target.mjs";

setUp();

describe("a target that is missed", () => {
  it("has ways out as buttons, of which one click makes the change as one step that can be undone", async () => {
    const design = await DesignPage.open(browser, server.url + "/" + MISSED);
    const { page } = design;
    await answerWays(page, [WAY]);
    await page.getByLabel("Check by itself").check();
    const way = page.getByRole("button", { name: WAY.sentence.replace(/\.$/, "") });
    await way.waitFor();
    assert.equal(await page.locator(".verdict-line").getAttribute("data-grade"), "missed");
    const asked = page.designs.asked.find((one) => one.effects?.ways_out === "on");
    assert.deepEqual([asked.priority, asked.session], ["background", undefined]);
    assert.equal(await page.getByRole("button", { name: /^Relax point/ }).count(), 0, "a point gives way only where nothing else helps");
    await picture(page, "design-ways-out");
    await way.click();
    assert.ok(await page.evaluate(() => document.querySelector(".verdict-line").contains(document.activeElement)), "the focus stays in the line of the verdict");
    await design.settled();
    const last = page.designs.asked.filter((one) => one.session).at(-1);
    assert.deepEqual([last.material, last.family], [{ youngs_modulus: 520 }, "IH29"]);
    await until(async () => (await way.count()) === 0, "the end of what is done");
    await design.button("Undo (Ctrl+Z)").click();
    await design.settled();
    await way.waitFor();
    await closePage(page);
  });

  it("has a control point that may give way where nothing else helps", async () => {
    // All points but the last are on the curve of the design.
    const asked = { task: "stress_strain", family: "IH29", parameters: [0.25], range: [0, 0.1], samples: 5 };
    const { x, y } = await (await fetch(`${server.url}/v1/profiles`, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(asked) })).json();
    const points = x.map((strain, k) => `${strain},${k === 4 ? 2 * y[k] : y[k]}`).join(";");
    const design = await DesignPage.open(browser, `${server.url}/#/design?task=stress_strain&family=IH29&direction=0&points=${points}&design=IH29&parameters=0.25`);
    const { page } = design;
    await answerWays(page, []);
    await page.getByLabel("Check by itself").check();
    await page.getByRole("button", { name: /^Relax point/ }).waitFor();
    assert.equal(await page.locator(".ways-out button:visible").count(), 0);
    await closePage(page);
  });

  it("is brought closer by what the server itself proposes", async () => {
    const design = await DesignPage.open(browser, server.url + "/" + MISSED);
    const { page } = design;
    await refuseVerifications(page);
    await page.getByLabel("Check by itself").check();
    const ways = page.locator(".ways-out button");
    await ways.first().waitFor();
    const before = await design.deviation();
    await ways.first().click();
    await design.settled();
    assert.ok((await design.deviation()) < 0.7 * before, `${await design.deviation()} % instead of ${before} %`);
    await closePage(page);
  });
});
