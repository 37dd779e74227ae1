// The weave page: patterns, clicks on crossings, updates of the profile, and drawn strands.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { announcements, browser, closePage, picture, server, setUp, until } from "./harness.mjs";
import { WeavePage } from "./weave_page.mjs";

setUp();

const SQUARES = "pattern=interlacing_squares&type=2&side=12&overlap=3&radius=0.25&strain=0.1";

describe("a pattern", () => {
  it("is shown with its crossings, its profile and its deformed cell, for each type", async () => {
    const opened = await WeavePage.open(browser, server.url);
    assert.equal(await opened.crossings.count(), 4, "the page opens on circles, which are quick");
    await closePage(opened.page);
    const weave = await WeavePage.open(browser, server.url, SQUARES);
    const { page } = weave;
    assert.equal(await weave.crossings.count(), 16);
    assert.match(await weave.words(2), /^Crossing 3 of strands 1 and 6: strand 1 slides$/);
    const curve = await weave.curve("modulus");
    const cell = await weave.cell();
    await picture(page, "weave-squares");
    await page.getByLabel("Connections of its crossings").selectOption("1");
    await until(async () => /: fused$/.test(await weave.words(2)), "fused crossings");
    await until(async () => (await weave.curve("modulus")) !== curve, "another profile");
    await weave.settled();
    await until(async () => (await weave.cell()) !== cell, "another deformed cell");
    await page.getByLabel("Pattern").selectOption("interlacing_circles");
    await until(async () => (await weave.crossings.count()) === 4, "the circles");
    await weave.settled();
    await picture(page, "weave-circles");
    // Rings are not periodic: the previous cell disappears, and nothing is wider than the page.
    await page.getByLabel("Pattern").selectOption("actuated_rings");
    await until(async () => !(await page.locator(".profile").isVisible()), "no stiffness of rings");
    assert.equal(await page.locator(".cell").isVisible(), false);
    await until(async () => (await weave.crossings.count()) > 16, "the rings");
    assert.equal(await page.locator(".layout .copies > *").count(), 0, "rings are drawn once");
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "no scrolling to the side");
    await picture(page, "weave-rings");
    await closePage(page);
  });

  it("asks for few directions first and for all of them then, and a change stops what is no longer wanted", async () => {
    const weave = await WeavePage.open(browser, server.url);
    const { page } = weave;
    page.profiles.length = 0;
    await weave.enter("Strain along each direction", 0.12);
    await until(() => page.profiles.length === 2, "both requests");
    await weave.settled();
    assert.deepEqual(page.profiles.map((request) => request.directions), [24, 200]);
    let held = 0;
    let ended = 0;
    page.on("requestfailed", (request) => (ended += request.url().endsWith("/v1/weave-homogenizations") ? 1 : 0));
    await page.route("**/v1/weave-homogenizations", async (route) => {
      if (route.request().postDataJSON().directions === 200) {
        ++held;
        await new Promise((resolve) => setTimeout(resolve, 3000));
      }
      await route.continue().catch(() => {});
    });
    await weave.enter("Strain along each direction", 0.2);
    await until(() => held === 1, "a thorough request that is held up");
    await weave.enter("Strain along each direction", 0.15);
    await until(() => ended >= 1, "its end");
    await page.unroute("**/v1/weave-homogenizations");
    await weave.settled();
    const last = page.profiles[page.profiles.length - 1];
    assert.deepEqual([last.strain, last.directions], [0.15, 200]);
    await closePage(page);
  });

  it("leaves gaps where there is no value, and says why", async () => {
    const weave = await WeavePage.open(browser, server.url, "pattern=regular&type=2&pitch=4&radius=0.25&strain=0.5");
    const { page } = weave;
    await page.locator(".profile .note", { hasText: "folds flat" }).waitFor();
    assert.ok((await page.locator(".gaps path").count()) >= 2);
    const row = (await weave.values()).find(([direction]) => direction === "45°");
    assert.deepEqual(row.slice(1, 3), ["none", "none"]);
    assert.match(row[3], /folds flat/);
    await picture(page, "weave-gaps");
    await closePage(page);
  });
});

describe("a crossing", () => {
  it("goes on to its next connection when it is clicked, which changes the profile; undo and redo go back and forth", async () => {
    const weave = await WeavePage.open(browser, server.url, "pattern=regular&type=1&pitch=4&radius=0.25&strain=0.1");
    const { page } = weave;
    const curve = await weave.curve("poisson");
    await weave.crossings.first().click();
    await until(async () => /: strand 1 slides, changed by hand$/.test(await weave.words(0)), "the first strand slides");
    await until(async () => (await weave.curve("poisson")) !== curve, "another profile");
    await weave.settled();
    await weave.crossings.first().click();
    await until(async () => /: strand 3 slides/.test(await weave.words(0)), "the second strand slides");
    await weave.settled();
    await weave.button("Undo (Ctrl+Z)").click();
    await weave.button("Undo (Ctrl+Z)").click();
    await until(async () => /: fused$/.test(await weave.words(0)), "the crossing as it was");
    await weave.settled();
    assert.equal(await weave.curve("poisson"), curve);
    await weave.button("Redo (Ctrl+Shift+Z)").click();
    await until(async () => /: strand 1 slides/.test(await weave.words(0)), "the step again");
    await weave.button("Crossings as the pattern has them").click();
    await until(async () => /: fused$/.test(await weave.words(0)), "the pattern's own");
    await closePage(page);
  });

  it("is changed by keys, keeps the focus, and a screen reader hears of it", async () => {
    const weave = await WeavePage.open(browser, server.url, "pattern=regular&type=1&pitch=4&radius=0.25&strain=0.1");
    const { page } = weave;
    const heard = await announcements(page);
    await weave.crossings.nth(1).focus();
    await page.keyboard.press("Enter");
    await until(async () => (await heard()).some((sentences) => /^Crossing 2: strand \d slides\./.test(sentences)), "the announcement");
    assert.match(await page.evaluate(() => document.activeElement.getAttribute("aria-label")), /^Crossing 2 .*slides/);
    await page.keyboard.press("Control+z");
    await until(async () => /: fused$/.test(await weave.words(1)), "the undone step");
    await weave.settled();
    await closePage(page);
  });
});

