// What can be checked of a page's accessibility by rules, in both colours and on a small screen.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { describe, it } from "node:test";
import { DesignPage } from "./design_page.mjs";
import { browser, closePage, openPage, picture, server, setUp, until } from "./harness.mjs";
import { WeavePage } from "./weave_page.mjs";

const axe = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

setUp({ webgl: true });

async function violations(page) {
  // The rules are put into the page by the browser itself, which its policy on scripts does not concern.
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
  return violations.map((found) => `${found.id}: ${found.help}\n  ${found.nodes.map((node) => `${node.html.slice(0, 160)} | ${node.any.map((check) => check.message).join("; ")}`).join("\n  ")}`);
}

describe("the rules of accessibility", () => {
  for (const colorScheme of ["light", "dark"]) {
    it(`are kept by the design page (${colorScheme})`, async () => {
      const design = await DesignPage.open(browser, server.url, { colorScheme });
      await design.page.locator("details.more summary").click();
      await design.values();
      await design.button("Pin").click();
      assert.deepEqual(await violations(design.page), []);
      await picture(design.page, `design-${colorScheme}-open`);
      await closePage(design.page);
    });

    it(`are kept by the weave page (${colorScheme})`, async () => {
      const { page, ...weave } = await WeavePage.open(browser, server.url, "", { colorScheme });
      await page.getByLabel("Pattern").selectOption("layout");
      await until(async () => (await weave.crossings.count()) === 1, "the first layout");
      await page.getByText("As text (JSON)").click();
      await page.getByText("More", { exact: true }).click();
      await page.getByText("Values as tables").click();
      await page.getByRole("button", { name: "Draw a strand" }).click();
      await page.getByRole("button", { name: "Simulate" }).click();
      await page.locator(".sheet .facts").waitFor();
      assert.deepEqual(await violations(page), []);
      await picture(page, `weave-${colorScheme}`);
      await closePage(page);
    });

    it(`are kept by the mesh page (${colorScheme})`, async () => {
      const page = await openPage(browser, `${server.url}/#/mesh`, { colorScheme });
      await page.getByRole("button", { name: "Sample" }).click();
      await page.locator('[aria-label="Result"]').waitFor();
      assert.deepEqual(await violations(page), []);
      await picture(page, `mesh-${colorScheme}`);
      await page.getByRole("radio", { name: "Network", exact: true }).check();
      await page.getByText("Accuracy, method and effects").click();
      await page.getByText("Repairs at upload").click();
      await page.getByRole("radio", { name: "Shell", exact: true }).check();
      await page.getByLabel("Keep the enclosed volume").check();
      assert.deepEqual(await violations(page), []);
      await page.getByLabel("Keep the enclosed volume").uncheck();
      await page.getByRole("button", { name: "Relax", exact: true }).click();
      await page.locator(".relaxation .stop", { hasText: "at rest" }).waitFor();
      await page.getByText("Effects, bill and history").click();
      assert.deepEqual(await violations(page), []);
      await picture(page, `network-${colorScheme}`);
      await closePage(page);
    });
  }

  it("are kept on a small screen, where nothing is wider than it", async () => {
    const design = await DesignPage.open(browser, server.url, { viewport: { width: 360, height: 740 } });
    assert.deepEqual(await violations(design.page), []);
    assert.ok(await design.page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "no scrolling to the side");
    await picture(design.page, "design-small");
    await closePage(design.page);
  });
});

describe("the weave page on a small screen", () => {
  it("keeps them too", async () => {
    const { page } = await WeavePage.open(browser, server.url, "", { viewport: { width: 360, height: 740 } });
    assert.deepEqual(await violations(page), []);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "no scrolling to the side");
    await picture(page, "weave-small");
    await closePage(page);
  });
});

