// A page object for the design page: reads its contents and performs the user's actions.
import assert from "node:assert/strict";
import { browser, closePage, openPage, picture, server, until, WAIT_MS } from "./harness.mjs";

/** A number from the page's text, which has a typographic minus. */
export function number(text) {
  return Number(text.replace("−", "-").replace(/[^\d.eE-]/g, ""));
}

export class DesignPage {
  static async open(browser, url, options) {
    const page = new this(await openPage(browser, url, options));
    await page.settled(options?.patience);
    return page;
  }

  constructor(page) {
    this.page = page;
    this.handles = page.locator(".handle");
    this.status = page.locator(".plot-card .status");
  }

  /** Waits until no search is running and a design is shown. */
  async settled(wait = WAIT_MS) {
    await this.page.locator(".result .family").waitFor({ timeout: wait });
    await until(async () => {
      if ((await this.page.locator(".plot-card").getAttribute("aria-busy")) !== "false") return false;
      if ((await this.page.evaluate(() => window.designsAtOnce.running)) > 0) return false;
      return (await this.page.locator(".result .chip").textContent()) !== "Searching";
    }, "the end of the search", wait);
    // The page draws the answer before the next repaint of the browser.
    await this.page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  }

  curve(kind) {
    return this.page.locator(`.plot .curve.${kind}`).getAttribute("d");
  }

  tiling() {
    return this.page.locator(".tiling .solid").getAttribute("d");
  }

  /** Rows of the table of curves: x, target, design. */
  async values() {
    const table = this.page.locator("details.table");
    if ((await table.getAttribute("open")) === null) await table.locator("summary").click();
    const rows = this.page.locator('[aria-label="Values of the curves"] tbody tr');
    await until(async () => (await rows.count()) > 5, "rows of the table");
    return rows.evaluateAll((all) =>
      all.map((row) => [...row.children].slice(0, 3).map((cell) => Number(cell.textContent.replace("−", "-").replace("°", "")))));
  }

  async pointWords(index) {
    return this.handles.nth(index).getAttribute("aria-valuetext");
  }

  async pointHeight(index) {
    return Number(await this.handles.nth(index).getAttribute("aria-valuenow"));
  }

  async centre(index) {
    const box = await this.handles.nth(index).locator(".dot").boundingBox();
    return [box.x + box.width / 2, box.y + box.height / 2];
  }

  /** Index of the middle one of the movable control points, which are all except the one at rest. */
  async movable() {
    const words = await this.handles.evaluateAll((all) => all.map((handle) => handle.getAttribute("aria-valuetext")));
    const free = words.flatMap((text, index) => (/at rest/.test(text) ? [] : [index]));
    return free[Math.floor(free.length / 2)];
  }

  /** Drags a control point. Fails for the point at rest, which cannot be moved. */
  async drag(index, right, down, on) {
    const words = await this.pointWords(index);
    assert.doesNotMatch(words, /at rest/, `control point ${index + 1} cannot be moved`);
    await this.pull(index, right, down, on);
  }

  /** Scrolls a control point into view and drags it in steps. `on` is called before the release. */
  async pull(index, right, down, on = async () => {}) {
    const { mouse } = this.page;
    await this.handles.nth(index).locator(".dot").scrollIntoViewIfNeeded();
    const [x, y] = await this.centre(index);
    await mouse.move(x, y);
    await mouse.down();
    for (let step = 1; step <= 12; ++step) {
      await mouse.move(x + (right * step) / 12, y + (down * step) / 12);
      await this.page.waitForTimeout(25);
    }
    await on();
    await mouse.up();
  }

  /** Double-clicks the first element of a selector that spans the plot, at a fraction of its length, or further if a control point is there. */
  async doubleClickOn(selector, share) {
    const [x, y] = await this.page.locator(selector).evaluateAll((lines, at) => {
      const across = lines.find((line) => line.getBoundingClientRect().width > 100);
      const handles = [...document.querySelectorAll(".handle .dot")].map((dot) => dot.getBoundingClientRect());
      for (let share = at; share < 0.98; share += 0.01) {
        const { x, y } = across.getPointAtLength(share * across.getTotalLength()).matrixTransform(across.getScreenCTM());
        if (handles.every((box) => Math.hypot(box.x + box.width / 2 - x, box.y + box.height / 2 - y) > 22)) return [x, y];
      }
      throw new Error("there are control points everywhere");
    }, share);
    await this.page.mouse.dblclick(x, y);
  }

  /** Drags a file over the first element of a selector and drops it there. `window.marked` receives the classes of the highlighted element. */
  async drop(selector, text, name) {
    await this.page.evaluate(([wanted, content, file]) => {
      const data = new DataTransfer();
      data.items.add(new File([content], file));
      const event = (kind) => new DragEvent(kind, { bubbles: true, cancelable: true, dataTransfer: data });
      const place = document.querySelector(wanted);
      place.dispatchEvent(event("dragover"));
      window.marked = document.querySelector(".dropping")?.className;
      place.dispatchEvent(event("drop"));
    }, [selector, text, name]);
  }

  async deviation() {
    return number((await this.page.locator(".result .facts dd").first().textContent()).replace(/±.*/, ""));
  }

  async family() {
    return this.page.locator(".result .family").textContent();
  }

  button(name) {
    return this.page.getByRole("button", { name, exact: true });
  }

  slider(name) {
    return this.page.getByLabel(name, { exact: true });
  }
}

/**
 * Opens a page, runs an action on it, and takes a picture if the action fails. `Kind`: the page object, a subclass of DesignPage with the
 * helpers of a test file.
 */
export async function withDesign(act, { Kind = DesignPage, url = server.url, ...options } = {}) {
  const design = await Kind.open(browser, url, options);
  try {
    await act(design, design.page);
  } catch (error) {
    await picture(design.page, "failure");
    throw error;
  }
  await closePage(design.page);
}
