// Running work can be cancelled while its progress is updated.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { DesignPage } from "./design_page.mjs";
import { browser, closePage, heldJob, server, setUp, until } from "./harness.mjs";
import { WeavePage } from "./weave_page.mjs";

setUp();

/** Checks that the cancel button keeps the focus while the progress goes from 1/4 to 3/4, and that a key then cancels the work. */
async function stopsWhileItGoesOn(page, job, card) {
  const row = page.locator(card).locator(".working");
  const reached = (share) => until(async () => (await row.count()) === 1 && (await row.locator("progress").evaluate((bar) => bar.value)) === share, `progress of ${share}`);
  await reached(0.25);
  const cancel = await row.getByRole("button", { name: "Cancel" }).elementHandle();
  await cancel.focus();
  for (const share of [0.5, 0.75]) {
    job.tell(share, `at ${share}`);
    await reached(share);
    assert.equal(await cancel.evaluate((button) => button.isConnected && button === document.activeElement), true, "the button is the same and keeps its focus");
  }
  await page.keyboard.press("Enter");
  await until(async () => (await row.count()) === 0, "the end of the work");
  await closePage(page);
}

describe("the button that stops work stays while its progress changes", () => {
  it("of a search for a design", async () => {
    const design = await DesignPage.open(browser, server.url);
    const job = await heldJob(design.page, "/v1/designs", (request) => request.postDataJSON()?.effects?.multi_start !== "off");
    job.tell(0.25, "starts");
    await design.drag(await design.movable(), 0, -30);
    await stopsWhileItGoesOn(design.page, job, ".plot-card");
  });

  it("of a weave’s stiffness over direction", async () => {
    const weave = await WeavePage.open(browser, server.url);
    const job = await heldJob(weave.page, "/v1/weave-homogenizations", (request) => !request.postDataJSON().deformed);
    job.tell(0.25, "directions");
    await weave.enter("Strain along each direction", 0.07);
    await stopsWhileItGoesOn(weave.page, job, ".profile");
  });

  it("of a sheet under load", async () => {
    const weave = await WeavePage.open(browser, server.url);
    const job = await heldJob(weave.page, "/v1/weave-simulations");
    job.tell(0.25, "load");
    await weave.button("Simulate").click();
    await stopsWhileItGoesOn(weave.page, job, ".sheet");
  });
});
