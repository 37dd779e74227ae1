// The dial of accuracy on each page, and effects as chips: what they ask for, what they say, and that undo, links and reloads keep the choice.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { DesignPage } from "./design_page.mjs";
import { announcements, browser, closePage, openPage, picture, server, setUp, until } from "./harness.mjs";
import { WeavePage } from "./weave_page.mjs";

setUp({ webgl: true });

const level = (page, name) => page.locator(".accuracy-dial:visible").getByRole("radio", { name, exact: true });
const words = (page, name) => page.locator(".accuracy-dial:visible label", { has: page.getByRole("radio", { name, exact: true }) }).locator("small").textContent();
const chip = (page, name) => page.locator(".effect-chip", { hasText: `${name}: ` });
const last = (list) => list[list.length - 1];

describe("the dial of accuracy", () => {
  it("of a weave says what each level takes, and is part of undo, link and the next visit", async () => {
    const weave = await WeavePage.open(browser, server.url);
    const { page } = weave;
    assert.ok(await level(page, "Normal").isChecked());
    await until(async () => /^\d[^≈]*s, ±/.test(await words(page, "Normal")), "what was measured here");
    assert.match(await words(page, "Draft"), /^≈ .*s, ±\u00a0[\d.]+\u00a0%$/);
    assert.match(await page.locator(".dial-words").textContent(), /^Stiffness: .* as measured here, ±\u00a0.*Four pieces of rod/);
    await level(page, "Draft").check();
    await until(() => last(page.profiles).accuracy.segments === 2, "two pieces of rod");
    await weave.settled();
    assert.match(page.url(), /accuracy=draft/);
    await picture(page, "weave-draft");
    await page.keyboard.press("Control+z");
    await until(() => last(page.profiles).accuracy.segments === 4, "four pieces again");
    assert.ok(await level(page, "Normal").isChecked());
    assert.doesNotMatch(page.url(), /accuracy=/);
    await page.keyboard.press("Control+Shift+z");
    await until(async () => /accuracy=draft/.test(page.url()), "the link");
    await page.reload();
    await weave.settled();
    assert.ok(await level(page, "Draft").isChecked());
    await page.goto(`${server.url}/#/mesh`);
    await page.goto("about:blank");
    await page.goto(`${server.url}/#/weave`);
    await weave.settled();
    assert.ok(await level(page, "Draft").isChecked(), "the level of the last visit");
    await closePage(page);
  });

  it("has the number of pieces of rod among its own values", async () => {
    const weave = await WeavePage.open(browser, server.url);
    const { page } = weave;
    await page.getByText("Own values").click();
    await weave.enter("Pieces of rod between crossings", 3);
    await until(() => last(page.profiles).accuracy.segments === 3, "three pieces");
    assert.ok(await level(page, "Own").isChecked());
    await closePage(page);
    const old = await WeavePage.open(browser, server.url, "pattern=interlacing_circles&segments=3");
    assert.ok(await level(old.page, "Own").isChecked(), "a link of an earlier version");
    assert.equal(last(old.page.profiles).accuracy.segments, 3);
    await closePage(old.page);
  });

  it("of a design is worked by keys, and decides about thorough searches alone", async () => {
    const design = await DesignPage.open(browser, server.url);
    const { page } = design;
    assert.deepEqual(last(page.designs.asked).effects, { multi_start: "automatic", envelope: "on" });
    const heard = await announcements(page);
    await level(page, "Normal").focus();
    await page.keyboard.press("ArrowLeft");
    await until(() => last(page.designs.asked).effects.envelope === "off", "a search at the level of a draft");
    assert.equal(last(page.designs.asked).accuracy.starts, 1);
    await design.settled();
    await until(async () => (await heard()).some((sentence) => /Accuracy: Draft/.test(sentence)), "the announcement");
    assert.match(page.url(), /accuracy=draft/);
    await page.keyboard.press("Control+z");
    await until(() => last(page.designs.asked).effects.envelope === "on", "a normal search");
    await design.settled();
    assert.ok(await level(page, "Normal").isChecked());
    await closePage(page);
  });

  it("of a distance field has the error beside the distance", async () => {
    const page = await openPage(browser, `${server.url}/#/mesh`);
    const fields = [];
    page.on("request", (request) => request.url().endsWith("/v1/geodesic-fields") && fields.push(request.postDataJSON()));
    await page.getByRole("button", { name: "Sample" }).click();
    await page.locator('[aria-label="Result"]').waitFor();
    assert.equal(await page.locator(".accuracy-dial:visible").count(), 0, "paths are exact");
    await page.getByLabel("Distance", { exact: true }).check();
    await chip(page, "distances").filter({ hasText: "exact" }).waitFor();
    await level(page, "Draft").check();
    await chip(page, "distances").filter({ hasText: "approximate" }).waitFor();
    assert.equal(last(fields).accuracy.relative_error, 0.05);
    assert.match(await page.locator('[aria-label="Result"] dt', { hasText: "Farthest vertex" }).locator("+ dd").textContent(), /^[\d.]+ ±\u00a0[\d.]+\u00a0%$/);
    assert.match(page.url(), /accuracy=draft/);
    await closePage(page);
  });

  it("of a network and of a diagram holds the controls of accuracy that they had", async () => {
    const page = await openPage(browser, `${server.url}/#/mesh`);
    await page.getByRole("button", { name: "Sample" }).click();
    await page.locator('[aria-label="Result"]').waitFor();
    await page.getByRole("radio", { name: "Network", exact: true }).check();
    await page.getByText("Own values: accuracy, method and effects").click();
    await page.getByLabel("Network", { exact: true }).getByLabel("Tolerance of the gradient").selectOption("0.000001");
    assert.ok(await level(page, "Own").isChecked());
    const asked = page.waitForRequest((request) => request.url().endsWith("/v1/embedded-systems") && request.postDataJSON().paths === true);
    await page.getByRole("button", { name: "Relax", exact: true }).click();
    assert.equal((await asked).postDataJSON().accuracy.tolerance, 1e-6);
    await page.locator(".relaxation .stop", { hasText: "at rest" }).waitFor();
    await chip(page, "paths kept from step to step").filter({ hasText: "used" }).waitFor();
    await level(page, "Sure").check();
    await page.locator(".relaxation .note", { hasText: "relax it again" }).waitFor();
    await page.getByRole("radio", { name: "Voronoi", exact: true }).check();
    await page.getByText("Own values: method and accuracy").click();
    await page.getByRole("button", { name: "Scatter sites" }).click();
    await page.locator('[aria-label="Statistics"]').waitFor();
    const again = page.waitForRequest((request) => request.url().endsWith("/v1/voronoi-diagrams"));
    await page.getByLabel("Along edges").check();
    assert.equal((await again).postDataJSON().accuracy.method, "edges");
    assert.ok(await level(page, "Own").isChecked());
    await closePage(page);
  });

  it("is no wider than a small screen", async () => {
    const weave = await WeavePage.open(browser, server.url, "", { viewport: { width: 390, height: 800 } });
    await weave.page.getByText("Own values").click();
    assert.ok(await weave.page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "no scrolling to the side");
    await picture(weave.page, "weave-dial-small");
    await closePage(weave.page);
  });
});

