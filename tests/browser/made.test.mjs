// Material, orientation, size and limits of a design, given by the user or chosen by the search.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { DesignPage, number, withDesign } from "./design_page.mjs";
import { browser, closePage, picture, server, setUp, until } from "./harness.mjs";

setUp();

class MadePage extends DesignPage {
  static async open(browser, url, options) {
    const made = await super.open(browser, url, options);
    await made.card.locator("summary").click();
    return made;
  }

  get card() {
    return this.page.locator("details.made");
  }

  /** Enters a value into a field and waits for the answer. */
  async write(label, value) {
    await this.fill(label, value);
    await this.settled();
  }

  async fill(label, value) {
    await this.card.getByLabel(label, { exact: true }).fill(String(value));
    await this.page.keyboard.press("Tab");
  }

  async choose(label) {
    await this.card.getByLabel(label, { exact: true }).check();
    await this.settled();
  }

  value(label) {
    return this.card.getByLabel(label, { exact: true }).inputValue();
  }

  /** The value of a term in the card of the result; undefined if the term is missing. */
  async fact(term) {
    const rows = this.page.locator(".result .facts dt", { hasText: new RegExp(`^${term}$`) });
    return (await rows.count()) === 0 ? undefined : rows.locator("+ dd").textContent();
  }
}

function withPage(act, options) {
  return withDesign(act, { Kind: MadePage, ...options });
}

/** The address of the page with a target that is `times` times as stiff. */
async function stiffer(times) {
  const design = await DesignPage.open(browser, server.url);
  const { page } = design;
  await until(() => page.url().includes("points="), "the link in the address");
  const address = page.url().replace(/points=([^&]*)/, (_, points) => {
    const scaled = points.split(";").map((point) => point.split(",").map(Number)).map(([x, y]) => `${x},${times * y}`);
    return `points=${scaled.join(";")}`;
  });
  await closePage(page);
  return address;
}