describe("a direction", () => {
  it("is looked at with the pointer and by keys, and has its deformed cell", async () => {
    const weave = await WeavePage.open(browser, server.url);
    const { page } = weave;
    const cell = await weave.cell();
    const box = await page.locator(".chart-stage").first().boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 4);
    await until(async () => /^At 90°/.test(await page.locator(".reading").textContent()), "the reading at 90°");
    await until(async () => (await weave.cell()) !== cell, "its cell");
    await page.mouse.move(5, 5);
    await until(async () => /^At 0°/.test(await page.locator(".reading").textContent()), "the chosen direction again");
    const handle = page.getByRole("slider", { name: "Direction, Young’s modulus" });
    await handle.focus();
    await page.keyboard.press("PageUp");
    await until(async () => /^9°, Young’s modulus .* N\/m$/.test(await handle.getAttribute("aria-valuetext")), "the direction ten further");
    await page.locator(".cell[aria-label*='along 9°']").waitFor();
    await page.getByLabel("3 × 3").check();
    assert.equal(await page.locator(".cell .strands > g").count(), 9);
    await closePage(page);
  });
});

describe("strands of one's own", () => {
  it("are drawn point by point, cross where they cross, and keep their connections", async () => {
    const weave = await WeavePage.open(browser, server.url, "pattern=layout&layout=%7B%22strands%22%3A%5B%7B%22points%22%3A%5B%5B0%2C5%5D%5D%2C%22ends%22%3A%22periodic%22%2C%22translation%22%3A%5B10%2C0%5D%7D%2C%7B%22points%22%3A%5B%5B3%2C0%5D%5D%2C%22ends%22%3A%22periodic%22%2C%22translation%22%3A%5B0%2C10%5D%7D%5D%2C%22lattice%22%3A%5B%5B10%2C0%5D%2C%5B0%2C10%5D%5D%7D");
    const { page } = weave;
    assert.equal(await weave.crossings.count(), 1);
    await weave.crossings.first().click();
    await until(async () => /slides/.test(await weave.words(0)), "a crossing that slides");
    await weave.button("Draw a strand").click();
    await weave.clickAt(7, 0.1);
    await weave.clickAt(8, 5);
    await picture(page, "weave-drawing");
    await weave.button("Goes on ↑").click();
    await until(async () => (await weave.crossings.count()) === 2, "a further crossing");
    const words = await Promise.all([0, 1].map((index) => weave.words(index)));
    assert.equal(words.filter((text) => /slides/.test(text)).length, 1, "the first crossing slides as before");
    await weave.settled();
    await page.getByRole("button", { name: "Remove strand 2" }).click();
    await until(async () => (await weave.crossings.count()) === 1, "the crossing of what is left");
    assert.match(await weave.words(0), /: fused/);
    await weave.settled();
    await closePage(page);
  });

  it("come from text, whose faults are named", async () => {
    const weave = await WeavePage.open(browser, server.url);
    const { page } = weave;
    await page.getByLabel("Pattern").selectOption("layout");
    await weave.settled();
    await page.getByText("As text (JSON)").click();
    const text = page.getByLabel("Strands, as in a request’s weave");
    await text.fill('{"strands": [{"points": [[0, 0], [1]]}]}');
    await weave.button("Use this text").click();
    await page.locator(".note", { hasText: "point 1 of strand 1 must be a number" }).waitFor();
    await text.fill('{"strands": [{"points": [[0, 0]]}], "lattice": [[5, 0], [0, 5]]}');
    await weave.button("Use this text").click();
    await page.locator(".panel .note", { hasText: /points of strand 1.*must be at least 2/i }).waitFor();
    await text.fill('{"strands": [{"points": [[0, 0], [20, 0]]}, {"points": [[0, 8], [20, 8]]}, {"points": [[4, -3], [4, 11]]}]}');
    await weave.button("Use this text").click();
    await until(async () => (await weave.crossings.count()) === 2, "the crossings of the sheet");
    await page.getByText("Only a cell that repeats has a stiffness").waitFor();
    assert.equal(await page.locator(".panel .note:visible").count(), 0);
    await picture(page, "weave-sheet-only");
    await closePage(page);
  });
});
