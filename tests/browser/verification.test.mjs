// Simulations of designs at their native scale.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { DesignPage } from "./design_page.mjs";
import { browser, closePage, picture, server, setUp, until } from "./harness.mjs";

const SIMULATION_MS = 150_000;

setUp();

/** A design of one family with small strains, whose simulation is quick. */
const LINK = "#/design?task=stress_strain&family=IH29&direction=0&points=0,0;0.02,0.004;0.04,0.008&design=IH29&parameters=0.25";

describe("a verification", () => {
  it("shows its progress, the simulated curve and the deformed patch, and goes with the design", async () => {
    const design = await DesignPage.open(browser, server.url + "/" + LINK);
    const { page } = design;
    await design.button("Verify by simulation").click();
    await page.getByRole("progressbar", { name: "Progress of the simulation" }).waitFor();
    await page.locator(".verdict").waitFor({ timeout: SIMULATION_MS });
    assert.match(await page.locator(".verdict").textContent(), /differ by [\d.]+ %/);
    assert.ok((await page.locator(".plot .verified path").count()) >= 2);
    await page.locator(".patch canvas").waitFor({ timeout: SIMULATION_MS });
    const drawn = () => page.locator(".patch canvas").evaluate((canvas) => canvas.toDataURL());
    const largest = await drawn();
    await page.getByLabel("State of the load", { exact: true }).fill("0");
    assert.notEqual(await drawn(), largest, "another state of the load is another picture");
    assert.match(await page.locator(".patch canvas").getAttribute("aria-label"), /Green strain/);
    await picture(page, "design-verified");
    await design.drag(2, 0, -60);
    await until(async () => (await page.locator(".plot .verified path").count()) === 0, "the end of what no longer belongs");
    await design.settled();
    await closePage(page);
  });

  it("polishes the design until its simulation follows the target, and keeps the simulated curve", async () => {
    // The target is the network's response of another design, so that the simulated response differs from it a little.
    const x = [0, 0.02, 0.04];
    const asked = { task: "stress_strain", family: "IH29", direction: 0, parameters: [0.2], x };
    const headers = { "Content-Type": "application/json" };
    const profile = await (await fetch(`${server.url}/v1/profiles`, { method: "POST", headers, body: JSON.stringify(asked) })).json();
    const points = x.map((strain, i) => `${strain},${profile.y[i].toPrecision(6)}`).join(";");
    const link = LINK.replace(/points=[^&]*/, `points=${points}`);
    const design = await DesignPage.open(browser, server.url + "/" + link);
    const { page } = design;
    const before = page.url();
    await design.button("Polish by simulation").click();
    await page.locator(".verdict").waitFor({ timeout: SIMULATION_MS });
    const verdict = await page.locator(".verdict").textContent();
    assert.match(verdict, /The simulation is [\d.]+ % from the target \(rms\), [\d.]+ % before it was polished in \d+ rounds?/);
    const [after, unpolished] = [...verdict.matchAll(/([\d.]+) %/g)].map((match) => Number(match[1]));
    assert.ok(after < unpolished, verdict);
    await design.settled();
    assert.notEqual(page.url(), before, "the parameters are the corrected ones");
    assert.ok((await page.locator(".plot .verified path").count()) >= 2, "the curve belongs to the corrected design");
    await page.locator(".patch canvas").waitFor({ timeout: SIMULATION_MS });
    await picture(page, "design-polished");
    await closePage(page);
  });

  it("can be cancelled, and its job is dismissed", async () => {
    const design = await DesignPage.open(browser, server.url + "/" + LINK);
    const { page } = design;
    await design.button("Verify by simulation").click();
    await until(async () => (await (await fetch(`${server.url}/v1/jobs?limit=1`)).json()).jobs[0]?.kind === "designs", "the job");
    await page.locator(".verification").getByRole("button", { name: "Cancel" }).click();
    await design.button("Verify by simulation").waitFor();
    await until(async () => (await (await fetch(`${server.url}/v1/jobs?limit=1`)).json()).jobs[0]?.state === "dismissed", "the job’s dismissal");
    await closePage(page);
  });
});
