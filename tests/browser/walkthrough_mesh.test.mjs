// Walkthrough: a mesh of one's own, a network that comes to rest on it, and cells that are optimized (docs/walkthroughs/mesh.md).
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { browser, closePage, openPage, server, setUp, until } from "./harness.mjs";
import { fileOf, PATIENCE_MS, savedFile, step, WINDOW } from "./walkthrough.mjs";

setUp({ webgl: true });

const button = (page, name) => page.getByRole("button", { name, exact: true });

describe("the walkthrough of a mesh", () => {
  it("opens a file, relaxes a network on it, optimizes cells, and saves both", async () => {
    const page = await openPage(browser, `${server.url}/#/mesh`, WINDOW);
    await page.getByText("Open a mesh").waitFor();
    await page.locator('input[type="file"]').setInputFiles({ name: "canopy.obj", mimeType: "model/obj", buffer: Buffer.from(await fileOf("canopy.obj")) });
    await page.locator(".facts").getByText("Handles").waitFor();
    await step(page, "mesh-1-opened");

    const network = page.locator(".relaxation:not(.voronoi)");
    await page.getByRole("radio", { name: "Network", exact: true }).check();
    await button(page, "Make the network").click();
    await until(() => button(page, "Make the network").isDisabled(), "the network", PATIENCE_MS);
    await step(page, "mesh-2-network");
    // A net of springs that only pull would shrink to one point, which the page says before.
    await page.getByText("This network will shrink to one point").waitFor();
    await button(page, "Fix six points").click();
    await button(page, "Relax").click();
    await network.locator(".stop", { hasText: /at rest|limit|equally short/ }).waitFor({ timeout: PATIENCE_MS });
    const energy = Number(await network.locator(".facts dt", { hasText: /^Energy$/ }).locator("+ dd").textContent());
    assert.ok(energy > 1e-3, `a net between the points that are held, with the energy ${energy}`);
    await step(page, "mesh-3-relaxed");
    const wires = (await savedFile(page, () => network.getByRole("button", { name: "OBJ", exact: true }).click())).bytes.toString();
    const points = (wires.match(/^v /gm) ?? []).length;
    assert.ok(points > 10 && /^l \d+ \d+/m.test(wires), `${points} points and their springs`);

    const card = page.getByLabel("Diagram", { exact: true });
    const rows = card.locator('[aria-label="Statistics"] tbody tr');
    await page.getByRole("radio", { name: "Voronoi", exact: true }).check();
    await button(page, "Scatter sites").click();
    await rows.first().waitFor({ timeout: PATIENCE_MS });
    await button(page, "Optimize").click();
    await card.locator(".stop", { hasText: /at rest|limit/ }).waitFor({ timeout: PATIENCE_MS });
    assert.equal(await rows.count(), 8, "four quantities before and after");
    await step(page, "mesh-4-cells");
    const cells = await savedFile(page, () => card.getByRole("button", { name: "OBJ", exact: true }).click());
    assert.equal(cells.name, "voronoi.obj");
    assert.match(cells.bytes.toString(), /^l \d+ \d+/m);
    await closePage(page);
  });
});
