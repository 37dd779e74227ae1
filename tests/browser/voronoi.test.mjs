// Voronoi diagrams on the mesh page: scattering, placing, dragging and moving sites, optimization, and files.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { announcements, browser, closePage, openPage, picture, server, setUp, until } from "./harness.mjs";
import { saved } from "./weave_page.mjs";

setUp({ webgl: true });

/** A plane square with side 2, divided into `rows` by `rows` squares. */
function square(rows) {
  const lines = [];
  for (let i = 0; i <= rows; ++i) for (let j = 0; j <= rows; ++j) lines.push(`v ${(2 * i) / rows - 1} ${(2 * j) / rows - 1} 0`);
  const number = (i, j) => i * (rows + 1) + j + 1;
  for (let i = 0; i < rows; ++i) for (let j = 0; j < rows; ++j) lines.push(`f ${number(i, j)} ${number(i + 1, j)} ${number(i + 1, j + 1)}`, `f ${number(i, j)} ${number(i + 1, j + 1)} ${number(i, j + 1)}`);
  return lines.join("\n");
}

const card = (page) => page.getByLabel("Diagram", { exact: true });
const fact = (page, term) => card(page).locator("dt", { hasText: term }).locator("+ dd").textContent();
const button = (page, name) => page.getByRole("button", { name, exact: true });
const hint = (page) => page.locator('[aria-label="Voronoi diagram"] .muted').first().textContent();

async function enter(page, name, value) {
  const field = page.getByLabel(`${name}, as a number`, { exact: true });
  await field.fill(String(value));
  await field.press("Enter");
}

async function open(load) {
  const page = await openPage(browser, `${server.url}/#/mesh`);
  await page.getByText("Open a mesh").waitFor();
  page.asked = [];
  page.on("request", (request) => {
    if (request.method() === "POST" && request.url().includes("/v1/voronoi-")) page.asked.push({ kind: request.url().split("/").at(-1), document: request.postDataJSON() });
  });
  await load(page);
  await page.locator(".facts").getByText("Handles").waitFor();
  await page.getByRole("radio", { name: "Voronoi", exact: true }).check();
  return page;
}

const openSquare = () => open((page) => page.locator('input[type="file"]').setInputFiles({ name: "square.obj", mimeType: "model/obj", buffer: Buffer.from(square(7)) }));
const openSample = () => open((page) => button(page, "Sample").click());

async function addSite(page, name, count) {
  await page.getByLabel("Add a site").fill(name);
  await page.getByLabel("Add a site").press("Enter");
  await until(async () => (await fact(page, "Cells")) === String(count), `${count} cells`);
}

/** Number of pixels of the view in the colours of cells. Background and plain surface do not count, because they are grey. */
const coloured = async (page) => page.evaluate(async (bytes) => {
  const bitmap = await createImageBitmap(new Blob([new Uint8Array(bytes)], { type: "image/png" }));
  const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
  context.drawImage(bitmap, 0, 0);
  const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
  let count = 0;
  for (let k = 0; k < data.length; k += 4) if (Math.max(data[k], data[k + 1], data[k + 2]) - Math.min(data[k], data[k + 1], data[k + 2]) > 25) ++count;
  return count;
}, [...(await page.locator(".viewer canvas").screenshot())]);

