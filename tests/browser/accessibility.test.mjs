// Checks of accessibility rules on all pages, in both colour schemes and on a small screen.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { describe, it } from "node:test";
import { DesignPage } from "./design_page.mjs";
import { FamilyPage, GAPS, linkTo, SLANTED } from "./family_page.mjs";
import { announcements, browser, closePage, openPage, picture, server, setUp, until } from "./harness.mjs";
import { answerWays, MISSED, WAY } from "./missed_target.mjs";
import { WeavePage } from "./weave_page.mjs";

const axe = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

setUp({ webgl: true });

async function violations(page) {
  // The browser evaluates the rules in the page, to which the content security policy of the page does not apply.
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
  return violations.map((found) => `${found.id}: ${found.help}\n  ${found.nodes.map((node) => `${node.html.slice(0, 160)} | ${node.any.map((check) => check.message).join("; ")}`).join("\n  ")}`);
}

/** Disables transitions, so that colours are checked in their final state. */
const STILL = { reducedMotion: "reduce" };

/** The violations of a page in the light and the dark colour scheme, which follow the system's. `name`: name of the pictures. */
async function violationsInBothColours(page, name) {
  const found = [];
  for (const colorScheme of ["dark", "light"]) {
    await page.emulateMedia({ colorScheme });
    await page.locator(`:root[data-theme="${colorScheme}"]`).waitFor();
    found.push(...(await violations(page)).map((words) => `${colorScheme}: ${words}`));
    if (name) await picture(page, `${name}-${colorScheme}`);
  }
  return found;
}

async function isAsWideAsTheScreen(page) {
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "no scrolling to the side");
}

const SMALL = { viewport: { width: 360, height: 740 } };

describe("the rules of accessibility", () => {
  it("are kept by the design page in light and dark colours", async () => {
    const design = await DesignPage.open(browser, server.url, STILL);
    await design.page.locator("details.more summary").click();
    await design.page.locator("details.made summary").click();
    await design.page.getByLabel("Find it: orientation").check();
    await design.settled();
    await design.page.getByLabel("Young’s modulus, MPa", { exact: true }).fill("-5");
    await design.page.keyboard.press("Tab");
    await design.page.locator("details.made .note.problem:visible").waitFor();
    await design.values();
    await design.button("Pin").click();
    assert.deepEqual(await violationsInBothColours(design.page, "design-open"), []);
    await severalMaterials(design);
    await design.page.getByLabel("Name of material 2").fill("TPU");
    await design.page.keyboard.press("Tab");
    await design.page.locator("details.made .note.problem:visible").waitFor();
    assert.deepEqual(await violationsInBothColours(design.page, "design-materials"), []);
    await furtherTarget(design);
    assert.deepEqual(await violationsInBothColours(design.page, "design-targets"), []);
    await design.page.getByTitle("Divide the product into regions").click();
    await design.page.locator(".regions-card li").nth(1).waitFor();
    await design.settled();
    await design.page.getByRole("button", { name: "Rename this region" }).click();
    assert.deepEqual(await violationsInBothColours(design.page, "design-regions"), []);
    await drawnPart(design);
    assert.deepEqual(await violationsInBothColours(design.page, "design-drawing"), []);
    await design.page.getByRole("button", { name: "Rename this target" }).click();
    assert.deepEqual(await violationsInBothColours(design.page), []);
    await closePage(design.page);
  });

  it("are kept by the family page in light and dark colours", async () => {
    const { page } = await unfoldedFamily(STILL);
    assert.deepEqual(await violationsInBothColours(page, "family-open"), []);
    await page.locator(".type-menu summary").click();
    await page.getByRole("button", { name: "IH93, no parameters" }).waitFor();
    assert.deepEqual(await violationsInBothColours(page), []);
    await closePage(page);
    const faulty = await FamilyPage.open(browser, server.url, linkTo(GAPS), STILL);
    assert.deepEqual(await violationsInBothColours(faulty.page, "family-faulty"), []);
    await closePage(faulty.page);
  });

  it("are kept by the weave page in light and dark colours", async () => {
    const { page, ...weave } = await WeavePage.open(browser, server.url, "", STILL);
    await page.getByLabel("Pattern").selectOption("layout");
    await until(async () => (await weave.crossings.count()) === 1, "the first layout");
    await page.getByText("As text (JSON)").click();
    await page.getByText("More", { exact: true }).click();
    await page.getByText("Values as tables").click();
    await page.getByRole("button", { name: "Draw a strand" }).click();
    await page.getByRole("button", { name: "Simulate" }).click();
    await page.locator(".sheet .facts").waitFor();
    assert.deepEqual(await violationsInBothColours(page, "weave"), []);
    await page.getByLabel("Pattern").selectOption("regular");
    await openPrint(page);
    assert.deepEqual(await violationsInBothColours(page, "print"), []);
    await page.getByLabel("Bed along x, mm", { exact: true }).fill("1");
    await page.keyboard.press("Tab");
    await page.locator(".print .fault:visible").waitFor();
    assert.deepEqual(await violationsInBothColours(page), []);
    await closePage(page);
  });

  it("are kept by the mesh page in light and dark colours", async () => {
    const page = await openPage(browser, `${server.url}/#/mesh`, STILL);
    await page.getByRole("button", { name: "Sample" }).click();
    await page.locator('[aria-label="Result"]').waitFor();
    assert.deepEqual(await violationsInBothColours(page, "mesh"), []);
    await page.getByRole("radio", { name: "Network", exact: true }).check();
    await page.getByText("Accuracy, method and effects").click();
    await page.getByText("Repairs at upload").click();
    await page.getByRole("radio", { name: "Shell", exact: true }).check();
    await page.getByLabel("Keep the enclosed volume").check();
    assert.deepEqual(await violationsInBothColours(page), []);
    await page.getByLabel("Keep the enclosed volume").uncheck();
    await page.getByRole("button", { name: "Relax", exact: true }).click();
    await page.locator(".relaxation .stop", { hasText: "at rest" }).waitFor();
    await page.getByText("Effects, bill and history").click();
    assert.deepEqual(await violationsInBothColours(page, "network"), []);
    await closePage(page);
  });

  it("are kept by a Voronoi diagram in light and dark colours", async () => {
    const page = await scatteredSites(STILL);
    assert.deepEqual(await violationsInBothColours(page, "voronoi"), []);
    await closePage(page);
  });
});