describe("a chip of an effect", () => {
  it("of a weave says what was found, and is switched by keys: where needed, always, never", async () => {
    const weave = await WeavePage.open(browser, server.url);
    const { page } = weave;
    const buckling = page.locator(".profile").getByRole("button", { name: /^buckling: / });
    await until(async () => /checked, none|found/.test(await buckling.textContent()), "what was found");
    await buckling.focus();
    await page.keyboard.press("Enter");
    await until(() => last(page.profiles).effects.buckling === "on", "always");
    await until(async () => /, always$/.test(await buckling.textContent()), "the chip says so");
    await page.keyboard.press("Enter");
    await until(() => last(page.profiles).effects.buckling === "off", "never");
    await weave.settled();
    assert.equal(await buckling.textContent(), "buckling: switched off, never");
    assert.doesNotMatch((await buckling.getAttribute("class")) ?? "", /clear/, "what was not computed is not green");
    assert.match(page.url(), /effects=buckling:off/);
    await page.keyboard.press("Enter");
    await until(() => last(page.profiles).effects.buckling === undefined, "where needed");
    assert.ok(await buckling.evaluate((element) => element === document.activeElement), "it keeps the focus");
    await closePage(page);
  });

  it("of a search is switched, and a simulation says what it found", async () => {
    const design = await DesignPage.open(browser, server.url);
    const { page } = design;
    await page.locator(".result").getByRole("button", { name: /^surer designs: / }).click();
    await until(() => last(page.designs.asked).effects.trust === "on", "a search that prefers surer designs");
    await design.settled();
    await page.getByRole("button", { name: "Verify by simulation" }).click();
    const found = page.locator('[aria-label="What the simulation found"]');
    await found.locator(".effect-chip", { hasText: "discretization: " }).waitFor();
    assert.match(await found.textContent(), /contact: /);
    await until(async () => /±/.test(await page.locator(".result .facts dd").first().textContent()), "the error of the mesh beside the deviation");
    await picture(page, "design-chips");
    await closePage(page);
  });
});