describe("the material", () => {
  it("is found between two moduli for a target that is ten times as stiff", async () => {
    const address = await stiffer(10);
    await withPage(async (design, page) => {
      assert.equal(await design.fact("Young’s modulus"), "26 MPa");
      const before = await design.deviation();
      assert.ok(before > 15, `no design of this material is so stiff: ${before} %`);
      await design.choose("Find it: Young’s modulus");
      await design.write("Young’s modulus at most, MPa", 900);
      assert.deepEqual(page.designs.asked.at(-1).material, { youngs_modulus: [13, 900] });
      const modulus = number(await design.fact("Young’s modulus"));
      assert.ok(modulus > 26 && modulus <= 900, `${modulus} MPa`);
      assert.ok((await design.deviation()) < 6, `${await design.deviation()} %`);
      await design.card.scrollIntoViewIfNeeded();
      await picture(page, "made-range");
      // The link has both the range and the modulus that was found.
      await until(() => /modulus=13,900&.*found-modulus=\d/.test(page.url()), "the modulus in the link");
      // Parameters set by hand keep the modulus that was found.
      const asked = page.waitForRequest((request) => request.url().endsWith("/v1/profiles"));
      await page.locator(".parameters input[type=range]").first().focus();
      await page.keyboard.press("ArrowRight");
      assert.equal(number(await design.fact("Young’s modulus")), modulus);
      assert.ok(Math.abs((await asked).postDataJSON().material.youngs_modulus / modulus - 1) < 0.005);
      await design.settled();
      await page.keyboard.press("Control+z");
      await design.settled();
      await page.keyboard.press("Control+z");
      await until(async () => (await design.value("Young’s modulus at most, MPa")) === "52", "the range before");
      await page.keyboard.press("Control+z");
      await until(async () => !(await design.card.getByLabel("Young’s modulus at most, MPa").isVisible()), "the modulus that was given");
      await design.settled();
      assert.equal(await design.value("Young’s modulus, MPa"), "26");
      assert.equal(await design.fact("Young’s modulus"), "26 MPa");
    }, { url: address });
  });

  it("is one of a list, lies as it is told, and is what a part is made of", () =>
    withPage(async (design, page) => {
      const part = page.locator("details.part");
      await part.locator("summary").click();
      assert.equal(await part.getByLabel("Wall thickness, mm").inputValue(), "0.3");
      await design.card.getByLabel("Material", { exact: true }).selectOption("PLA");
      await design.settled();
      assert.equal(await design.fact("Young’s modulus"), "2500 MPa");
      await design.write("Orientation, °", 30);
      const asked = page.waitForRequest((request) => request.url().endsWith("/v1/parts") && request.postDataJSON().beam_width === 0.5);
      await design.write("Beam width, mm", 0.5);
      assert.deepEqual([await design.fact("Orientation"), await design.fact("Beam width")], ["30°", "0.5 mm"]);
      const cell = number(await design.fact("Cell size"));
      const [share, density] = [number(await design.fact("Relative density")) / 100, number(await design.fact("Density"))];
      assert.ok(Math.abs(density - 1.24 * share) < 0.01 * 1.24, `${density} of ${share}`);
      const request = (await asked).postDataJSON();
      assert.deepEqual([request.material, request.orientation, request.direction], [{ density: 1.24 }, Math.PI / 6, 0]);
      // The coupon is loaded in the direction of the target. The user may choose another direction, or none.
      assert.equal(await part.getByLabel("Loaded along, °").inputValue(), "0");
      assert.match(await part.locator(".part-turn").textContent(), /^Turned by 90 degrees so that the design’s load runs along the part: it is loaded as it was designed/);
      const colour = (place) => place.evaluate((element) => getComputedStyle(element).color);
      assert.equal(await colour(part.locator(".part-turn")), await colour(part.locator(".part-size")), "it is no warning");
      await until(async () => /along the design’s 0°/.test(await part.locator(".facts").textContent()), "what the part tests");
      await part.getByLabel("Loaded along, °").fill("");
      await part.getByLabel("Loaded along, °").press("Enter");
      await until(async () => /along the design’s 90°/.test(await part.locator(".facts").textContent()), "the design's own 90°");
      assert.equal(await part.getByLabel("Wall thickness, mm").inputValue(), "0.5");
      assert.match(await page.locator(".tiling > g").getAttribute("transform"), /^rotate\(-(30|29\.9)/);
      await picture(page, "made-given");
      const structure = page.locator("main .menu", { has: page.locator("summary", { hasText: "Export" }) }).getByText("Drawing (SVG)");
      assert.match(await structure.getAttribute("href"), /&beam_width=0\.5&/);
      // A given cell size results in another beam width, which the part uses, too.
      await design.choose("Cell size");
      assert.ok(Math.abs(Number(await design.value("Cell size, mm")) / cell - 1) < 0.01, "it begins with the cells at hand");
      await design.write("Cell size, mm", 2 * cell);
      assert.ok(Math.abs(number(await design.fact("Cell size")) / (2 * cell) - 1) < 0.01);
      await until(async () => Math.abs(Number(await part.getByLabel("Wall thickness, mm").inputValue()) / number(await design.fact("Beam width")) - 1) < 0.01, "walls of the part");
      const menu = page.locator("main .menu", { has: page.locator("summary", { hasText: "Copy as" }) });
      await menu.locator("summary").click();
      await menu.getByText("Command line").click();
      assert.match(await menu.locator("textarea").inputValue(), /--youngs-modulus="2500" \\\n {2}--density="1\.24" \\\n {2}--orientation="30deg" \\\n {2}--cell-size=/);
      // The server accepts the copied request.
      await menu.getByText("curl").click();
      const body = /-d '(.*)'\n$/.exec(await menu.locator("textarea").inputValue())[1];
      const answer = await fetch(`${server.url}/v1/designs`, { method: "POST", headers: { "Content-Type": "application/json" }, body });
      assert.equal(answer.status, 200);
      assert.equal((await answer.json()).material.youngs_modulus, 2500);
    }));

  it("is the one of several that serves the target best", async () => {
    const address = await stiffer(60);
    await withPage(async (design, page) => {
      await design.card.getByLabel("Material", { exact: true }).selectOption("Several: the search chooses");
      await design.settled();
      assert.deepEqual(page.designs.asked.at(-1).material.map((one) => one.name), ["TPU", "PLA", "PETG", "ABS", "PA12"]);
      assert.ok(await design.card.getByLabel("Density of the material, g/cm³").isHidden(), "each has a density of its own");
      // The target is 60 times as stiff as with the models' material of 26 MPa, which corresponds to 1560 MPa.
      assert.deepEqual([await design.fact("Material"), await design.fact("Young’s modulus")], ["PA12", "1600 MPa"]);
      assert.match(await design.card.locator("summary").textContent(), /5 materials/);
      const [share, density] = [number(await design.fact("Relative density")) / 100, number(await design.fact("Density"))];
      assert.ok(Math.abs(density - 1.01 * share) < 0.006, `${density} of ${share}`);
      await until(() => /materials=name%3DTPU.*found-material=PA12&found-modulus=1600/.test(page.url()), "the materials in the link");
      // After the chosen material was removed, the search chooses another one, with a modulus within its range.
      await design.card.getByRole("button", { name: "Remove material 5" }).click();
      await design.settled();
      await design.write("Young’s modulus of TPU at most, MPa", 1570);
      assert.deepEqual(page.designs.asked.at(-1).material[0], { name: "TPU", youngs_modulus: [26, 1570], density: 1.21 });
      assert.equal(await design.fact("Material"), "TPU");
      const modulus = number(await design.fact("Young’s modulus"));
      assert.ok(modulus > 1400 && modulus <= 1570, `${modulus} MPa`);
      await design.card.getByRole("button", { name: "Add a material" }).click();
      assert.equal(await page.evaluate(() => document.activeElement.value), "PA12", "the one that is missing, ready to be named otherwise");
      await design.settled();
      await design.card.scrollIntoViewIfNeeded();
      await picture(page, "made-materials");
      const asked = page.designs.asked.length;
      await design.fill("Name of material 5", "PLA");
      assert.match(await design.card.locator(".note.problem:visible").textContent(), /^Each material has a name of its own/);
      assert.equal(page.designs.asked.length, asked, "nothing was asked for");
      await design.fill("Name of material 5", "PA12");
      // Parameters set by hand keep the material that was found.
      const profile = page.waitForRequest((request) => request.url().endsWith("/v1/profiles"));
      await page.locator(".parameters input[type=range]").first().focus();
      await page.keyboard.press("ArrowRight");
      assert.ok((await profile).postDataJSON().material.youngs_modulus > 1400);
      await design.settled();
      const link = page.url();
      const theirs = await MadePage.open(browser, link);
      await theirs.settled();
      assert.equal(await theirs.value("Name of material 4"), "ABS");
      await closePage(theirs.page);
      await design.card.getByLabel("Material", { exact: true }).selectOption("PLA");
      await design.settled();
      assert.equal(await design.fact("Young’s modulus"), "2500 MPa");
      assert.equal(await design.fact("Material"), undefined);
    }, { url: address });
  });

  it("that is left to the search is told of each family, and curves of families are laid over with theirs", async () => {
    const address = await stiffer(4);
    await withPage(async (design, page) => {
      await page.locator(".ranking li").nth(1).waitFor();
      assert.equal(await page.locator(".rank-material").count(), 0, "a modulus that was given needs no saying");
      await design.choose("Find it: Young’s modulus");
      await design.write("Young’s modulus at most, MPa", 400);
      const row = page.locator(".rank:not([aria-current])").first();
      const [other, words] = [await row.locator(".rank-name").textContent(), await row.locator(".rank-material").textContent()];
      assert.match(words, /^[\d.]+ MPa$/);
      assert.ok(number(words) >= 13 && number(words) <= 400, words);
      const mine = await page.locator(".rank[aria-current] .rank-material").textContent();
      assert.equal(mine, await design.fact("Young’s modulus"));
      const asked = page.waitForRequest((request) => request.url().endsWith("/v1/profiles"));
      await page.getByRole("button", { name: `Overlay the curve of ${other}` }).click();
      assert.ok(Math.abs((await asked).postDataJSON().material.youngs_modulus / number(words) - 1) < 0.005, "its own modulus");
      const entry = page.locator(".legend li", { hasText: `${other} of ${words}` });
      await entry.waitFor();
      assert.equal(await page.locator(".plot .curve.pin").count(), 1);
      await picture(page, "made-overlay");
      await page.getByRole("button", { name: `Overlay the curve of ${other}` }).click();
      await until(async () => (await entry.count()) === 0, "the curve to go");
      // When the family is shown, its search starts with the modulus of the ranking.
      const before = page.designs.asked.length;
      await row.click();
      await until(() => page.designs.asked.length > before, "a search of that family");
      await until(() => page.url().includes(`design=${other}`) && page.url().includes("found-modulus="), "its modulus in the link");
      await design.settled();
    }, { url: address });
  });

  it("is of the design of the region in sight", () =>
    withPage(async (design, page) => {
      await design.write("Young’s modulus, MPa", 60);
      await page.getByTitle("Divide the product into regions").click();
      await page.locator(".regions-card li").nth(1).waitFor();
      await design.settled();
      await design.write("Young’s modulus, MPa", 40);
      assert.equal(await design.fact("Young’s modulus"), "40 MPa");
      await page.getByRole("tablist", { name: "Regions of the product" }).getByRole("tab").first().click();
      await until(async () => (await design.value("Young’s modulus, MPa")) === "60", "the first region's modulus");
      assert.equal(await design.fact("Young’s modulus"), "60 MPa");
      await design.button("Search all regions").click();
      await until(() => page.designs.asked.at(-1).regions !== undefined, "a request for all regions");
      assert.deepEqual(page.designs.asked.at(-1).regions.map((region) => region.material), [{ youngs_modulus: 60 }, { youngs_modulus: 40 }]);
      await design.settled();
    }));
});

describe("limits", () => {
  it("of density are kept, and where no design keeps them the page says so", () =>
    withPage(async (design, page) => {
      const before = number(await design.fact("Relative density"));
      const most = Math.round(0.8 * before);
      await design.write("Relative density at most, %", most);
      assert.deepEqual(page.designs.asked.at(-1).limits, { relative_density: [0, most / 100] });
      const after = number(await design.fact("Relative density"));
      assert.ok(after <= most && after < before, `${after} % of at most ${most} %, ${before} % without`);
      await picture(page, "made-limit");
      await design.fill("Relative density at most, %", 0.5);
      const note = design.status.locator(".note");
      await note.waitFor();
      assert.match(await note.textContent(), /keeps within the limits\. .*Its relative density is 0\.\d+, above the greatest one asked for, 0\.005\./);
      await picture(page, "made-beyond");
      await design.write("Relative density at most, %", "");
      assert.equal(page.designs.asked.at(-1).limits, undefined);
      assert.ok(number(await design.fact("Relative density")) > most);
    }));

  it("of beams are those of cells of a given size", () =>
    withPage(async (design, page) => {
      assert.equal(await design.card.getByLabel("Beam width at least, mm").isVisible(), false);
      await design.choose("Cell size");
      const width = number(await design.fact("Beam width"));
      const least = Number((1.2 * width).toPrecision(3));
      await design.write("Beam width at least, mm", least);
      assert.deepEqual(page.designs.asked.at(-1).limits, { beam_width: [least, 100] });
      assert.ok(number(await design.fact("Beam width")) >= least, `${await design.fact("Beam width")} of at least ${least}`);
    }));

  it("of cells are those of beams of a given width, and of parameters set by hand all is measured", () =>
    withPage(async (design, page) => {
      const [before, share, density] = [number(await design.fact("Cell size")), await design.fact("Relative density"), await design.fact("Density")];
      const most = Number((0.9 * before).toPrecision(3));
      await design.write("Cell size at most, mm", most);
      assert.deepEqual(page.designs.asked.at(-1).limits, { cell_size: [0, most] });
      const after = number(await design.fact("Cell size"));
      assert.ok(after <= most, `${after} mm of at most ${most} mm`);
      assert.notEqual(await design.fact("Relative density"), share);
      await until(() => page.url().includes(`cell-sizes=0,${most}`), "the limit in the link");
      await design.choose("Cell size");
      assert.ok(await design.card.getByLabel("Cell size at most, mm").isHidden(), "cells of a given size have no limit");
      assert.equal(page.designs.asked.at(-1).limits, undefined);
      await design.choose("Beam width");
      // After parameters were set with a slider, the card shows the same terms as after a search.
      const [cell, parameter] = [number(await design.fact("Cell size")), Number(await page.locator(".parameters .number").first().inputValue())];
      const structureAsked = page.waitForRequest((request) => request.url().endsWith("/v1/structures") && request.postDataJSON().parameters[0] === parameter - 0.05);
      await page.locator(".parameters .number").first().fill(String(parameter - 0.05));
      await page.keyboard.press("Enter");
      await until(async () => (await page.locator(".result .chip").textContent()) === "Set by hand", "word of it");
      const [byHand, relative] = [await design.fact("Density"), await design.fact("Relative density")];
      assert.ok(byHand !== undefined && byHand !== density, `${byHand} instead of ${density}`);
      assert.ok(Math.abs(number(byHand) - 1.2 * number(relative) / 100) < 0.01, `${byHand} at ${relative}`);
      assert.notEqual(number(await design.fact("Cell size")), cell);
      const measured = [await design.fact("Cell size"), byHand];
      // A search gives the same measures for the same structure.
      const { parameters } = (await structureAsked).postDataJSON();
      const answer = await fetch(`${server.url}/v1/designs`, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({
        beam_width: Number(await design.value("Beam width, mm")), task: "stress_strain", family: await design.family(), fixed: parameters, initial: parameters, target: { control_points: [[0, 0], [0.1, 0.01]] },
      }) });
      const { structure } = await answer.json();
      assert.deepEqual([number(measured[0]), number(measured[1])], [structure.cell_size, structure.density].map((value) => Number(value.toPrecision(3))));
    }));

  it("that no server would take are refused where they stand", () =>
    withPage(async (design, page) => {
      const asked = page.designs.asked.length;
      await design.fill("Young’s modulus, MPa", -5);
      const problem = design.card.locator(".note.problem:visible");
      assert.equal(await problem.textContent(), "Young’s modulus is a number from 0.000001 MPa to 1,000,000 MPa.");
      assert.equal(await design.card.getByLabel("Young’s modulus, MPa", { exact: true }).getAttribute("aria-invalid"), "true");
      await picture(page, "made-refused");
      await design.fill("Young’s modulus, MPa", 26);
      assert.equal(await problem.count(), 0);
      await design.fill("Relative density from, %", 120);
      assert.match(await problem.textContent(), /from 0 % to 100 %/);
      await design.fill("Relative density from, %", "");
      assert.equal(await problem.count(), 0);
      assert.equal(page.designs.asked.length, asked, "nothing was asked for");
    }));

  it("and the rest fit a small screen", () =>
    withPage(async (design, page) => {
      await design.choose("Find it: Young’s modulus");
      await design.choose("Find it: orientation");
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "no scrolling to the side");
      await design.card.scrollIntoViewIfNeeded();
      await picture(page, "made-small");
    }, { viewport: { width: 390, height: 844 } }));
});
