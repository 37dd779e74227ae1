// Takes pictures of every page for the documents: wide, wide and dark, and on a phone.
//
//     node pictures.mjs http://127.0.0.1:8080 ../../docs/images/pages [name ...]
//
// uses a running server with all models and the built editor. Names choose some of the pictures.
import { mkdir } from "node:fs/promises";
import path from "node:path";
import { chromium } from "playwright-core";

const [url, folder, ...names] = process.argv.slice(2);
if (!url || !folder) {
  console.error("usage: node pictures.mjs URL FOLDER [NAME ...]");
  process.exit(1);
}
const KINDS = [
  ["1440", { viewport: { width: 1440, height: 900 }, colorScheme: "light" }],
  ["1440-dark", { viewport: { width: 1440, height: 900 }, colorScheme: "dark" }],
  ["390", { viewport: { width: 390, height: 844 }, colorScheme: "light" }],
];
async function isWoven(page) {
  await page.locator(".reading strong").first().waitFor();
  await page.locator('.profile[aria-busy="false"]').waitFor();
}

async function isFound(page) {
  await page.locator(".result .chip:is(.good, .close, .out)").waitFor();
  await page.locator('.plot-card[aria-busy="false"]').waitFor();
}

/** Name of each picture, address of its page, and a function that prepares the page. */
const PAGES = [
  ["design", "design", isFound],
  ["targets", "design", async (page) => {
    await isFound(page);
    await page.getByTitle("Add a further target of the same design").click();
    await page.getByRole("tab").nth(1).waitFor();
    await isFound(page);
    await page.getByLabel("Poisson’s ratio", { exact: true }).check();
    await page.locator(".plot.polar").waitFor();
    await isFound(page);
  }],
  ["family", "family", async (page) => {
    await page.getByLabel("Edges c", { exact: true }).selectOption("curve");
    await page.getByLabel("Edges b", { exact: true }).selectOption("bent");
    await page.locator('.check-summary:not([data-grade="unknown"])').waitFor();
  }],
  ["weave", "weave", isWoven],
  ["print", "weave?pattern=interlacing_circles&type=2&circle_radius=5.5&distance=10&radius=0.25&strain=0.1&sheet=4,4,stretch_x,0.2", async (page) => {
    await isWoven(page);
    await page.getByRole("button", { name: "Print", exact: true }).click();
    await page.locator(".print .facts dd").first().waitFor();
  }],
  ["mesh", "mesh", async (page) => {
    await page.getByRole("button", { name: "Sample" }).click();
    await page.locator('[aria-label="Result"]').waitFor();
    await page.getByRole("radio", { name: "Distance", exact: true }).check();
    await page.locator(".ramp-box").waitFor();
  }],
];

await mkdir(folder, { recursive: true });
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
for (const [kind, options] of KINDS) {
  for (const [name, address, ready] of PAGES.filter(([name]) => names.length === 0 || names.includes(name))) {
    const context = await browser.newContext(options);
    const page = await context.newPage();
    page.setDefaultTimeout(120_000);
    await page.goto(`${url}/#/${address}`);
    await ready(page);
    await page.evaluate(() => scrollTo(0, 0)); // the prepared settings may be far below
    await page.waitForTimeout(1500); // waits until the last answer is drawn
    await page.screenshot({ path: path.join(folder, `${name}-${kind}.png`) });
    await context.close();
    console.log(`${name}-${kind}.png`);
  }
}
await browser.close();
