// Walkthrough: from the table of a test to a coupon as STL (docs/walkthroughs/test-to-part.md).
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { withDesign } from "./design_page.mjs";
import { setUp, until } from "./harness.mjs";
import { watertight } from "./stl.mjs";
import { ALL_MODELS, fileOf, PATIENCE_MS, savedFile, step, WINDOW } from "./walkthrough.mjs";

setUp({ models: ALL_MODELS });

const OPTIONS = { ...WINDOW, background: true, firstVisit: true };

describe("the walkthrough from a test to a part", () => {
  it("reads a table, asks what the file does not say, simulates what it found, and saves a coupon", () =>
    withDesign(async (design, page) => {
      const verdict = page.locator(".verdict-words");
      const measured = page.locator("details.measured");
      const part = page.locator("details.part");
      await page.getByRole("region", { name: "What this is" }).waitFor();
      await step(page, "test-1-first-visit");

      await design.drop(".plot-card .stage", await fileOf("foam-strip.csv"), "foam-strip.csv");
      await measured.getByText("The file does not say it: was the specimen pulled or pressed?").waitFor({ timeout: PATIENCE_MS });
      await design.settled(PATIENCE_MS);
      await step(page, "test-2-question", measured);
      await measured.getByLabel("Tension", { exact: true }).check();
      await until(async () => !/The file does not say it/.test(await measured.textContent()), "the answer", PATIENCE_MS);
      await design.settled(PATIENCE_MS);
      assert.match(await measured.textContent(), /follow 61 measured ones within/);
      assert.equal(page.designs.asked.at(-1).strain_measure, "engineering");

      await until(async () => /^Simulated: reached/.test(await verdict.textContent()), "the simulation", PATIENCE_MS);
      assert.equal(await page.locator(".verdict-line").getAttribute("data-grade"), "reached");
      assert.equal(await page.locator(".plot .missed path").count(), 0, "nothing is marked as missed of a target that is reached");
      await step(page, "test-3-simulated", page.locator(".plot-card"));

      await design.button("Save part").click();
      await until(async () => /Size30 × 90 × 1 mm/.test(await part.locator(".facts").textContent()), "the part", PATIENCE_MS);
      assert.match(await part.textContent(), /Outer size with both grips: 30 × 90 × 1 mm/);
      assert.match(await part.locator(".part-turn").textContent(), /^Turned by 90 degrees so that the design’s load runs along the part/);
      await step(page, "test-4-part", part.locator(".part-size"));
      const { name, bytes } = await savedFile(page, () => part.getByRole("button", { name: "STL" }).click());
      assert.match(name, /^supple-IH\d+-30x90x1mm\.stl$/);
      const { size, volume } = watertight(bytes);
      [30, 90, 1].forEach((length, axis) => assert.ok(Math.abs(size[axis] - length) < 1e-3, `${size} mm`));
      assert.ok(volume > 2 * 15 * 30 && volume < 30 * 90, `${volume} mm^3 are two grips and beams between them`);
    }, OPTIONS));
});
