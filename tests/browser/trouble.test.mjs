// Failures: slow searches, faults, and a server that is gone.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { DesignPage } from "./design_page.mjs";
import { browser, closePage, openPage, server, setUp, until } from "./harness.mjs";

setUp({ own: true });

const isSearch = (request) => request.postDataJSON()?.effects?.multi_start !== "off";

describe("a search that takes long", () => {
  it("gives way to a drag, and what it finds later changes nothing", async () => {
    const design = await DesignPage.open(browser, server.url);
    const { page } = design;
    let held = 0;
    let ended = 0;
    page.on("requestfailed", (request) => (ended += request.url().endsWith("/v1/designs") && isSearch(request) ? 1 : 0));
    await page.route("**/v1/designs", async (route) => {
      if (isSearch(route.request())) {
        ++held;
        await new Promise((resolve) => setTimeout(resolve, 1500));
      }
      await route.continue().catch(() => {});
    });
    const index = await design.movable();
    await design.drag(index, 0, -30);
    await until(() => held === 1, "a search that is held up");
    const answered = page.designs.answered;
    await design.drag(index, 0, -30, async () => {
      await until(() => page.designs.answered > answered, "answers to the drag");
      assert.equal(ended, 1, "the search was stopped");
    });
    await page.unroute("**/v1/designs");
    // The page's state is checked, because the browser may never report a request that was aborted while it was delayed.
    await until(async () => (await page.locator(".plot-card").getAttribute("aria-busy")) === "false", "the end of the search");
    const values = await design.values();
    const height = await design.pointHeight(index);
    const target = values.map((row) => row[1]);
    assert.ok(Math.min(...target.map((value) => Math.abs(value - height))) < 0.1 * Math.max(...target.map(Math.abs)), "the answer is that of the last target");
    await closePage(page);
  });

  it("is asked for again where a request that was stopped came to the server after it", async () => {
    const design = await DesignPage.open(browser, server.url);
    const { page } = design;
    let replaced = 0;
    await page.route("**/v1/designs", async (route) => {
      if (!isSearch(route.request()) || replaced > 0) return route.continue().catch(() => {});
      ++replaced;
      const body = JSON.stringify({ type: "urn:supple:error:design.superseded", title: "Superseded", status: 409, detail: "A newer request of the session has replaced this one.", code: "design.superseded" });
      await route.fulfill({ status: 409, contentType: "application/problem+json", body });
    });
    const curve = await design.curve("achieved");
    await design.drag(await design.movable(), 0, -30);
    await until(() => replaced === 1, "a search that is replaced");
    await design.settled();
    assert.notEqual(await design.curve("achieved"), curve);
    assert.ok(isSearch({ postDataJSON: () => page.designs.asked.at(-1) }), "searched for in the end");
    await closePage(page);
  });

  it("can be cancelled", async () => {
    const design = await DesignPage.open(browser, server.url);
    const { page } = design;
    await page.route("**/v1/designs", async (route) => {
      if (isSearch(route.request())) await new Promise((resolve) => setTimeout(resolve, 5000));
      await route.continue().catch(() => {});
    });
    await design.drag(await design.movable(), 0, -30);
    await page.locator(".working").getByRole("button", { name: "Cancel" }).click();
    await until(async () => (await page.locator(".working").count()) === 0, "the end of the search");
    await page.unroute("**/v1/designs");
    await closePage(page);
  });
});

describe("a problem", () => {
  it("is shown in the server's words, and can be tried again", async () => {
    const design = await DesignPage.open(browser, server.url);
    const { page } = design;
    await page.route("**/v1/designs", (route) =>
      route.fulfill({ status: 503, contentType: "application/problem+json", body: JSON.stringify({ type: "urn:supple:error:job.queue_full", title: "Queue full", status: 503, detail: "The queue is full of jobs.", code: "job.queue_full" }) }));
    await design.drag(await design.movable(), 0, -30);
    await page.locator(".status .note").getByText("The queue is full of jobs.").waitFor();
    await page.unroute("**/v1/designs");
    await design.button("Try again").click();
    await design.settled();
    assert.equal(await page.locator(".status .note").count(), 0);
    await closePage(page);
  });
});

describe("a connection that is lost", () => {
  it("is said plainly, and what was changed meanwhile is searched for once the server is back", async () => {
    const design = await DesignPage.open(browser, server.url);
    const { page } = design;
    await server.stop();
    const index = await design.movable();
    await design.drag(index, 0, -50);
    await page.locator(".lost").getByText("The server does not answer").waitFor();
    const height = await design.pointHeight(index);
    const curve = await design.curve("achieved");
    await server.run();
    await until(async () => !(await page.locator(".lost").isVisible()), "the end of the banner");
    await until(async () => (await design.curve("achieved")) !== curve, "a design for the new target");
    await design.settled();
    assert.equal(await design.pointHeight(index), height, "the target is the one that was drawn");
    await closePage(page);
  });

  it("at the start is waited for, and so is a server that is there but has not begun to serve", async () => {
    const page = await openPage(browser, "about:blank");
    const notReady = { type: "urn:supple:error:server.not_ready", title: "Not ready", status: 503, detail: "The server is starting.", code: "server.not_ready" };
    let phase = "gone";
    let refused = 0;
    for (const pattern of ["**/v1/**", "**/readyz"]) {
      await page.route(pattern, (route) => {
        if (phase === "gone") return route.abort();
        if (phase === "there") return route.continue();
        ++refused;
        return route.fulfill({ status: 503, contentType: "application/problem+json", body: JSON.stringify(notReady) });
      });
    }
    await page.goto(server.url);
    await page.locator(".lost").getByText("The server does not answer").waitFor();
    phase = "starting";
    await until(() => refused > 0, "a question to the server that starts");
    assert.ok(await page.locator(".lost").isVisible(), "it does not serve yet");
    phase = "there";
    await new DesignPage(page).settled();
    assert.equal(await page.locator(".lost").isVisible(), false);
    await closePage(page);
  });
});
