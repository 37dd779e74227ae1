// A page object for the family page: reads its contents and performs the user's actions.
import { openPage, until } from "./harness.mjs";

/** Parallelograms of which one side leans: a family that is checked in no time. */
export const SLANTED = {
  id: "slanted",
  description: "Parallelograms of which one side leans",
  parameters: [{ description: "Slant", lower: 0.1, upper: 0.5, default: 0.3 }],
  beam_width: 0.1,
  tile: {
    vertices: [[0, 0], [1, 0], [[1, 1], 1], [[0, 1], 1]],
    translations: [[1, 0], [[0, 1], 1]],
    placements: [{ linear: [1, 0, 0, 1], offset: [0, 0] }],
  },
};

/** Squares that leave a gap between them. */
export const GAPS = { ...SLANTED, id: "gaps", tile: { ...SLANTED.tile, vertices: [[0, 0], [1, 0], [1, 1], [0, 1]], translations: [[[1, 1], 0], [0, 1]] } };

export function linkTo(definition, more = "") {
  return `definition=${encodeURIComponent(JSON.stringify(definition))}${more}`;
}

export class FamilyPage {
  static async open(browser, url, link = "", options) {
    const page = new FamilyPage(await openPage(browser, `${url}/#/family${link && `?${link}`}`, options));
    await page.checked();
    return page;
  }

  constructor(page) {
    this.page = page;
    this.summary = page.locator(".check-summary");
    this.handles = page.locator(".family-tiling .handle");
  }

  /** Waits until the server has checked the present definition. */
  async checked() {
    await until(async () => ((await this.summary.getAttribute("data-grade")) ?? "unknown") !== "unknown", "the check of the definition");
  }

  /** The outline of the tile, as it is drawn. */
  tile() {
    return this.page.locator(".tile-outline").getAttribute("d");
  }

  button(name) {
    return this.page.getByRole("button", { name, exact: true });
  }

  handle(name) {
    return this.page.getByRole("slider", { name, exact: true });
  }

  number(name) {
    return this.page.getByLabel(`${name}, as a number`, { exact: true });
  }

  async value(name) {
    return Number(await this.number(name).inputValue());
  }

  async centre(name) {
    const { x, y, width, height } = await this.handle(name).boundingBox();
    return [x + width / 2, y + height / 2];
  }

  /** Drags a handle with the mouse. `meanwhile`: called before the button is released. */
  async drag(name, dx, dy, meanwhile = async () => {}) {
    await this.handle(name).scrollIntoViewIfNeeded();
    const [x, y] = await this.centre(name);
    await this.page.mouse.move(x, y);
    await this.page.mouse.down();
    for (let step = 1; step <= 5; ++step) await this.page.mouse.move(x + (dx * step) / 5, y + (dy * step) / 5);
    await meanwhile();
    await this.page.mouse.up();
  }

  async openFile(name, text, mimeType = "application/json") {
    await this.page.locator('.family-card input[type="file"]').setInputFiles({ name, mimeType, buffer: Buffer.from(text) });
  }
}