/** Opens a family of the server with its atlas and unfolded settings. */
async function unfoldedFamily(options) {
  const family = await FamilyPage.open(browser, server.url, "", options);
  const { page } = family;
  await page.locator(".type-menu summary").click();
  await page.getByRole("list", { name: "Families of this server" }).getByRole("button", { name: /^IH21:/ }).click();
  await family.checked();
  await page.getByLabel(/^Words and bounds of/).first().click();
  await page.getByLabel("Edges b", { exact: true }).selectOption("bent");
  await family.handle("Point 1 of the edges b").focus();
  await family.button("Undo (Ctrl+Z)").click();
  await family.button("Make the atlas").click();
  await page.locator(".reach-row").first().waitFor();
  await page.getByText("Values of the atlas as tables").click();
  return family;
}

async function severalMaterials({ page }) {
  await page.locator("details.made").getByLabel("Material", { exact: true }).selectOption("Several: the search chooses");
  await page.getByLabel("Name of material 5").waitFor();
  await until(async () => (await page.locator(".result .facts dt", { hasText: /^Material$/ }).count()) === 1, "the material that was found");
}

/** Shows a part made from a drawing, and a drawing that was refused. */
async function drawnPart(design) {
  const drawing = (content) => `<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="40mm" viewBox="0 0 60 40">${content}</svg>`;
  await design.drop(".preview", drawing('<rect width="60" height="40"/><circle id="hole" cx="30" cy="20" r="8"/>'), "plate.svg");
  await design.page.locator("details.part .facts", { hasText: "60 × 40 × 1 mm" }).waitFor();
  await design.drop(".preview", drawing(""), "empty.svg");
  await design.page.locator(".drop-problem").waitFor();
}

async function furtherTarget(design) {
  await design.page.getByTitle("Add a further target of the same design").click();
  await until(async () => (await design.page.getByRole("tab").count()) === 2, "a further tab");
  await design.settled();
}

/** Opens the print dialog and unfolds all of its settings. */
async function openPrint(page) {
  await page.getByRole("button", { name: "Print", exact: true }).click();
  await page.locator(".print .facts dd").first().waitFor();
  for (const group of await page.locator(".print .more summary").all()) await group.click();
}

/** Opens a page with a Voronoi diagram, a chosen site and unfolded settings. */
async function scatteredSites(options) {
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
  return page;
}

