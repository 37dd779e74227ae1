// Files, links and pins of the weave page, and a server that is gone.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { browser, closePage, picture, server, setUp, until } from "./harness.mjs";
import { saved, WeavePage } from "./weave_page.mjs";

setUp({ own: true });

const exported = (page, name) => saved(page, async () => {
  await page.locator("main .menu summary").click();
  await page.locator("main .menu").getByText(name).click();
});

describe("an export", () => {
  it("gives the drawing, the request, the values and the plots", async () => {
    const weave = await WeavePage.open(browser, server.url);
    const { page } = weave;
    assert.match((await exported(page, "Drawing (SVG)")).text, /<svg/);
    const request = await exported(page, "Request (JSON)");
    const answer = await fetch(`${server.url}/v1/weave-homogenizations`, { method: "POST", headers: { "Content-Type": "application/json" }, body: request.text });
    assert.equal(answer.status, 200, "the server takes the request as it is");
    const { youngs_modulus: modulus } = await answer.json();
    const values = (await exported(page, "Values (CSV)")).text.trim().split("\n");
    assert.match(values[0], /^direction_rad,youngs_modulus_N_per_m,poisson_ratio/);
    assert.equal(values.length, 201);
    assert.ok(Math.abs(Number(values[101].split(",")[1]) - modulus[100]) <= 1e-4 * Math.max(...modulus));
    assert.ok(!(await exported(page, "Plot of the modulus (SVG)")).text.includes("var("));
    await closePage(page);
  });
});

describe("a shared link", () => {
  it("shows another person the same weave with the same crossings", async () => {
    const mine = await WeavePage.open(browser, server.url, "pattern=interlacing_squares&type=1&side=10&overlap=2&radius=0.25&strain=0.05");
    await mine.crossings.nth(3).click();
    await until(async () => /slides, changed/.test(await mine.words(3)), "a changed crossing");
    await mine.settled();
    await until(() => mine.page.url().includes("crossings=3:0"), "the link in the address");
    const theirs = await WeavePage.open(browser, mine.page.url().replace(/\/#.*/, ""), mine.page.url().split("?")[1]);
    assert.equal(await theirs.words(3), await mine.words(3));
    assert.deepEqual(await theirs.values(), await mine.values());
    await closePage(mine.page);
    await closePage(theirs.page);
  });

  it("that is broken opens the page as it is for everyone", async () => {
    const weave = await WeavePage.open(browser, server.url, "pattern=layout&layout=%3Cscript%3E");
    assert.equal(await weave.crossings.count(), 4);
    await closePage(weave.page);
  });
});

describe("a pinned weave", () => {
  it("is drawn beside others, is still there after a reload, and leads back", async () => {
    const weave = await WeavePage.open(browser, server.url);
    const { page } = weave;
    await weave.button("Pin").click();
    await page.locator(".pins li").waitFor();
    await page.getByLabel("Connections of its crossings").selectOption("2");
    await weave.settled();
    await until(async () => (await page.locator(".curve.pin").count()) >= 2, "the pinned curves in both plots");
    await picture(page, "weave-pinned");
    await page.waitForTimeout(400); // the link is written after a pause
    await page.reload();
    await page.locator(".pins li").waitFor();
    await page.getByRole("button", { name: /^Go back to Interlacing circles, 1/ }).click();
    await until(async () => (await page.getByLabel("Connections of its crossings").inputValue()) === "1", "the pinned weave");
    await weave.settled();
    await page.getByRole("button", { name: /^Remove Interlacing/ }).click();
    assert.equal(await page.locator(".pins li").count(), 0);
    await closePage(page);
  });
});

describe("trouble", () => {
  it("is told in the server's words, and can be tried again", async () => {
    const weave = await WeavePage.open(browser, server.url);
    const { page } = weave;
    await page.route("**/v1/weave-homogenizations", (route) =>
      route.fulfill({ status: 503, contentType: "application/problem+json", body: JSON.stringify({ type: "urn:supple:error:job.queue_full", title: "Queue full", status: 503, detail: "The queue is full of jobs.", code: "job.queue_full" }) }));
    await weave.enter("Strain along each direction", 0.2);
    await page.locator(".profile .status .note").getByText("The queue is full of jobs.").waitFor();
    await page.unroute("**/v1/weave-homogenizations");
    await weave.button("Try again").click();
    await weave.settled();
    assert.equal(await page.locator(".profile .status .note").count(), 0);
    await closePage(page);
  });

  it("of a lost connection passes: what was changed meanwhile is asked for once the server is back", async () => {
    const weave = await WeavePage.open(browser, server.url);
    const { page } = weave;
    const curve = await weave.curve("modulus");
    await server.stop();
    await weave.enter("Strain along each direction", 0.3);
    await page.locator(".lost").getByText("The server does not answer").waitFor();
    await server.run();
    await until(async () => !(await page.locator(".lost").isVisible()), "the end of the banner");
    await until(async () => (await weave.curve("modulus")) !== curve, "the profile of the new strain");
    await weave.settled();
    await closePage(page);
  });
});
