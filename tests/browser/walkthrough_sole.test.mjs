// Walkthrough: a sole from a drawing with three curves to a 3MF file with three objects (docs/walkthroughs/sole.md).
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { withDesign } from "./design_page.mjs";
import { setUp, until } from "./harness.mjs";
import { fileOf, PATIENCE_MS, savedFile, step, WINDOW } from "./walkthrough.mjs";
import { unzipped } from "./zip.mjs";

setUp();

describe("the walkthrough of a sole", () => {
  it("makes regions of the curves of a drawing, gives each a response, and saves an object for each", () =>
    withDesign(async (design, page) => {
      const part = page.locator("details.part");
      const tabs = page.getByRole("tablist", { name: "Regions of the product" }).getByRole("tab");
      const write = async (label, value) => {
        await part.getByLabel(label, { exact: true }).fill(String(value));
        await page.keyboard.press("Tab");
      };
      await design.drop(".plot-card .stage", await fileOf("sole.svg"), "sole.svg");
      await until(async () => /sole\.svg: 3 closed curves, 100 × 270 mm/.test(await part.textContent()), "the drawing", PATIENCE_MS);
      await part.getByRole("button", { name: "Make 3 regions" }).waitFor();
      await step(page, "sole-1-drawing", part);
      await part.getByRole("button", { name: "Make 3 regions" }).click();
      await until(async () => (await tabs.count()) === 3, "three regions");
      const names = await tabs.locator(".tab-name").allTextContents();
      assert.deepEqual([...names].sort(), ["Rest", "forefoot", "heel"]);

      // The heel stays as it is; the other regions are made softer by a lower end of their curves.
      for (const [name, down] of [["Rest", 40], ["forefoot", 80]]) {
        await tabs.filter({ hasText: name }).click();
        await design.settled(PATIENCE_MS);
        await design.drag((await design.handles.count()) - 1, 0, down);
        await design.settled(PATIENCE_MS);
      }
      await step(page, "sole-2-regions");
      await write("Width of the drawing, mm", 50);
      await write("Frame, mm", 1.2);
      await write("Thickness, mm", 8);
      await until(async () => /Size41\.6 × 129 × 8 mm/.test(await part.locator(".facts").textContent()), "the part", PATIENCE_MS);
      await step(page, "sole-3-part", part.locator(".part-size"));

      const { name, bytes } = await savedFile(page, () => part.getByRole("button", { name: "3MF" }).click());
      assert.match(name, /\.3mf$/);
      const model = unzipped(bytes).get("3D/3dmodel.model").toString();
      // One object holds the three at their places.
      const objects = [...model.matchAll(/<object[^>]*name="([^"]*)"[^>]*>\s*<mesh>/g)].map((match) => match[1]);
      assert.deepEqual([...objects].sort(), ["Rest", "forefoot", "heel"]);
      assert.equal((model.match(/<component /g) ?? []).length, 3, "each is in its place");
    }, { ...WINDOW }));
});
