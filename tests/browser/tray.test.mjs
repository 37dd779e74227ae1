// The tray of jobs: on every page, with what runs and what has ended, also after a reload and while the server is gone.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { describe, it } from "node:test";
import { DesignPage } from "./design_page.mjs";
import { browser, closePage, heldJob, openPage, picture, server, setUp, until } from "./harness.mjs";
import { WeavePage } from "./weave_page.mjs";

const axe = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

setUp({ own: true, webgl: true });

const SHEET_MS = 120_000;
const WEAVE = "pattern=regular&type=1&pitch=4&radius=0.25&strain=0.1&sheet=columns:3,rows:3,load:shear,amount:0.3";

const summary = (page) => page.locator(".job-tray > summary");
const items = (page) => page.locator(".job-tray .jobs").first().locator("li");

/** A weave whose sheet is simulated by a job that never ends. */
async function withHeldSheet(act, options) {
  const weave = await WeavePage.open(browser, server.url, WEAVE, options);
  const { page } = weave;
  const job = await heldJob(page, "/v1/weave-simulations");
  job.tell(0.25, "load");
  await weave.button("Simulate").click();
  await until(async () => (await summary(page).textContent()) === "Jobs 1", "the count of the running job");
  await act(weave, page, job);
  await closePage(page);
}