describe("a Voronoi diagram on a surface", () => {
  it("of random sites is seen in colours, optimized with its cells in sight, and saved in four forms", async () => {
    const page = await openSample();
    await enter(page, "Random sites", 40);
    await button(page, "Scatter sites").click();
    await until(async () => (await fact(page, "Cells")) === "40", "the cells");
    assert.deepEqual(page.asked[0].document.sites, { count: 40, seed: 1 });
    await until(async () => (await coloured(page)) > 5000, "coloured cells");
    await picture(page, "voronoi-scattered");
    const heard = await announcements(page);
    await page.getByText("Method and accuracy").click();
    const most = page.getByLabel("Voronoi diagram", { exact: true }).getByLabel("Most iterations, as a number");
    await most.fill("6");
    await most.press("Enter");
    await button(page, "Optimize").click();
    await until(async () => Number(await fact(page, "Iteration")) >= 2, "iterations");
    await picture(page, "voronoi-moving");
    await card(page).locator(".stop", { hasText: /at rest|limit/ }).waitFor();
    const rows = card(page).locator('[aria-label="Statistics"] tbody tr');
    assert.equal(await rows.count(), 8, "four quantities before and after");
    await until(async () => (await heard()).some((sentence) => /at rest|limit/.test(sentence)), "the announcement");
    await picture(page, "voronoi-optimized");
    const last = page.asked.at(-1);
    assert.equal(last.kind, "voronoi-optimizations");
    assert.deepEqual(last.document.objectives, { centroidal: 1 });
    const obj = await saved(page, () => button(page, "OBJ").click());
    assert.equal(obj.name, "voronoi.obj");
    assert.match(obj.text, /^l \d+ \d+/m);
    assert.match((await saved(page, () => button(page, "VTU").click())).text, /UnstructuredGrid/);
    assert.match((await saved(page, () => button(page, "SVG").click())).text, /<svg/);
    assert.match((await saved(page, () => button(page, "CSV").click())).text, /^panel,/);
    await page.getByLabel("Colour of the cells").selectOption("area");
    await picture(page, "voronoi-areas");
    await closePage(page);
  });

  it("follows a site that is dragged, without turning the view, and one that is moved by keys", async () => {
    const page = await openSquare();
    await addSite(page, "v9", 1);
    await addSite(page, "v54", 2);
    const before = (await page.locator(".viewer canvas").boundingBox());
    // A click next to the dot of a site chooses it, which gives its position in the view.
    const box = before;
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.click(x, y);
    await until(async () => (await fact(page, "Cells")) === "3", "the site that was clicked");
    const placed = await page.locator('[aria-label="Voronoi diagram"]').getByText(/^Site 2: Face/).textContent();
    const asked = page.asked.length;
    await page.mouse.move(x, y);
    await page.mouse.down();
    for (const share of [0.25, 0.5, 0.75, 1]) await page.mouse.move(x + 60 * share, y - 30 * share);
    await until(() => page.asked.length > asked, "the diagram on the way");
    assert.equal(page.asked.at(-1).document.statistics, false);
    await page.mouse.up();
    await until(() => page.asked.at(-1).document.statistics === true, "the diagram at the end");
    const dragged = page.asked.at(-1).document.sites;
    assert.equal(dragged.length, 3);
    assert.deepEqual(dragged[0], { vertex: 9 });
    assert.notEqual(await page.locator('[aria-label="Voronoi diagram"]').getByText(/^Site 2: Face/).textContent(), placed);
    // The site is where it was released: a click there chooses it instead of adding another one.
    await page.mouse.click(x + 60, y - 30);
    await page.waitForTimeout(200);
    assert.equal(await fact(page, "Cells"), "3");
    await picture(page, "voronoi-dragged");
    // Keys move the chosen site, too.
    await page.locator(".viewer canvas").focus();
    await page.keyboard.press("Shift+ArrowLeft");
    await until(() => JSON.stringify(page.asked.at(-1).document.sites[2]) !== JSON.stringify(dragged[2]), "the site moved by a key");
    const moved = JSON.stringify(page.asked.at(-1).document.sites[2]);
    await button(page, "Move the chosen site up").click();
    await until(() => JSON.stringify(page.asked.at(-1).document.sites[2]) !== moved, "the site moved by a button");
    await button(page, "Hold it").click();
    assert.equal(await page.getByLabel("Held sites").inputValue(), "2");
    await button(page, "Remove it").click();
    await until(async () => (await fact(page, "Cells")) === "2", "two cells");
    assert.match(await hint(page), /^2 sites/);
    await closePage(page);
  });

  it("is shared by a link, tells of a site that is none, and leaves the other tools as they were", async () => {
    const page = await openSquare();
    await addSite(page, "v9", 1);
    await addSite(page, "3:0.2,0.3,0.5", 2);
    await page.getByLabel("Add a site").fill("v999");
    await page.getByLabel("Add a site").press("Enter");
    assert.equal(await page.getByLabel("Add a site").evaluate((field) => field.validity.customError), true);
    await enter(page, "Flat panels", 2);
    const other = await openPage(browser, page.url());
    await until(async () => (await fact(other, "Cells")) === "2", "the cells of the link");
    assert.equal(await other.getByLabel("Flat panels, as a number").inputValue(), "2");
    await closePage(other);
    const colours = await coloured(page);
    await page.getByRole("radio", { name: "Path", exact: true }).check();
    assert.equal(await card(page).isVisible(), false);
    await until(async () => (await coloured(page)) < colours / 2, "a plain surface");
    assert.equal(await page.locator(".points li button").count(), 0, "sites are no points of the other tools");
    await page.getByRole("radio", { name: "Voronoi", exact: true }).check();
    await until(async () => (await coloured(page)) > colours / 2, "the cells again");
    await closePage(page);
  });
});
