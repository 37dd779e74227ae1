// The print dialog of a sheet, and its G-code.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { browser, closePage, picture, server, setUp, until } from "./harness.mjs";
import { saved, WeavePage } from "./weave_page.mjs";

setUp({ own: true });

const SLIDING = "pattern=regular&type=2&pitch=4&radius=0.25&strain=0.1&sheet=2,2,shear,0.3";

class PrintPage {
  static async open(options) {
    const weave = await WeavePage.open(browser, server.url, SLIDING, options);
    await weave.button("Print").click();
    const print = new PrintPage(weave);
    await print.planned();
    return print;
  }

  constructor(weave) {
    this.weave = weave;
    this.page = weave.page;
    this.dialog = weave.page.getByRole("dialog", { name: "Print the sheet" });
    this.words = this.dialog.locator(".layer-words");
  }

  /** Waits for the plan of the present settings. */
  async planned() {
    await until(async () => (await this.dialog.locator(".print-plan").getAttribute("aria-busy")) === "false" && !(await this.isDimmed()) && (await this.dialog.locator(".facts dd").count()) > 0, "the plan");
  }

  isDimmed() {
    return this.dialog.evaluate((element) => element.classList.contains("outdated"));
  }

  async enter(name, value) {
    await this.dialog.getByLabel(name, { exact: true }).fill(String(value));
    await this.page.keyboard.press("Tab");
  }

  fact(term) {
    return this.dialog.locator(".facts dt", { hasText: term }).locator("+ dd").textContent();
  }

  /** The drawing after the next repaint, as a data URL. */
  drawing() {
    return this.dialog.locator("canvas").evaluate((canvas) => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(() => resolve(canvas.toDataURL())))));
  }
}

/** Holds the requests of plans until the returned function is called. */
async function holdPlans(page) {
  let release;
  const held = new Promise((resolve) => (release = resolve));
  await page.route("**/v1/weave-toolpaths", async (route) => {
    await held;
    await route.continue();
  });
  return release;
}

