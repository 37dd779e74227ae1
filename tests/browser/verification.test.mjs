// Simulations of designs at their native scale.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { DesignPage } from "./design_page.mjs";
import { browser, closePage, heldJob, picture, server, setUp, until } from "./harness.mjs";

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
    await design.button("Undo (Ctrl+Z)").click();
    await design.settled();
    await until(async () => (await page.locator(".plot .verified path").count()) >= 2, "the simulated curve of the design that is back");
    assert.match(await page.locator(".verdict-words").textContent(), /^Simulated: /);
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
    const cancel = page.locator(".verification").getByRole("button", { name: "Cancel" });
    assert.ok(await cancel.evaluate((button) => button === document.activeElement), "the focus goes to what can be done next");
    await cancel.click();
    await design.button("Verify by simulation").waitFor();
    await until(async () => (await (await fetch(`${server.url}/v1/jobs?limit=1`)).json()).jobs[0]?.state === "dismissed", "the job’s dismissal");
    await closePage(page);
  });

  it("outranks the model in the line under the plot and in the card, also after a reload and for another size", async () => {
    const design = await DesignPage.open(browser, server.url + "/" + LINK);
    const { page } = design;
    assert.match(await page.locator(".verdict-words").textContent(), /^By the model: /);
    await design.button("Verify").click();
    await until(async () => /^Simulated: /.test(await page.locator(".verdict-words").textContent()), "the simulated verdict", SIMULATION_MS);
    const said = await page.locator(".verdict-words").textContent();
    assert.match(await page.locator(".result .chip").textContent(), /^Simulated: /);
    assert.match(await page.locator(".result .facts").textContent(), /Deviation, simulated \(rms\)/);
    await page.locator("details.made summary").click();
    await page.getByLabel("Beam width, mm", { exact: true }).fill("0.6");
    await page.keyboard.press("Tab");
    await design.settled();
    assert.equal(await page.locator(".verdict-words").textContent(), said, "the response does not depend on the size");
    await page.reload();
    await design.settled();
    await until(async () => (await page.locator(".verdict-words").textContent()) === said, "the same verdict after a reload");
    await picture(page, "design-verdict");
    await closePage(page);
  });

  it("begins by itself once the target rests, tells how far it is, and is dropped when the target changes", async () => {
    const design = await DesignPage.open(browser, server.url + "/" + LINK, { background: true });
    const { page } = design;
    // The first verification may have begun already: the held job is that of the next target.
    const isVerification = (request) => request.postDataJSON()?.verify === true;
    const job = await heldJob(page, "/v1/designs", isVerification);
    job.tell(0.4, "simulating");
    await design.drag(2, 0, -40);
    await until(async () => /^Checking by simulation, 40 %/.test(await page.locator(".verdict-state").textContent()), "word of it");
    assert.equal(page.designs.asked.filter((asked) => asked.verify).at(-1).priority, "background");
    // The next target has a check of its own, which tells the same.
    const isDismissal = (request) => request.method() === "DELETE" && request.url().endsWith("/v1/jobs/held");
    await Promise.all([page.waitForRequest(isDismissal), design.drag(2, 0, 30)]);
    await page.getByLabel("Check by itself").uncheck();
    await until(async () => !/40 %/.test(await page.locator(".verdict-state").textContent()), "the end of it");
    await page.reload();
    await design.settled();
    assert.equal(await page.getByLabel("Check by itself").isChecked(), false, "the choice is remembered");
    await closePage(page);
  });

  it("goes on when the page is left, and its job is found again", async () => {
    const design = await DesignPage.open(browser, server.url + "/" + LINK);
    const { page } = design;
    await design.button("Verify").click();
    // Searches of the page are jobs too where they take long, and are interactive.
    const jobs = async () => (await (await fetch(`${server.url}/v1/jobs?limit=1000`)).json()).jobs.filter(({ kind, priority }) => kind === "designs" && priority !== "interactive");
    await page.locator(".verdict-state", { hasText: /Checking/ }).waitFor();
    await until(async () => (await jobs()).some(({ finished }) => !finished), "the job");
    const before = new Set((await jobs()).map(({ id }) => id));
    await page.goto(`${server.url}/#/weave`);
    await page.reload();
    // The weave's page writes its link once it has begun, which would undo a change of the address at the same moment.
    await page.waitForURL(/#\/weave\?/);
    await page.goto(`${server.url}/${LINK}`);
    await page.reload();
    await until(async () => /^Simulated: /.test(await page.locator(".verdict-words").textContent()), "its result", SIMULATION_MS);
    assert.deepEqual((await jobs()).filter(({ id }) => !before.has(id)), [], "no other job was needed");
    await closePage(page);
  });
});

