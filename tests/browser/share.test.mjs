// Links, files and pins of the design page.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { describe, it } from "node:test";
import { DesignPage } from "./design_page.mjs";
import { browser, closePage, server, setUp, until } from "./harness.mjs";

setUp();

async function saved(page, name) {
  const menu = page.locator("main .menu", { has: page.locator("summary", { hasText: "Export" }) });
  await menu.locator("summary").click();
  const waiting = page.waitForEvent("download");
  await menu.getByText(name).click();
  const file = await waiting;
  return { name: file.suggestedFilename(), bytes: await readFile(await file.path()) };
}

describe("a shared link", () => {
  it("shows another person the same target, family and design", async () => {
    const mine = await DesignPage.open(browser, server.url);
    await mine.page.getByLabel("Stiffness", { exact: true }).check();
    await mine.page.locator(".plot.polar").waitFor();
    await mine.settled();
    await mine.page.getByLabel("Family of tilings").selectOption("IH67");
    await until(async () => (await mine.family()) === "IH67", "a design of IH67");
    await mine.settled();
    await mine.drag(3, 0, -45);
    await mine.settled();
    const words = await mine.pointWords(3);
    await until(async () => mine.page.url().includes("design=IH67"), "the link in the address");
    await mine.page.waitForTimeout(400);
    const theirs = await DesignPage.open(browser, mine.page.url());
    assert.equal(await theirs.pointWords(3), words);
    assert.equal(await theirs.family(), "IH67");
    assert.equal(await theirs.page.getByLabel("Family of tilings").inputValue(), "IH67");
    const [a, b] = [await mine.values(), await theirs.values()];
    a.forEach((row, k) => assert.ok(Math.abs(row[2] - b[k][2]) <= 0.02 * Math.max(...a.map((other) => Math.abs(other[2]))), `sample ${k}`));
    await closePage(mine.page);
    await closePage(theirs.page);
  });

  it("that is broken opens the page as it is for everyone", async () => {
    const design = await DesignPage.open(browser, `${server.url}/#/design?task=stress_strain&points=<script>&family=../..`);
    assert.ok((await design.handles.count()) >= 5);
    await closePage(design.page);
  });
});

describe("an export", () => {
  it("gives data, curves, the plot and the structure", async () => {
    const design = await DesignPage.open(browser, server.url);
    const { page } = design;
    const json = JSON.parse((await saved(page, "Data (JSON)")).bytes.toString());
    assert.equal(json.design.family, await design.family());
    assert.equal(json.profile.x.length, json.profile.achieved.length);
    const csv = (await saved(page, "Curves (CSV)")).bytes.toString().trim().split("\n");
    assert.match(csv[0], /^strain,target_MPa,achieved_MPa/);
    assert.equal(csv.length, json.profile.x.length + 1);
    const plot = (await saved(page, "Plot (SVG)")).bytes.toString();
    const sound = await page.evaluate((text) => {
      const document = new DOMParser().parseFromString(text, "image/svg+xml");
      return document.querySelector("parsererror") === null && document.querySelectorAll("path").length > 3 && !text.includes("var(");
    }, plot);
    assert.ok(sound, "the plot is a drawing of its own");
    assert.match((await saved(page, "Drawing (SVG)")).bytes.toString(), /<svg/);
    assert.match((await saved(page, "Outlines (DXF)")).bytes.toString(), /LWPOLYLINE/);
    const solid = await saved(page, "Solid (STL)");
    assert.ok(solid.bytes.length === 84 + 50 * solid.bytes.readUInt32LE(80), "a binary STL");
    assert.match(solid.name, /\.stl$/);
    await closePage(page);
  });
});

describe("a pinned design", () => {
  it("is drawn beside others, is still there after a reload, and leads back", async () => {
    const design = await DesignPage.open(browser, server.url);
    const { page } = design;
    const last = (await design.handles.count()) - 1;
    const height = await design.pointHeight(last);
    await design.button("Pin").click();
    await page.locator(".pins li").waitFor();
    await design.drag(last, 0, -70);
    await design.settled();
    await until(async () => (await page.locator(".plot .curve.pin").count()) === 1, "the pinned curve");
    await page.reload();
    await design.settled();
    await page.locator(".pins li").waitFor();
    assert.notEqual(await design.pointHeight(last), height);
    await page.getByRole("button", { name: /^Go back to/ }).click();
    await until(async () => Math.abs((await design.pointHeight(last)) - height) < 1e-6 * Math.max(1, Math.abs(height)) + 1e-5, "the pinned target");
    await design.settled();
    await page.getByRole("button", { name: /^Remove IH/ }).click();
    assert.equal(await page.locator(".pins li").count(), 0);
    await closePage(page);
  });
});