describe("the dialog of a print", () => {
  it("shows the printer, what the print takes and the toolpath layer by layer, and saves its G-code", async () => {
    const print = await PrintPage.open();
    const { page, dialog, words } = print;
    assert.match(await dialog.locator(".print-head").textContent(), /Prusa i3 MK3S, PLA: nozzle 180 °C, bed 60 °C, 250 × 210 mm/);
    assert.match(await print.fact("Time"), /s, without accelerations$/);
    assert.match(await print.fact("Printed"), /16 channels/);
    await dialog.getByText("The checker has read the G-code and finds nothing wrong.").waitFor();
    assert.match(await words.textContent(), /^Layer 3 of 3: channels over sliding strands, nozzle at 0.5 to 2.5 mm/);
    await picture(page, "print");
    const pictures = [await print.drawing()];
    const look = async (act, what) => {
      await act();
      pictures.push(await print.drawing());
      assert.equal(new Set(pictures).size, pictures.length, `${what} is another drawing`);
    };
    await dialog.getByLabel("Layer", { exact: true }).focus();
    await look(() => page.keyboard.press("ArrowLeft"), "the layer below");
    assert.match(await words.textContent(), /^Layer 2 of 3: strands that rise over others/);
    await look(() => page.keyboard.press("Home"), "the lowest layer");
    assert.match(await words.textContent(), /^Layer 1 of 3: on the bed, nozzle at 0.5 mm; 124 mm printed, 5 travels\.$/);
    await look(() => dialog.getByLabel("Show travels").uncheck(), "a layer without its travels");
    await dialog.getByLabel("Moves of this layer", { exact: true }).focus();
    await look(() => page.keyboard.press("ArrowLeft"), "a layer without its last move");
    assert.match(await words.textContent(), /of which 9 of 10 moves are shown/);
    await look(() => dialog.getByLabel("Whole bed").check(), "the bed");
    await picture(page, "print-bed");
    await print.enter("Nozzle, °C", 205);
    await print.planned();
    const { name, text } = await saved(page, () => dialog.getByRole("button", { name: "Save G-code" }).click());
    assert.equal(name, "regular-sheet.gcode");
    assert.match(text, /^M104 S205/m);
    assert.match(text, /^G1 .*E/m);
    await dialog.getByText("Saved as regular-sheet.gcode.").waitFor();
    await closePage(page);
  });

  it("dims the plan until that of other settings has come, and saves nothing meanwhile", async () => {
    const print = await PrintPage.open();
    const { page, dialog } = print;
    const printed = await print.fact("Printed");
    const release = await holdPlans(page);
    await dialog.getByLabel("Frame around the sheet").check();
    await until(() => print.isDimmed(), "a dimmed plan");
    const save = dialog.getByRole("button", { name: "Save G-code" });
    assert.ok(await save.isDisabled());
    await until(async () => Number(await dialog.locator(".print-stage").evaluate((stage) => getComputedStyle(stage).opacity)) < 0.6, "a drawing that is seen to be dimmed");
    assert.equal(await print.fact("Printed"), printed, "what is dimmed is the earlier plan");
    release();
    await print.planned();
    assert.notEqual(await print.fact("Printed"), printed, "the frame is printed too");
    assert.ok(await save.isEnabled());
    await closePage(page);
  });

  it("says what is wrong at the field that is at fault, and what the checker objects to", async () => {
    const print = await PrintPage.open();
    const { page, dialog } = print;
    const bed = dialog.getByLabel("Bed along x, mm", { exact: true });
    await print.enter("Bed along x, mm", 10);
    await until(async () => (await bed.getAttribute("aria-invalid")) === "true", "a field that is at fault");
    const fault = dialog.locator(`[id="${await bed.getAttribute("aria-describedby")}"]`);
    assert.match(await fault.textContent(), /reaches from 0 to 10/);
    assert.match(await dialog.getByRole("alert").textContent(), /the nozzle would go from/);
    assert.ok(await dialog.getByRole("button", { name: "Save G-code" }).isDisabled());
    await picture(page, "print-fault");
    await print.enter("Bed along x, mm", 250);
    await print.planned();
    assert.equal(await bed.getAttribute("aria-invalid"), null);
    // A fault of a field in a folded group unfolds the group.
    const release = await holdPlans(page);
    await dialog.getByText("Lifts over strands").click();
    await print.enter("Begins to rise at, mm", 0.1);
    await dialog.getByText("Lifts over strands").click();
    // The fault must not arrive before the group is folded, since the click would then fold what the fault has unfolded.
    release();
    await until(() => dialog.getByLabel("Begins to rise at, mm", { exact: true }).isVisible(), "the opened group");
    await print.enter("Begins to rise at, mm", 2);
    await print.planned();
    await dialog.getByText("Start and end").click();
    await print.enter("After heating and homing", "M999");
    await dialog.getByText("unknown command: M999").waitFor();
    await print.planned();
    assert.match(await dialog.locator(".notes").textContent(), /The checker objects 1 time/);
    // The browser stores the printer settings over a reload; they can be reset to the default ones.
    await page.reload();
    await print.weave.settled();
    await print.weave.button("Print").click();
    await dialog.getByText("unknown command: M999").waitFor();
    await dialog.getByRole("button", { name: "Reset" }).click();
    await dialog.getByText("finds nothing wrong").waitFor();
    await closePage(page);
  });

  it("saves a printer as a file and opens it again, and refuses another file", async () => {
    const print = await PrintPage.open();
    const { page, dialog } = print;
    await print.enter("Name of the profile", "My printer");
    await print.enter("Bed, °C", 75);
    await print.planned();
    const file = await saved(page, () => dialog.getByRole("button", { name: "Save profile" }).click());
    assert.deepEqual([JSON.parse(file.text).name, JSON.parse(file.text).bed_temperature], ["My printer", 75]);
    await dialog.getByRole("button", { name: "Reset" }).click();
    await print.planned();
    const open = (text) => dialog.locator("input[type=file]").setInputFiles({ name: "printer.json", mimeType: "application/json", buffer: Buffer.from(text) });
    await open(file.text);
    await dialog.getByText("My printer: nozzle 180 °C, bed 75 °C").waitFor();
    await print.planned();
    await open('{"colour": "red"}');
    await dialog.getByRole("alert").getByText("A printer does not have the colour, which the file names.").waitFor();
    assert.match(await dialog.locator(".print-head").textContent(), /My printer/, "the printer stays");
    await closePage(page);
  });

  it("keeps the keyboard within, and gives it back where it was", async () => {
    const print = await PrintPage.open();
    const { page, dialog } = print;
    for (let k = 0; k < 45; ++k) {
      await page.keyboard.press("Tab");
      // Besides the elements of the dialog, the focus can reach the browser's own window, which appears as the body of the document here.
      assert.ok(await page.evaluate(() => document.activeElement === document.body || document.activeElement.closest("dialog.print") !== null), `after ${k + 1} steps`);
    }
    await page.keyboard.press("Escape");
    await dialog.waitFor({ state: "hidden" });
    assert.equal(await page.evaluate(() => document.activeElement.textContent), "Print");
    // The export menu opens the dialog, too.
    await page.locator("main .menu summary").click();
    await page.locator("main .menu").getByText("Sheet to print (G-code)").click();
    await print.planned();
    await dialog.getByRole("button", { name: "Cancel" }).click();
    await dialog.waitFor({ state: "hidden" });
    await closePage(page);
  });

  it("takes back no change of the weave below it", async () => {
    const weave = await WeavePage.open(browser, server.url, SLIDING);
    const { page } = weave;
    await weave.crossings.first().click();
    await until(async () => /changed/.test(await weave.words(0)), "a changed crossing");
    await weave.settled();
    await weave.button("Print").click();
    const print = new PrintPage(weave);
    await print.dialog.getByLabel("Layer", { exact: true }).waitFor();
    await print.dialog.getByLabel("Layer", { exact: true }).focus();
    await page.keyboard.press("Control+z");
    await page.keyboard.press("Escape");
    assert.match(await weave.words(0), /changed/);
    await closePage(page);
  });

  it("fits a small screen", async () => {
    const print = await PrintPage.open({ viewport: { width: 360, height: 740 } });
    const { page, dialog } = print;
    assert.ok(await dialog.evaluate((element) => [element, ...element.querySelectorAll(".print-body, .print-plan, .print-settings")].every((part) => part.scrollWidth <= innerWidth)), "nothing is wider than the screen");
    assert.ok(await dialog.getByRole("button", { name: "Save G-code" }).isVisible());
    await picture(page, "print-small");
    await closePage(page);
  });

  it("says that the server is gone, and plans once it is back", async () => {
    const print = await PrintPage.open();
    const { page, dialog } = print;
    await server.stop();
    await print.enter("Bed, °C", 65);
    await dialog.getByRole("alert").getByText("The server does not answer.").waitFor();
    await server.run();
    await print.planned();
    assert.match(await dialog.locator(".print-head").textContent(), /bed 65 °C/);
    await closePage(page);
  });
});
