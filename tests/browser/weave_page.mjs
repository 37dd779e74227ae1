// A page object for the weave page: reads its contents and performs the user's actions.
import { readFile } from "node:fs/promises";
import { openPage, until } from "./harness.mjs";

/** The file that is downloaded by an action. */
export async function saved(page, press) {
  const waiting = page.waitForEvent("download");
  await press();
  const file = await waiting;
  return { name: file.suggestedFilename(), text: (await readFile(await file.path())).toString() };
}

export class WeavePage {
  static async open(browser, url, link = "", options) {
    const page = new WeavePage(await openPage(browser, `${url}/#/weave${link && `?${link}`}`, options));
    await page.settled();
    return page;
  }

  constructor(page) {
    this.page = page;
    this.crossings = page.locator(".layout .crossing");
    this.card = page.locator(".profile");
    page.profiles = [];
    page.on("request", (request) => {
      if (request.method() !== "POST" || !request.url().endsWith("/v1/weave-homogenizations")) return;
      const document = request.postDataJSON();
      if (!document.deformed) page.profiles.push(document);
    });
  }

  /** Waits for the profile of the shown weave with all directions. */
  async settled() {
    await this.page.locator(".reading strong").first().waitFor();
    await until(async () => (await this.card.getAttribute("aria-busy")) === "false" && (await this.page.locator(".curve.achieved.provisional").count()) === 0, "the profile with all directions");
  }

  curve(kind) {
    return this.page.locator(".chart-stage").nth(kind === "modulus" ? 0 : 1).locator(".curve.achieved").getAttribute("d");
  }

  cell() {
    return this.page.locator(".cell .strands path").first().getAttribute("d");
  }

  words(index) {
    return this.crossings.nth(index).getAttribute("aria-label");
  }

  /** Rows of the table of values: direction, modulus, Poisson's ratio, reason. */
  async values() {
    const table = this.page.locator("details.table");
    if ((await table.getAttribute("open")) === null) await table.locator("summary").click();
    const rows = this.page.locator('[aria-label="Values over direction"] tbody tr');
    await rows.first().waitFor();
    return rows.evaluateAll((all) => all.map((row) => [...row.children].map((cell) => cell.textContent.replace("−", "-"))));
  }

  button(name) {
    return this.page.getByRole("button", { name, exact: true });
  }

  slider(name) {
    return this.page.getByLabel(name, { exact: true });
  }

  number(name) {
    return this.page.getByLabel(`${name}, as a number`, { exact: true });
  }

  async enter(name, value) {
    await this.number(name).fill(String(value));
    await this.number(name).press("Enter");
  }

  /** Clicks on the drawing of the layout, at a position in mm. */
  async clickAt(x, y) {
    // The button that was pressed before may be below the picture, so that the page has scrolled.
    await this.page.locator(".layout").scrollIntoViewIfNeeded();
    const [left, top] = await this.page.locator(".layout > g").evaluate((plane, [px, py]) => {
      const point = new DOMPoint(px, py).matrixTransform(plane.getScreenCTM());
      return [point.x, point.y];
    }, [x, y]);
    await this.page.mouse.click(left, top);
  }
}
