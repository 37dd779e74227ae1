// Several targets of one design: adding, selecting, renaming and removing tabs, and the updates that follow.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { DesignPage, number, withDesign } from "./design_page.mjs";
import { browser, closePage, picture, server, setUp, until } from "./harness.mjs";
import { saved } from "./weave_page.mjs";

setUp();

class TargetsPage extends DesignPage {
  get tabs() {
    return this.page.getByRole("tablist", { name: "Targets of the design" }).getByRole("tab");
  }

  async names() {
    return this.tabs.locator(".tab-name").allTextContents();
  }

  async inSight() {
    return this.tabs.evaluateAll((all) => all.findIndex((tab) => tab.getAttribute("aria-selected") === "true"));
  }

  async add() {
    const count = await this.tabs.count();
    await this.page.getByTitle("Add a further target of the same design").click();
    await until(async () => (await this.tabs.count()) === count + 1, "a further tab");
    await this.settled();
  }

  /** The deviations in the card of the result, in per cent. */
  async deviations() {
    return (await this.page.locator(".target-errors li strong").allTextContents()).map(number);
  }
}

function withTargets(act, options) {
  return withDesign(act, { Kind: TargetsPage, ...options });
}

describe("several targets", () => {
  it("are tabs, each with a curve of its own, asked for in one request", () =>
    withTargets(async (design, page) => {
      assert.deepEqual(await design.names(), ["Stress, 0°"]);
      assert.equal(await page.locator(".target-errors").count(), 0, "one target needs no list");
      const last = (await design.handles.count()) - 1;
      const first = await design.pointHeight(last);
      await design.add();
      assert.deepEqual(await design.names(), ["Stress, 0°", "Stress, 90°"]);
      assert.equal(await design.inSight(), 1);
      // The first design responds alike after a quarter turn, so that a direction between is needed for different targets.
      await page.getByLabel("Direction of the load, °, as a number").fill("30");
      await page.keyboard.press("Enter");
      await until(async () => (await design.names())[1] === "Stress, 30°", "the other direction");
      await design.settled();
      const asked = page.designs.asked.at(-1);
      assert.equal(asked.direction.toFixed(4), (Math.PI / 6).toFixed(4), "what is in sight comes first");
      assert.deepEqual(asked.also.map((target) => [target.task, target.direction]), [["stress_strain", 0]]);
      const [heights, deviations] = [[await design.pointHeight(last)], await design.deviations()];
      assert.equal(deviations.length, 2);
      // A dragged point changes the selected target only, and the design follows both targets.
      const answered = page.designs.answered;
      await design.drag(last, 0, 120, () => until(() => page.designs.answered > answered, "an answer while dragging"));
      await design.settled();
      assert.ok(page.designs.asked.slice(-3).every((request) => request.also.length === 1), "each request has both");
      heights.push(await design.pointHeight(last));
      assert.ok(heights[1] < heights[0]);
      const apart = await design.deviations();
      assert.ok(Math.max(...apart) > Math.max(...deviations), `targets that contradict each other are met less well: ${apart}`);
      const [target, achieved, values] = [await design.curve("target"), await design.curve("achieved"), await design.values()];
      await picture(page, "design-targets");
      // Selecting another tab shows its curve and sends no request.
      const requests = page.designs.asked.length;
      await design.tabs.first().click();
      await until(async () => (await design.curve("target")) !== target, "the curve of the first target");
      assert.equal(await design.inSight(), 0);
      assert.notEqual(await design.curve("achieved"), achieved);
      assert.equal(await design.pointHeight(last), first);
      assert.equal(await page.locator(".design-page.outdated").count(), 0, "what is known of it is of now");
      assert.equal(page.designs.asked.length, requests, "to look at a target asks for nothing");
      // Keys select tabs, too.
      await design.tabs.first().focus();
      await page.keyboard.press("ArrowRight");
      await until(async () => (await design.inSight()) === 1 && (await design.pointHeight(last)) === heights[1], "the second target again");
      assert.deepEqual(await design.values(), values);
      assert.equal(await page.evaluate(() => document.activeElement.getAttribute("role")), "tab");
      assert.equal(page.designs.asked.length, requests);
    }));

  it("may be of different kinds and weigh more or less, and each verdict is told", () =>
    withTargets(async (design, page) => {
      await design.add();
      await page.getByLabel("Poisson’s ratio", { exact: true }).check();
      await page.locator(".plot.polar").waitFor();
      await design.settled();
      assert.deepEqual(await design.names(), ["Stress, 0°", "Poisson’s ratio, at 0.05"]);
      await page.getByLabel("Weight beside the other targets, as a number").fill("4");
      await page.keyboard.press("Enter");
      await until(() => page.designs.asked.at(-1).weight === 4, "a search with the weight");
      await design.settled();
      assert.deepEqual([page.designs.asked.at(-1).task, page.designs.asked.at(-1).also[0].task], ["poisson", "stress_strain"]);
      const list = await page.locator(".target-errors li").allTextContents();
      assert.match(list[0], /^Stress, 0°(reached|close|not certain|missed)[\d.]+ %$/);
      assert.match(list[1], /^Poisson’s ratio, at 0.05(reached|close|not certain|missed)[\d.]+ %$/);
      const [first, second] = await design.deviations();
      const overall = number(await page.locator(".overall strong").textContent());
      assert.ok(Math.abs(overall - Math.sqrt((first ** 2 + 4 * second ** 2) / 5)) < 0.06 * overall + 0.01, `${overall} of ${first} and ${second}`);
      assert.ok((await page.locator(".ranking li:visible").count()) >= 2, "a ranking for both targets");
      const other = await page.locator(".rank:not([aria-current]) .rank-name").first().textContent();
      await page.getByRole("button", { name: `Overlay the curve of ${other}` }).click();
      await until(async () => (await page.locator(".plot.polar .curve.pin").count()) === 1, "its curve over directions");
      await design.tabs.first().click();
      await until(async () => (await page.locator(".plot.cartesian .curve.pin").count()) === 1, "its curve over strain");
      const table = await design.values();
      assert.ok(table.length > 5);
      assert.doesNotMatch(await page.locator('[aria-label="Values of the curves"]').textContent(), /e−/, "what rounding left of 0 is 0");
      assert.match(await page.locator("caption", { hasText: "Control points" }).textContent(), /of the target Stress, 0°/);
      assert.ok((await page.locator(".ranking li:visible").count()) >= 2, "the ranking is for both, whichever is in sight");
    }));

  it("are named and taken away, which can be undone step by step", () =>
    withTargets(async (design, page) => {
      await design.add();
      await page.getByRole("button", { name: "Rename this target" }).click();
      await page.getByLabel("Name of this target").fill("Across the grain");
      const requests = page.designs.asked.length;
      await page.keyboard.press("Enter");
      assert.deepEqual(await design.names(), ["Stress, 0°", "Across the grain"]);
      await page.keyboard.press("F2");
      await page.getByLabel("Name of this target").fill("Something else");
      await page.keyboard.press("Escape");
      assert.deepEqual(await design.names(), ["Stress, 0°", "Across the grain"], "Escape keeps the name");
      assert.equal(page.designs.asked.length, requests, "a name is no reason to search");
      const last = (await design.handles.count()) - 1;
      await design.drag(last, 0, 60);
      await design.settled();
      const height = await design.pointHeight(last);
      await design.tabs.first().click();
      await page.getByRole("button", { name: "Remove this target" }).click();
      await until(async () => (await design.tabs.count()) === 1, "one tab");
      await design.settled();
      assert.deepEqual(await design.names(), ["Across the grain"]);
      assert.equal(await design.pointHeight(last), height);
      assert.equal(page.designs.asked.at(-1).also, undefined);
      assert.ok(await page.getByRole("button", { name: "Remove this target" }).isHidden(), "the only target stays");
      await page.keyboard.press("Control+z");
      await until(async () => (await design.tabs.count()) === 2, "both tabs");
      await design.settled();
      assert.deepEqual(await design.names(), ["Stress, 0°", "Across the grain"]);
      // The undone step belongs to the other tab, so that this tab is selected.
      await page.keyboard.press("Control+z");
      await until(async () => (await design.inSight()) === 1 && (await design.pointHeight(last)) > height, "the point where it was");
      await design.settled();
      await page.keyboard.press("Control+z");
      assert.deepEqual(await design.names(), ["Stress, 0°", "Stress, 90°"]);
      await page.keyboard.press("Control+z");
      await until(async () => (await design.tabs.count()) === 1, "the target that was there first");
      await design.settled();
      await page.keyboard.press("Control+Shift+z");
      await until(async () => (await design.tabs.count()) === 2, "the further one again");
      await design.settled();
      assert.equal((await design.deviations()).length, 2);
    }));

  it("are in the link, in a pin, in what is copied and in the file", () =>
    withTargets(async (design, page) => {
      await page.getByLabel("Family of tilings").selectOption("IH67");
      await until(async () => (await design.family()) === "IH67", "a design of IH67");
      await design.settled();
      await design.add();
      await page.getByRole("button", { name: "Rename this target" }).click();
      await page.getByLabel("Name of this target").fill("Up & down");
      await page.keyboard.press("Enter");
      await until(() => page.url().includes("tab=2"), "the link in the address");
      const theirs = await TargetsPage.open(browser, page.url());
      assert.deepEqual(await theirs.names(), ["Stress, 0°", "Up & down"]);
      assert.equal(await theirs.inSight(), 1);
      const [mine, same] = [await design.deviations(), await theirs.deviations()];
      mine.forEach((deviation, k) => assert.ok(Math.abs(deviation - same[k]) <= 0.05 * deviation + 0.02, `${mine} and ${same}`));
      await closePage(theirs.page);
      const menu = page.locator("main .menu", { has: page.locator("summary", { hasText: "Copy as" }) });
      await menu.locator("summary").click();
      await menu.getByText("Command line").click();
      const command = await menu.locator("textarea").inputValue();
      const request = JSON.parse(/<<'END'\n(.*)\nEND\n/.exec(command)[1]);
      assert.deepEqual([request.direction, request.also.length], [0, 1]);
      const answer = await fetch(`${server.url}/v1/designs`, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(request) });
      assert.equal(answer.status, 200, "the server takes the request as it is");
      assert.equal((await answer.json()).also.length, 1);
      await menu.getByText("Python").click();
      assert.match(await menu.locator("textarea").inputValue(), /also = \[\n {4}supple\.Target\("stress_strain"[\s\S]*client\.design\(target, also=also/);
      await page.keyboard.press("Escape");
      await page.locator("main .menu summary", { hasText: "Export" }).click();
      const document = JSON.parse((await saved(page, () => page.getByText("Data (JSON)").click())).text);
      assert.deepEqual([document.name, document.also.length], ["Up & down", 1]);
      // Restoring a pin restores all targets.
      await design.button("Pin").click();
      await page.locator(".pins li").waitFor();
      await page.getByRole("button", { name: "Remove this target" }).click();
      await until(async () => (await design.tabs.count()) === 1, "one tab");
      await design.settled();
      await page.getByRole("button", { name: /^Go back to IH67/ }).click();
      await until(async () => (await design.names()).join() === "Stress, 0°,Up & down", "both targets");
      await design.settled();
    }));

  it("show what parameters set by hand do about each", () =>
    withTargets(async (design, page) => {
      await design.add();
      await page.getByLabel("Poisson’s ratio", { exact: true }).check();
      await page.locator(".plot.polar").waitFor();
      await design.settled();
      const before = await design.deviations();
      await page.locator(".parameters .number").first().fill("0.11");
      await page.keyboard.press("Enter");
      await until(async () => (await page.locator(".result .chip").textContent()) === "Set by hand", "word of it");
      const by = await design.deviations();
      assert.ok(by.every((deviation, k) => deviation > before[k]), `${by} after ${before}`);
      const curve = await design.curve("achieved");
      await design.tabs.first().click();
      await until(async () => (await design.curve("achieved")) !== curve && (await design.curve("achieved")) !== "", "the other profile");
      assert.equal(await page.locator(".result .chip").textContent(), "Set by hand");
      assert.ok((await design.values()).every(([strain]) => Math.abs(strain) <= 0.2), "a profile over strain");
    }));

  it("are simulated together, and each shows its own simulated curve", async () => {
    // The strains are small, because their simulation is quick.
    const target = (suffix, direction) => `task${suffix}=stress_strain&direction${suffix}=${direction}&points${suffix}=0,0;0.02,0.004;0.04,0.008`;
    const design = await TargetsPage.open(browser, `${server.url}/#/design?${target("", 0)}&${target("2", 0.5)}&tab=2&family=IH29&design=IH29&parameters=0.25`);
    const { page } = design;
    await design.button("Verify by simulation").click();
    await page.locator(".verdict").waitFor({ timeout: 150_000 });
    const words = await page.locator(".verdict").textContent();
    assert.match(words, /from the targets \(rms\).*Of the target in sight the simulation and the model differ by/);
    assert.ok((await page.locator(".plot .verified path").count()) >= 2);
    const place = () => page.locator(".plot .verified path").last().getAttribute("transform");
    const last = await place();
    const asked = page.designs.asked.length;
    assert.deepEqual([page.designs.asked.at(-1).verify, page.designs.asked.at(-1).also.length], [true, 1]);
    await design.tabs.first().click();
    await until(async () => (await place()) !== last, "the simulated curve of the first target");
    assert.notEqual(await page.locator(".verdict").textContent(), words);
    assert.equal(page.designs.asked.length, asked);
    await picture(page, "design-targets-verified");
    await closePage(page);
  });

  it("fit a small screen", () =>
    withTargets(async (design, page) => {
      for (let k = 0; k < 3; ++k) await design.add();
      assert.equal(await design.inSight(), 3);
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "no scrolling to the side");
      const box = await design.tabs.nth(3).boundingBox();
      assert.ok(box.x >= 0 && box.x + box.width <= 360, `the tab of the target in sight is in sight: ${JSON.stringify(box)}`);
      await picture(page, "design-targets-small");
    }, { viewport: { width: 360, height: 740 } }));
});