describe("on a small screen, where nothing is wider than it, the rules are kept", () => {
  it("by the design page, however long its last answer took", async () => {
    const design = await DesignPage.open(browser, server.url, SMALL);
    assert.deepEqual(await violations(design.page), []);
    await isAsWideAsTheScreen(design.page);
    await picture(design.page, "design-small");
    await furtherTarget(design);
    await design.page.locator("details.made summary").click();
    await severalMaterials(design);
    await drawnPart(design);
    assert.deepEqual(await violations(design.page), []);
    await isAsWideAsTheScreen(design.page);
    await design.page.locator("details.part").scrollIntoViewIfNeeded();
    await picture(design.page, "design-drawing-small");
    await design.page.locator("details.made .materials").scrollIntoViewIfNeeded();
    await picture(design.page, "design-materials-small");
    await design.page.locator(".bill-menu summary span").evaluate((words) => (words.textContent = "59 min 59 s"));
    await isAsWideAsTheScreen(design.page);
    await design.page.locator(".bill-menu summary").click();
    await design.page.locator(".bills").waitFor();
    await isAsWideAsTheScreen(design.page);
    await picture(design.page, "design-bill-small");
    await closePage(design.page);
  });

  it("by the family page", async () => {
    const { page } = await unfoldedFamily(SMALL);
    assert.deepEqual(await violations(page), []);
    await isAsWideAsTheScreen(page);
    await picture(page, "family-small");
    await page.locator(".atlas").scrollIntoViewIfNeeded();
    await picture(page, "family-atlas-small");
    await closePage(page);
  });

  it("by the weave page", async () => {
    const { page } = await WeavePage.open(browser, server.url, "", SMALL);
    assert.deepEqual(await violations(page), []);
    await isAsWideAsTheScreen(page);
    await picture(page, "weave-small");
    await openPrint(page);
    assert.deepEqual(await violations(page), []);
    await isAsWideAsTheScreen(page);
    await picture(page, "print-small");
    await closePage(page);
  });

  it("by the mesh page with a network and with a membrane", async () => {
    const page = await openPage(browser, `${server.url}/#/mesh`, SMALL);
    await page.getByRole("button", { name: "Sample" }).click();
    await page.locator('[aria-label="Result"]').waitFor();
    await page.getByRole("radio", { name: "Network", exact: true }).check();
    await page.getByRole("button", { name: "Relax", exact: true }).click();
    await page.locator(".relaxation .stop", { hasText: "at rest" }).waitFor();
    const { y, height } = await page.locator(".viewer canvas").boundingBox();
    assert.ok(y < 740 && y + height > 0, `the network is in sight while it relaxes, not at ${y}`);
    assert.deepEqual(await violations(page), []);
    await isAsWideAsTheScreen(page);
    await picture(page, "network-small");
    await page.getByRole("radio", { name: "Membrane", exact: true }).check();
    await page.getByRole("button", { name: "Relax", exact: true }).click();
    await page.locator(".relaxation .stop", { hasText: "at rest" }).waitFor();
    assert.deepEqual(await violations(page), []);
    await isAsWideAsTheScreen(page);
    await picture(page, "membrane-small");
    await closePage(page);
  });

  it("by the mesh page with a Voronoi diagram", async () => {
    const page = await scatteredSites(SMALL);
    assert.deepEqual(await violations(page), []);
    await isAsWideAsTheScreen(page);
    await picture(page, "voronoi-small");
    await closePage(page);
  });
});