describe("the mesh page with a network on a small screen", () => {
  it("keeps them too", async () => {
    const page = await openPage(browser, `${server.url}/#/mesh`, { viewport: { width: 360, height: 740 } });
    await page.getByRole("button", { name: "Sample" }).click();
    await page.locator('[aria-label="Result"]').waitFor();
    await page.getByRole("radio", { name: "Network", exact: true }).check();
    await page.getByRole("button", { name: "Relax", exact: true }).click();
    await page.locator(".relaxation .stop", { hasText: "at rest" }).waitFor();
    const { y, height } = await page.locator(".viewer canvas").boundingBox();
    assert.ok(y < 740 && y + height > 0, `the network is in sight while it relaxes, not at ${y}`);
    assert.deepEqual(await violations(page), []);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "no scrolling to the side");
    await picture(page, "network-small");
    await page.getByRole("radio", { name: "Membrane", exact: true }).check();
    await page.getByRole("button", { name: "Relax", exact: true }).click();
    await page.locator(".relaxation .stop", { hasText: "at rest" }).waitFor();
    assert.deepEqual(await violations(page), []);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "no scrolling to the side");
    await picture(page, "membrane-small");
    await closePage(page);
  });
});

describe("the mesh page with a Voronoi diagram", () => {
  for (const [name, options] of [["light", { colorScheme: "light" }], ["dark", { colorScheme: "dark" }], ["small", { viewport: { width: 360, height: 740 } }]]) {
    it(`keeps them too (${name})`, async () => {
      const page = await openPage(browser, `${server.url}/#/mesh`, options);
      await page.getByRole("button", { name: "Sample" }).click();
      await page.locator('[aria-label="Result"]').waitFor();
      await page.getByRole("radio", { name: "Voronoi", exact: true }).check();
      await page.getByRole("button", { name: "Scatter sites" }).click();
      await page.locator('[aria-label="Statistics"]').waitFor();
      await page.getByLabel("Chosen site, as a number").fill("3");
      await page.getByLabel("Chosen site, as a number").press("Enter");
      await page.getByRole("button", { name: "Move the chosen site left" }).waitFor();
      await page.getByText("Method and accuracy").click();
      await page.getByLabel("Colour of the cells").selectOption("area");
      assert.deepEqual(await violations(page), []);
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "no scrolling to the side");
      await picture(page, `voronoi-${name}`);
      await closePage(page);
    });
  }
});

describe("the keyboard", () => {
  it("reaches the skip link first, and every control point", async () => {
    const design = await DesignPage.open(browser, server.url);
    const { page } = design;
    await page.keyboard.press("Tab");
    assert.equal(await page.evaluate(() => document.activeElement.textContent), "Skip to the content");
    const reached = new Set();
    for (let k = 0; k < 60; ++k) {
      await page.keyboard.press("Tab");
      reached.add(await page.evaluate(() => document.activeElement.getAttribute("aria-label")));
    }
    for (let k = 1; k <= (await design.handles.count()); ++k) assert.ok(reached.has(`Control point ${k}`), `control point ${k}`);
    await closePage(page);
  });
});

describe("a screen reader", () => {
  it("hears the outcome of a search", async () => {
    const design = await DesignPage.open(browser, server.url);
    await design.drag(4, 0, -30);
    await design.settled();
    await until(async () => /^IH\d+, parameters .*% from the target/.test(await design.page.locator("#announcements").textContent()), "the announcement");
    await closePage(design.page);
  });
});

describe("the colours", () => {
  it("follow the system until one is chosen, which is kept", async () => {
    const page = await openPage(browser, `${server.url}/#/mesh`, { colorScheme: "dark" });
    const theme = () => page.evaluate(() => document.documentElement.dataset.theme);
    await until(async () => (await theme()) === "dark", "dark");
    await page.getByRole("button", { name: /^Colours/ }).click();
    assert.equal(await theme(), "light");
    await page.reload();
    await until(async () => (await theme()) === "light", "light");
    await closePage(page);
  });
});
