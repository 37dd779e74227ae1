// Regions of a product, each with its own targets and its own design.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { DesignPage, withDesign } from "./design_page.mjs";
import { browser, closePage, picture, server, setUp, until } from "./harness.mjs";

setUp();

class RegionsPage extends DesignPage {
  get regions() {
    return this.page.getByRole("tablist", { name: "Regions of the product" }).getByRole("tab");
  }

  names() {
    return this.regions.locator(".tab-name").allTextContents();
  }

  inSight() {
    return this.regions.evaluateAll((all) => all.findIndex((tab) => tab.getAttribute("aria-selected") === "true"));
  }

  async divide() {
    await this.page.getByTitle("Divide the product into regions").click();
    await until(async () => (await this.regions.count()) === 2, "two regions");
  }

  async rename(name) {
    await this.page.getByRole("button", { name: "Rename this region" }).click();
    await this.page.getByLabel("Name of this region").fill(name);
    await this.page.keyboard.press("Enter");
  }

  /** The card's rows: name, family, deviation. */
  rows() {
    return this.page.locator(".regions-card li").evaluateAll((all) => all.map((row) => [...row.children].map((cell) => cell.textContent)));
  }
}

function withRegions(act, options) {
  return withDesign(act, { Kind: RegionsPage, ...options });
}

describe("regions of a product", () => {
  it("have targets and designs of their own, which are kept while another one is looked at", () =>
    withRegions(async (design, page) => {
      assert.ok(await page.locator(".regions-card").isHidden(), "one region needs no tabs");
      const last = (await design.handles.count()) - 1;
      const height = await design.pointHeight(last);
      const family = await design.family();
      const requests = page.designs.asked.length;
      await design.divide();
      assert.equal(await design.inSight(), 1);
      assert.equal(page.designs.asked.length, requests, "a copy is known already");
      assert.deepEqual((await design.rows()).map(([, found]) => found), [family, family]);
      await design.rename("Heel");
      await design.drag(last, 0, 150);
      await design.settled();
      assert.ok((await design.pointHeight(last)) < height);
      const [heel, values, parameter] = [await design.pointHeight(last), await design.values(), await page.locator(".parameters .number").first().inputValue()];
      await picture(page, "design-regions");
      const asked = page.designs.asked.length;
      await design.regions.first().click();
      await until(async () => (await design.pointHeight(last)) === height, "the first region's target");
      assert.notEqual(await page.locator(".parameters .number").first().inputValue(), parameter, "the first region's design");
      assert.equal(await page.locator(".design-page.outdated").count(), 0);
      await design.regions.first().focus();
      await page.keyboard.press("ArrowRight");
      await until(async () => (await design.pointHeight(last)) === heel, "the heel's target");
      assert.deepEqual(await design.values(), values);
      assert.equal(page.designs.asked.length, asked, "what is known is not asked for again");
      assert.deepEqual(await design.names(), ["Region 1", "Heel"]);
      // Undoing a step selects its region.
      await design.regions.first().click();
      await page.keyboard.press("Control+z");
      await until(async () => (await design.inSight()) === 1 && (await design.pointHeight(last)) === height, "the heel as it was");
      await design.settled();
      await page.getByRole("button", { name: "Remove this region" }).click();
      await until(async () => await page.locator(".tab-row.regions").isHidden(), "one region");
      await design.settled();
      assert.equal(await design.pointHeight(last), height);
      await page.keyboard.press("Control+z");
      await until(async () => (await design.regions.count()) === 2, "both again");
      await design.settled();
    }));

  it("are searched in one request, and are in the link and in what is copied", () =>
    withRegions(async (design, page) => {
      await design.divide();
      await design.rename("Midfoot");
      await page.getByLabel("Stiffness", { exact: true }).check();
      await page.locator(".plot.polar").waitFor();
      await design.settled();
      await page.getByTitle("Add a further region with a design of its own").click();
      await until(async () => (await design.regions.count()) === 3, "three regions");
      await design.rename("Heel");
      await page.getByTitle("Add a further target of the same design").click();
      await until(async () => (await page.locator(".target-errors li").count()) === 2, "two targets of the heel");
      await design.settled();
      await until(() => page.url().includes("region-tab=3"), "the link in the address");
      const theirs = await RegionsPage.open(browser, page.url());
      assert.deepEqual(await theirs.names(), ["Region 1", "Midfoot", "Heel"]);
      assert.equal(await theirs.inSight(), 2);
      assert.deepEqual((await theirs.rows()).map(([, , deviation]) => deviation).slice(0, 2), ["not known yet", "not known yet"]);
      const before = theirs.page.designs.asked.length;
      await theirs.button("Search all regions").click();
      await until(async () => (await theirs.rows()).every(([, , deviation]) => /%$/.test(deviation)), "the designs of all regions");
      assert.equal(theirs.page.designs.asked.length, before + 1);
      const request = theirs.page.designs.asked.at(-1);
      assert.deepEqual(request.regions.map((region) => [region.name, region.task, region.also?.length ?? 0]), [["Region 1", "stress_strain", 0], ["Midfoot", "stiffness", 0], ["Heel", "stiffness", 1]]);
      await theirs.settled();
      const [mine, same] = [await design.rows(), await theirs.rows()];
      mine.forEach((row, k) => assert.equal(row[1], same[k][1], "the same families are found one by one and all at once"));
      await picture(theirs.page, "design-regions-all");
      await theirs.regions.nth(1).click();
      await until(async () => (await theirs.curve("achieved")) !== "", "the midfoot's response");
      assert.equal(theirs.page.designs.asked.length, before + 1, "the answer had it");
      const menu = theirs.page.locator("main .menu", { has: theirs.page.locator("summary", { hasText: "Copy as" }) });
      await menu.locator("summary").click();
      await menu.getByText("Command line").click();
      const copied = JSON.parse(/<<'END'\n(.*)\nEND\n/.exec(await menu.locator("textarea").inputValue())[1]);
      assert.equal(copied.regions.length, 3);
      const answer = await fetch(`${server.url}/v1/designs`, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(copied) });
      assert.equal(answer.status, 200, "the server takes the request as it is");
      await menu.getByText("Python").click();
      assert.match(await menu.locator("textarea").inputValue(), /client\.design_regions\(regions/);
      await closePage(theirs.page);
    }));

  it("fit a small screen", () =>
    withRegions(async (design, page) => {
      await design.divide();
      await page.getByTitle("Add a further region").click();
      await until(async () => (await design.regions.count()) === 3, "three regions");
      await design.settled();
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "no scrolling to the side");
      const box = await design.regions.nth(2).boundingBox();
      assert.ok(box.x >= 0 && box.x + box.width <= 360, JSON.stringify(box));
      await picture(page, "design-regions-small");
    }, { viewport: { width: 360, height: 740 } }));
});