describe("the family page by the keyboard", () => {
  it("has each vertex, edge, parameter and card within reach, and keeps the focus on what was pressed", async () => {
    const family = await FamilyPage.open(browser, server.url, linkTo(SLANTED), STILL);
    const { page } = family;
    await page.locator("#main").focus();
    const walked = [];
    for (let k = 0; k < 60; ++k) {
      await page.keyboard.press("Tab");
      walked.push(await page.evaluate(() => document.activeElement.ariaLabel ?? document.activeElement.labels?.[0]?.textContent ?? document.activeElement.textContent));
    }
    for (const name of ["Slant", "Vertex 1", "Vertex 4", "Make it a parameter", "The parameters", "Make the atlas", "Name", "Add to the server", "Core time"]) {
      assert.ok(walked.includes(name), `${name} in ${walked.join(", ")}`);
    }
    await family.button("Make it a parameter").focus();
    await page.keyboard.press("Enter");
    await family.number("Width of the beams").waitFor();
    assert.notEqual(await page.evaluate(() => document.activeElement.tagName), "BODY");
    await closePage(page);
  });
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
    const heard = await announcements(design.page);
    await design.drag(await design.movable(), 0, -30);
    await design.settled();
    await until(async () => (await heard()).some((words) => /^IH\d+, parameters .*% from the target/.test(words)), "the announcement");
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

const PHONE = { ...STILL, viewport: { width: 390, height: 844 } };

/** Opens a target that is missed, with a way out, as a person sees it who is there for the first time. */
async function missedTarget(options) {
  const design = await DesignPage.open(browser, `${server.url}/${MISSED}`, { firstVisit: true, ...options });
  await answerWays(design.page, [WAY]);
  await design.page.getByLabel("Check by itself").check();
  await design.page.locator(".ways-out button").waitFor();
  return design;
}

/** Unfolds the tools for strands of one's own, with a strand that is being drawn. */
async function drawnStrand(weave) {
  const { page } = weave;
  await page.getByLabel("Pattern").selectOption("layout");
  await until(async () => (await weave.crossings.count()) === 1, "the first layout");
  await weave.settled();
  await page.getByText("Scale and repeat").click();
  await weave.button("Draw a strand").click();
  await weave.clickAt(2, 2);
}

describe("a first visit, the verdict with its ways out, the card of the part and the tools for strands", () => {
  for (const [where, options] of [["in a wide window", STILL], ["on a phone", PHONE]]) {
    it(`keep the rules in light and dark colours ${where}, and are no wider than it`, async () => {
      const design = await missedTarget(options);
      const { page } = design;
      await page.getByRole("region", { name: "What this is" }).waitFor();
      await page.locator("details.part summary").click();
      await page.locator("details.part .facts", { hasText: "30 × 90 × 1 mm" }).waitFor();
      assert.deepEqual(await violationsInBothColours(page, `missed-${options.viewport?.width ?? "wide"}`), []);
      await isAsWideAsTheScreen(page);
      await closePage(page);
      const weave = await WeavePage.open(browser, server.url, "", options);
      await drawnStrand(weave);
      assert.deepEqual(await violationsInBothColours(weave.page, `strands-${options.viewport?.width ?? "wide"}`), []);
      await isAsWideAsTheScreen(weave.page);
      await closePage(weave.page);
    });
  }

  it("are used by the keyboard alone, which stays where the work is", async () => {
    const design = await missedTarget(STILL);
    const { page } = design;
    const focused = () => page.evaluate(() => document.activeElement.ariaLabel ?? document.activeElement.labels?.[0]?.textContent ?? document.activeElement.textContent);
    await page.getByRole("button", { name: "Close, and do not show it again" }).focus();
    await page.keyboard.press("Enter");
    assert.equal(await focused(), "Design", "the heading of the page after a card that was closed");
    await page.getByRole("region", { name: "Verdict" }).getByRole("button").first().focus();
    const walked = [await focused()];
    while (walked.at(-1) !== WAY.sentence.replace(/\.$/, "") && walked.length < 8) {
      await page.keyboard.press("Tab");
      walked.push(await focused());
    }
    assert.deepEqual(walked, ["Verify", "Save part", "Check by itself", WAY.sentence.replace(/\.$/, "")]);
    await page.keyboard.press("Enter");
    await until(async () => (await page.locator(".ways-out button").count()) === 0, "the end of what is done");
    assert.ok(await page.evaluate(() => document.activeElement.closest(".verdict-line") !== null), "the focus stays in the verdict");
    await page.getByRole("button", { name: "Save part" }).focus();
    await page.keyboard.press("Enter");
    assert.equal(await focused(), "Part to make");
    await page.keyboard.press("Tab");
    assert.equal(await focused(), "Coupon");
    await closePage(page);
  });

  it("draw a strand by the keyboard", async () => {
    const weave = await WeavePage.open(browser, server.url, "", STILL);
    const { page } = weave;
    await page.getByLabel("Pattern").selectOption("layout");
    await until(async () => (await weave.crossings.count()) === 1, "the first layout");
    await page.getByLabel("Pattern").focus();
    await weave.button("Draw a strand").focus();
    await page.keyboard.press("Tab");
    await page.keyboard.press("Shift+Tab");
    await page.keyboard.press("Enter");
    const isAtEntry = () => page.evaluate(() => document.activeElement.labels?.[0]?.textContent === "Add a point by its coordinates (mm)");
    assert.ok(await isAtEntry(), "the field for points has the focus");
    for (const point of ["2, 2", "8, 2"]) {
      await page.keyboard.type(point);
      await page.keyboard.press("Enter");
    }
    await weave.button("End").focus();
    await page.keyboard.press("Enter");
    await page.getByRole("button", { name: "Remove strand 3" }).waitFor();
    assert.equal(await page.evaluate(() => document.activeElement.textContent), "Draw a strand");
    await closePage(page);
  });
});
