// What hands and a first visit expect: tables that keep the focus, words, zoom, pictures, and refusals at their place.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { DesignPage, withDesign } from "./design_page.mjs";
import { browser, closePage, picture, server, setUp, until } from "./harness.mjs";
import { WeavePage } from "./weave_page.mjs";

setUp();

const active = (page) => page.evaluate(() => document.activeElement?.getAttribute("aria-label") ?? "");

describe("the table of control points", () => {
  it("keeps the focus on Tab, so that a typed value stays in its column", () =>
    withDesign(async (design, page) => {
      await page.locator("details.table summary").click();
      const index = await design.movable();
      const strain = page.getByLabel(`Control point ${index + 1}, strain`, { exact: true });
      const stress = page.getByLabel(`Control point ${index + 1}, Stress`, { exact: true });
      const strainBefore = await strain.inputValue();
      await strain.click();
      await page.keyboard.press("Tab");
      assert.equal(await active(page), `Control point ${index + 1}, Stress`);
      await page.keyboard.type("0.03");
      await page.keyboard.press("Tab");
      assert.equal(await active(page), `Control point ${index + 2}, strain`, "the next cell after the value was taken");
      assert.equal(await stress.inputValue(), "0.03");
      assert.equal(await strain.inputValue(), strainBefore);
      await design.settled();
      assert.equal(await active(page), `Control point ${index + 2}, strain`, "the focus stays while answers arrive");
    }));

  it("follows a point over direction that passes another one", () =>
    withDesign(async (design, page) => {
      await page.getByLabel("Stiffness", { exact: true }).check();
      await design.settled();
      await page.locator("details.table summary").click();
      const value = await page.getByLabel("Control point 1, Stiffness", { exact: true }).inputValue();
      const angle = Number(await page.getByLabel("Control point 2, direction in degrees", { exact: true }).inputValue());
      await page.getByLabel("Control point 1, direction in degrees", { exact: true }).fill(String(angle + 8));
      await page.keyboard.press("Tab");
      assert.equal(await active(page), "Control point 2, Stiffness", "the value of the point that was moved");
      assert.equal(await page.evaluate(() => document.activeElement.value), value);
      await design.settled();
    }));
});

describe("a first visit", () => {
  it("says what this is, offers three pictures, and does so once", async () => {
    const design = await DesignPage.open(browser, server.url, { firstVisit: true });
    const { page } = design;
    const welcome = page.getByRole("region", { name: "What this is" });
    assert.match(await welcome.textContent(), /Draw how something soft should respond/);
    assert.equal(await welcome.locator("button.start svg").count(), 3);
    await picture(page, "welcome");
    await welcome.getByRole("button", { name: /^Plateau/ }).click();
    await welcome.waitFor({ state: "hidden" });
    assert.equal(await page.evaluate(() => document.activeElement.textContent), "Design", "the focus goes to the heading of the page");
    await design.settled();
    assert.match(page.url(), /points=/);
    await page.reload();
    await design.settled();
    assert.ok(await welcome.isHidden());
    await closePage(page);
  });

  it("finds words for parameters and explains terms where they stand", () =>
    withDesign(async (_, page) => {
      const labels = await page.locator(".parameters label").allTextContents();
      assert.ok(labels.length > 0 && labels.every((words) => !/^Parameter/.test(words)), labels.join());
      const kinds = page.getByRole("group", { name: "What the target shows" });
      assert.equal(await kinds.locator(".term-hint").count(), 1, "one button for the three terms");
      await kinds.getByRole("button", { name: "What is meant by “Stress”, “Stiffness” and “Poisson’s ratio”?" }).click();
      const note = page.locator(".term-note:popover-open");
      for (const words of [/Force over the area/, /how much the stress rises/i, /auxetic/]) assert.match(await note.textContent(), words);
      await page.keyboard.press("Escape");
      await until(async () => (await page.locator(".term-note:popover-open").count()) === 0, "a closed definition");
    }));
});

describe("a plot", () => {
  it("zooms with Ctrl and the wheel, goes back to the whole, and is saved as PNG", () =>
    withDesign(async (design, page) => {
      const whole = await design.curve("target");
      const box = await page.locator(".plot").boundingBox();
      await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
      await page.keyboard.down("Control");
      await page.mouse.wheel(0, -400);
      await page.keyboard.up("Control");
      await until(async () => (await design.curve("target")) !== whole, "a magnified curve");
      await picture(page, "plot-zoomed");
      await design.button("Show the whole plot").click();
      await until(async () => (await design.curve("target")) === whole, "the whole curve again");
      assert.ok(await design.button("Show the whole plot").isHidden());
      await page.locator(".plot-card .menu summary", { hasText: "Export" }).click();
      const waiting = page.waitForEvent("download");
      await page.getByRole("button", { name: "Plot (PNG)" }).click();
      assert.match((await waiting).suggestedFilename(), /\.png$/);
    }));
});

describe("a sheet that cannot be printed", () => {
  it("shows its crossings in red, without pointers, and is repaired by a button", async () => {
    // Sliding strands at a distance of 2 mm have no room for the lifts of the printer.
    const weave = await WeavePage.open(browser, server.url, "pattern=regular&type=2&pitch=2&radius=0.25&strain=0.1&sheet=2,2,shear,0.3");
    const { page } = weave;
    await weave.button("Print").click();
    const dialog = page.getByRole("dialog", { name: "Print the sheet" });
    const alert = dialog.getByRole("alert");
    await alert.waitFor();
    assert.match(await alert.textContent(), /Crossing \d+/);
    assert.doesNotMatch(await alert.textContent(), /\/weave|crossings\/|strands\/|[a-z]_[a-z]/);
    assert.ok((await dialog.locator(".fault-mark").count()) > 0);
    await picture(page, "print-crossings");
    const repairs = dialog.getByRole("group", { name: "Repairs" }).getByRole("button");
    assert.match((await repairs.allTextContents()).join(), /Fuse th/);
    await repairs.filter({ hasText: "Fuse th" }).click();
    await dialog.locator(".facts dd").first().waitFor();
    assert.equal(await dialog.locator(".fault-mark").count(), 0);
    await closePage(page);
  });

  it("is planned for a printer by name, which is remembered", async () => {
    const weave = await WeavePage.open(browser, server.url, "pattern=regular&type=2&pitch=4&radius=0.25&strain=0.1&sheet=2,2,shear,0.3");
    const { page } = weave;
    await weave.button("Print").click();
    const dialog = page.getByRole("dialog", { name: "Print the sheet" });
    await dialog.getByLabel("Printer by name").selectOption("Creality Ender-3");
    await dialog.getByText("Creality Ender-3: nozzle 180 °C, bed 60 °C, 220 × 220 mm").waitFor();
    await page.reload();
    await weave.settled();
    await weave.button("Print").click();
    assert.equal(await dialog.getByLabel("Printer by name").inputValue(), "Creality Ender-3");
    await closePage(page);
  });
});