describe("the tray of jobs", () => {
  it("is opened by keys, tells how far a job is, keeps the focus meanwhile, and cancels it", async () => {
    await withHeldSheet(async (weave, page, job) => {
      assert.match(await summary(page).getAttribute("aria-label"), /^Jobs: 1 running, \d+ ended$/);
      await summary(page).focus();
      await page.keyboard.press("Enter");
      await items(page).filter({ hasText: "Sheet under load" }).waitFor();
      const bar = items(page).first().locator("progress");
      assert.equal(await bar.evaluate((one) => one.value), 0.25);
      const cancel = page.getByRole("button", { name: "Cancel: Sheet under load" });
      await cancel.focus();
      job.tell(0.75, "load");
      await until(async () => (await bar.evaluate((one) => one.value)) === 0.75, "the progress");
      assert.ok(await cancel.evaluate((one) => one === document.activeElement), "the button is the same");
      const dismissal = page.waitForRequest((request) => request.method() === "DELETE" && request.url().endsWith("/v1/jobs/held"));
      await page.keyboard.press("Enter");
      await dismissal;
      await until(async () => (await items(page).filter({ hasText: "Sheet under load" }).count()) === 0, "the end of the row");
      assert.ok(await summary(page).evaluate((one) => one === document.activeElement), "the focus goes to the button of the tray");
      await page.keyboard.press("Escape");
      assert.equal(await page.locator(".job-tray").getAttribute("open"), null);
    });
  });

  it("is the same on the other pages, where a running job is shown by one click on its own", async () => {
    await withHeldSheet(async (weave, page) => {
      await page.getByRole("link", { name: "Mesh", exact: true }).click();
      await page.locator(".mesh-page").waitFor();
      await summary(page).click();
      await page.getByRole("button", { name: "Show: Sheet under load" }).click();
      await page.locator(".weave-page").waitFor();
      assert.equal(await page.locator(".job-tray").getAttribute("open"), null);
      await page.locator(".sheet .working").waitFor();
    });
  });

  it("keeps a job after a reload, and opens its result by one click, without computing it again", async () => {
    const weave = await WeavePage.open(browser, server.url, WEAVE.replace("columns:3,rows:3", "columns:6,rows:6"));
    const { page } = weave;
    await weave.button("Simulate").click();
    await until(async () => (await items(page).filter({ hasText: "Sheet under load", includeHidden: true }).count()) === 1, "the job");
    await page.goto(`${server.url}/#/design`);
    await page.reload();
    let asked = 0;
    page.on("request", (request) => (asked += request.method() === "POST" && request.url().endsWith("/v1/weave-simulations") ? 1 : 0));
    await summary(page).click();
    await items(page).filter({ hasText: /Sheet under load.*Ready/ }).waitFor({ timeout: SHEET_MS });
    assert.equal(await page.locator(".job-tray .job[data-state=successful] progress:visible").count(), 0, "bars end when the work ends");
    await picture(page, "tray");
    await page.getByRole("button", { name: "Open: Sheet under load" }).click();
    await page.locator(".weave-page .sheet .facts").waitFor({ timeout: SHEET_MS });
    assert.match(page.url(), /#\/weave\?.*columns:6/);
    assert.equal(asked, 0, "the result is that of the job");
    await closePage(page);
  });

  it("lists jobs that others have begun", async () => {
    const page = await openPage(browser, `${server.url}/#/mesh`);
    const job = { id: "elsewhere", kind: "voronoi-optimizations", state: "running", progress: 0.5, stage: "", priority: "normal", created: "2026-01-01T00:00:00Z", deadline: 600, remaining_seconds: 30 };
    await page.route("**/v1/jobs?*", (route) => route.fulfill({ status: 200, json: { jobs: [job] } }));
    await summary(page).click();
    const row = page.getByRole("list", { name: "Jobs begun elsewhere" }).locator("li");
    await row.waitFor();
    assert.match(await row.textContent(), /Optimization of the sites50 %, about 30 s left/);
    await closePage(page);
  });

  it("says that the server does not answer, and later that it was started again", async () => {
    await withHeldSheet(async (weave, page) => {
      await summary(page).click();
      const notice = page.locator(".job-tray .note");
      await page.route("**/v1/**", (route) => route.abort());
      await server.stop();
      await notice.getByText("The server does not answer").waitFor();
      await new Promise((resolve) => setTimeout(resolve, 11_000)); // starts that are nearer to each other count as one
      await server.run();
      await notice.getByText(/The server was started again at \d\d:\d\d/).waitFor();
    });
  });

  for (const colorScheme of ["light", "dark"]) {
    it(`fits a screen of 390 pixels, and keeps the rules of accessibility, in ${colorScheme} colours`, async () => {
      await withHeldSheet(async (weave, page) => {
        await summary(page).click();
        await items(page).filter({ hasText: "Sheet under load" }).waitFor();
        const box = await page.locator(".job-tray .menu-body").boundingBox();
        assert.ok(box.x >= 0 && box.x + box.width <= 390, JSON.stringify(box));
        assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "no scrolling to the side");
        await page.evaluate(axe);
        const { violations } = await page.evaluate(() => window.axe.run(document.querySelector("header"), { resultTypes: ["violations"] }));
        assert.deepEqual(violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 120)).join("; ")}`), []);
        await picture(page, `tray-390-${colorScheme}`);
      }, { viewport: { width: 390, height: 844 }, colorScheme, reducedMotion: "reduce" });
    });
  }
});

describe("a verification", () => {
  it("that was cancelled in the tray does not begin again by itself", async () => {
    const link = "#/design?task=stress_strain&family=IH29&direction=0&points=0,0;0.02,0.004;0.04,0.008&design=IH29&parameters=0.25";
    const design = await DesignPage.open(browser, `${server.url}/${link}`);
    const { page } = design;
    const job = await heldJob(page, "/v1/designs", (request) => request.postDataJSON()?.verify === true);
    job.tell(0.4, "simulating");
    await design.button("Verify").click();
    await summary(page).click();
    await page.getByRole("button", { name: /^Cancel: Verification by simulation/ }).click();
    await page.unroute("**/v1/jobs/held");
    await page.route("**/v1/jobs/held", (route) => route.fulfill({ status: 410, contentType: "application/problem+json", json: { type: "", title: "", status: 410, detail: "", code: "job.dismissed" } }));
    await until(async () => !/Checking/.test(await page.locator(".verdict-state").textContent()), "the end of it");
    await design.button("Verify").waitFor();
    await closePage(page);
  });
});
