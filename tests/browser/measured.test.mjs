// From measured data to a part: a file of 500 rows is dropped onto the plot, and a coupon is saved.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { describe, it } from "node:test";
import { withDesign } from "./design_page.mjs";
import { picture, setUp, until } from "./harness.mjs";
import { watertight } from "./stl.mjs";

setUp();

const stress = (strain) => 0.02 * strain + 0.002 * (Math.exp(18 * strain) - 1);

/** A table in the format of a tensile tester: semicolons, decimal commas, a remark and a header. */
function table(rows = 500) {
  const number = (value) => value.toFixed(5).replace(".", ",");
  const lines = Array.from({ length: rows }, (_, k) => (0.15 * k) / (rows - 1)).map((strain) => `${number(100 * strain)};${number(1000 * stress(strain))}`);
  return ["Tensile test 17", "", "Strain [%];Stress [kPa]", ...lines].join("\r\n");
}

describe("measured data", () => {
  it("becomes the target when its file is dropped, a part of the design is saved, and the data may be read otherwise", () =>
    withDesign(async (design, page) => {
      await design.drop(".plot-card .stage", table(), "tensile.csv");
      const card = page.locator("details.measured");
      await until(async () => (await page.locator("path.measured").getAttribute("d"))?.startsWith("M"), "the measured points");
      await card.locator("summary").click();
      await until(async () => /follow 500 measured ones within/.test(await card.textContent()), "what the reduction did");
      await design.settled();
      const dots = (await page.locator(".plot path.measured").getAttribute("d")).split("M").length - 1;
      assert.equal(dots, 500);
      const values = await design.values();
      const [strain, target] = values.at(-1);
      assert.ok(Math.abs(strain - 0.15) < 1e-3 && Math.abs(target - stress(0.15)) < 0.02 * stress(0.15), `${strain}, ${target}`);
      assert.match(await page.locator(".legend").textContent(), /Measured/);
      await picture(page, "design-measured");

      const part = page.locator("details.part");
      await part.locator("summary").click();
      await part.getByLabel("Width, mm").fill("12");
      await part.getByLabel("Each grip, mm").fill("8");
      // With walls of 0.8 mm the tiles are as wide as the coupon and do not connect its grips; with walls of a fine nozzle they do.
      await part.getByLabel("Wall thickness, mm").fill("0.8");
      await part.getByLabel("Wall thickness, mm").press("Tab");
      await part.locator(".part-result .note", { hasText: "grip is missing" }).waitFor();
      await picture(page, "design-part-broken");
      await part.getByLabel("Wall thickness, mm").fill("0.3");
      await part.getByLabel("Wall thickness, mm").press("Tab");
      await until(async () => /12 × 76 × 1 mm/.test(await part.locator(".facts").textContent()), "the part's size");
      assert.equal(await part.locator(".part-result .note").textContent(), "");
      await part.locator(".part-drawing").scrollIntoViewIfNeeded();
      await picture(page, "design-part");
      const saved = page.waitForEvent("download");
      await part.getByRole("button", { name: "STL" }).click();
      const file = await saved;
      assert.match(file.suggestedFilename(), /^supple-IH\d+-12x76x1mm\.stl$/);
      const { size } = watertight(await readFile(await file.path()));
      [12, 76, 1].forEach((wanted, k) => assert.ok(Math.abs(size[k] - wanted) < 1e-4, `${size}`));

      await card.getByLabel("Unit of stress").selectOption("N");
      await card.getByLabel("Cross-section, mm²").waitFor();
      assert.match(await card.textContent(), /cross-section/);
      await card.getByLabel("Cross-section, mm²").fill("20");
      await card.getByLabel("Cross-section, mm²").press("Tab");
      await until(async () => /follow 500 measured ones/.test(await card.textContent()), "the curve of forces");
      await design.settled();
      assert.ok(Math.abs((await design.values()).at(-1)[1] - 50 * stress(0.15)) < stress(0.15), "1000 stress N on 20 mm^2");

      await design.drop(".plot-card .stage", "no numbers here", "notes.txt");
      await until(async () => /notes\.txt: .*two numbers/.test(await card.textContent()), "why the file was refused");
      await card.getByRole("button", { name: "Remove" }).click();
      await until(async () => !(await page.locator("path.measured").getAttribute("d")), "the points to go");
    }));

  it("asks for the units, the size of the specimen and the sense where the file does not tell them", () =>
    withDesign(async (design, page) => {
      const card = page.locator("details.measured");
      const rows = Array.from({ length: 60 }, (_, k) => `${k};${(0.1 * k).toFixed(3)};${(20 * stress((0.1 * k) / 50)).toFixed(6)}`);
      await design.drop(".plot-card .stage", ["Zeit;Weg;Kraft", ...rows].join("\n"), "forces.csv");
      // The card opens with the fields that the user has to complete; none of them has a value yet.
      await card.getByLabel("Unit of strain").waitFor();
      assert.match(await card.textContent(), /The unit of strain must be one of 1, %.*names no unit of column 1 "Weg"/);
      assert.equal(await card.getByLabel("Unit of strain").inputValue(), "");
      await card.getByLabel("Unit of strain").selectOption("mm");
      await until(async () => /The unit of stress must/.test(await card.textContent()) && !/The unit of strain must/.test(await card.textContent()), "the question for the other unit");
      await card.getByLabel("Unit of stress").selectOption("N");
      await card.getByLabel("Cross-section, mm²").fill("20");
      await card.getByLabel("Cross-section, mm²").press("Tab");
      await card.getByLabel("Gauge length, mm").fill("50");
      await card.getByLabel("Gauge length, mm").press("Tab");
      await until(async () => /follow 60 measured ones/.test(await card.textContent()), "the curve");
      assert.match(await card.textContent(), /was the specimen pulled or pressed/);
      assert.doesNotMatch(await card.textContent(), /assumed/, "what is asked is not said to be assumed");
      assert.equal(await card.getByRole("radio", { checked: true }).count(), 0, "nobody has chosen yet");
      await picture(page, "design-measured-question");
      await card.getByLabel("Compression", { exact: true }).check();
      await until(async () => /follow 60 measured ones/.test(await card.textContent()) && !/assumed/.test(await card.textContent()), "the curve of a compression");
      await design.settled();
      assert.ok((await design.values())[0][0] < -0.1, "a compression has negative strains");
      assert.ok(await card.getByLabel("Compression", { exact: true }).isChecked(), "the switch stays");
      assert.doesNotMatch(await card.textContent(), /pulled or pressed/);

      const cycle = [...Array(30).keys(), ...[...Array(28).keys()].reverse()].map((e) => `${e};${9 * e}`);
      await design.drop(".plot-card .stage", ["Zugversuch", "Dehnung [%];Spannung [kPa]", ...cycle].join("\n"), "cycle.csv");
      await until(async () => /28 points were set aside/.test(await card.locator(".warnings").textContent()), "the warning in its colour");
      await picture(page, "design-measured-warning");
    }));

  it("shows what is asked for next, whether the answers come before, between or after what somebody writes", async () => {
    const rows = Array.from({ length: 60 }, (_, k) => `${k};${(0.1 * k).toFixed(3)};${(20 * stress((0.1 * k) / 50)).toFixed(6)}`);
    // `ahead`: how many of the two sizes are entered before the server's answers arrive.
    for (const ahead of [0, 1, 2])
      await withDesign(async (design, page) => {
        const card = page.locator("details.measured");
        await design.drop(".plot-card .stage", ["Zeit;Weg [mm];Kraft [N]", ...rows].join("\n"), "forces.csv");
        await card.getByLabel("Cross-section, mm²").waitFor();
        const held = [];
        let holds = true;
        await page.route("**/v1/measured-curves", (route) => (holds ? held.push(route) : route.continue()));
        const release = async () => {
          holds = false;
          for (const route of held.splice(0)) await route.continue().catch(() => {}); // the page has aborted the earlier requests
        };
        if (ahead === 0) await release();
        await card.getByLabel("Gauge length, mm").fill("50");
        await card.getByLabel("Gauge length, mm").press("Tab");
        if (ahead === 1) {
          await until(() => held.length > 0, "the question about the first size");
          await card.getByLabel("Cross-section, mm²").fill("20");
          await release();
          await until(async () => !/gauge_length/.test(await card.textContent()), "the answer to the first size");
          assert.equal(await card.getByLabel("Cross-section, mm²").inputValue(), "20", "an answer takes away what is being written");
        } else {
          await card.getByLabel("Cross-section, mm²").fill("20");
        }
        await card.getByLabel("Cross-section, mm²").press("Shift+Tab");
        if (ahead === 2) {
          await until(() => held.length > 1, "the question about both sizes");
          await release();
        }
        await card.getByRole("group", { name: "What was measured" }).waitFor();
        assert.match(await card.textContent(), /follow 60 measured ones.*was the specimen pulled or pressed/);
        assert.equal(await page.evaluate(() => document.activeElement.labels?.[0].textContent), "Gauge length, mm", `${ahead}: the focus`);
        assert.equal(await card.getByLabel("Gauge length, mm").inputValue(), "50");
        assert.equal(await card.getByLabel("Cross-section, mm²").inputValue(), "20");
      });
  });
});