/** A verdict with its buttons as rows of text, from one line to three. */
const VERDICTS = [
  "Simulated: reached, 0.7 % off.",
  "Simulated: 45 % off. The plateau is reached from 8 to 20 %, the rise is not.",
  "Simulated: 45 % off. The plateau is reached from 8 to 20 %, the rise from 0 to 5 % is not, nor is what comes after 20 %, where the walls touch.",
];

describe("the verdict", () => {
  it("covers no part of the plot, and does not move it while a point is dragged", async () => {
    const design = await DesignPage.open(browser, server.url + "/" + LINK, { viewport: { width: 1280, height: 720 } });
    const { page } = design;
    const say = (words) =>
      page.evaluate(async (text) => {
        document.querySelector(".verdict-words").textContent = text;
        for (let k = 0; k < 3; ++k) await new Promise(requestAnimationFrame); // the height of the verdict becomes the plot's
      }, words);
    const box = (place) => page.locator(place).evaluate((element) => element.getBoundingClientRect().toJSON());
    for (const [width, height] of [[1280, 720], [1280, 800], [1440, 900]]) {
      await page.setViewportSize({ width, height });
      for (const words of VERDICTS) {
        await say(words);
        const [stage, plot, verdict] = [await box(".stage"), await box(".stage .plot"), await box(".verdict-line")];
        const where = `${width} by ${height}, "${words}": ${JSON.stringify({ stage, plot, verdict })}`;
        assert.ok(stage.top > 0 && stage.bottom <= verdict.top && plot.bottom <= stage.bottom + 1, `the plot with its axes ends above the verdict, ${where}`);
        assert.ok(verdict.bottom <= height, `the verdict is in sight, ${where}`);
        assert.ok(stage.height >= 220, `the plot can be used, ${where}`);
      }
    }
    await page.setViewportSize({ width: 1280, height: 720 });
    await say(VERDICTS[0]);
    const { height } = await box(".stage");
    await design.drag(2, 0, -20, async () => {
      await page.locator(".verdict-line").evaluate((line) => (line.style.minHeight = "200px"));
      await page.waitForTimeout(100);
      assert.equal((await box(".stage")).height, height, "the plot keeps its height under the pointer");
    });
    await until(async () => (await box(".stage")).height < height, "the room for the verdict after the drag");
    await closePage(page);
  });

  for (const [width, height] of [[1280, 720], [390, 844]]) {
    it(`is in sight with its buttons in a window of ${width} by ${height}`, async () => {
      const design = await DesignPage.open(browser, server.url + "/" + LINK, { viewport: { width, height } });
      const { page } = design;
      for (const place of [page.locator(".verdict-words"), design.button("Verify"), design.button("Save part")]) {
        const box = await place.boundingBox();
        assert.ok(box && box.y >= 0 && box.y + box.height <= height, `${JSON.stringify(box)} is above the fold`);
      }
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "no scrolling to the side");
      await picture(page, `design-verdict-${width}`);
      await design.button("Save part").click();
      assert.equal(await page.locator("details.part").getAttribute("open"), "");
      if (width > 760) {
        const files = page.getByRole("group", { name: "Files of the part" }).getByRole("button");
        assert.equal(await files.count(), 5);
        for (const { y, height: size } of await Promise.all((await files.all()).map((one) => one.boundingBox()))) assert.ok(y >= 0 && y + size <= height, `the files at ${y} are in sight`);
      }
      // Cells of 14 mm are few in a coupon of 30 mm.
      const hint = page.locator(".part-cells");
      assert.match(await hint.textContent(), /About 2 cells across: the edges count/);
      await hint.getByRole("button", { name: /^Make it \d+ × \d+ mm$/ }).click();
      await hint.waitFor({ state: "hidden" });
      assert.ok(Number(await page.locator("details.part").getByLabel("Width, mm").inputValue()) >= 80, "six cells");
      await closePage(page);
    });
  }
});
