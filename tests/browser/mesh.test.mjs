// The mesh page: surfaces, points, paths, distances and means.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { readFile } from "node:fs/promises";
import { browser, closePage, openPage, picture, server, setUp, until } from "./harness.mjs";

setUp({ webgl: true });

const TETRAHEDRON = "v 1 1 1\nv 1 -1 -1\nv -1 1 -1\nv -1 -1 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";

async function open(options) {
  const page = await openPage(browser, `${server.url}/#/mesh`, options);
  await page.getByText("Open a mesh").waitFor();
  return page;
}

async function exported(page, entry) {
  const menu = page.locator(".mesh-stage .menu");
  await menu.locator("summary").click();
  const waiting = page.waitForEvent("download");
  await menu.getByText(entry, { exact: true }).click();
  const file = await waiting;
  return { name: file.suggestedFilename(), bytes: await readFile(await file.path()) };
}

const fact = (page, term) => page.locator('[aria-label="Result"] dt', { hasText: term }).locator("+ dd").textContent();

async function upload(page, name, text) {
  await page.locator('input[type="file"]').setInputFiles({ name, mimeType: "model/obj", buffer: Buffer.from(text) });
}

describe("the mesh page", () => {
  it("shows the sample with a path, its distance field and the mean of its points", async () => {
    const page = await open();
    await page.getByRole("button", { name: "Sample" }).click();
    await page.locator('[aria-label="Result"]').waitFor();
    const length = Number(await fact(page, "Together"));
    assert.ok(length > 1 && length < 40, `paths of ${length}`);
    await picture(page, "mesh-path");
    const paths = await exported(page, "Paths (OBJ)");
    assert.equal(paths.name, "the-sample-paths.obj");
    assert.equal(paths.bytes.toString().match(/^l /gm)?.length, 2, "a polyline for each path");
    assert.match((await exported(page, "Paths (CSV)")).bytes.toString(), /^path,point,x,y,z,length_from_start\n1,0,/);
    await page.getByLabel("Distance", { exact: true }).check();
    await until(async () => (await page.locator(".ramp-box").isVisible()) && (await fact(page, "Error")) === "exact up to rounding", "the field");
    assert.ok((await page.locator(".ramp-ticks span").count()) >= 4, "ticks at the ramp");
    await page.getByLabel("Colours", { exact: true }).selectOption("viridis");
    await page.getByLabel("Spacing of the isolines, mesh units").fill("2");
    await page.getByLabel("Spacing of the isolines, mesh units").press("Enter");
    await page.getByRole("button", { name: "Wireframe" }).click();
    await picture(page, "mesh-distance");
    assert.match((await exported(page, "Distances on the mesh (PLY)")).bytes.toString(), /^ply\nformat ascii 1.0\n[^]*property double distance/);
    assert.match((await exported(page, "Distances (CSV)")).bytes.toString(), /^vertex,x,y,z,distance\n0,/);
    const image = await exported(page, "Picture (PNG)");
    assert.equal(image.name, "the-sample-view.png");
    assert.equal(image.bytes.subarray(1, 4).toString(), "PNG");
    await page.getByLabel("Mean", { exact: true }).check();
    await until(async () => /converged|kink|descent/.test((await page.locator('[aria-label="Result"]').textContent()) ?? ""), "the mean");
    await picture(page, "mesh-mean");
    const asked = page.waitForRequest((request) => request.url().endsWith("/v1/karcher-means"));
    await page.getByLabel("Searches from different starts, as a number").fill("3");
    await page.getByLabel("Searches from different starts, as a number").press("Enter");
    assert.equal((await asked).postDataJSON().starts, 3);
    await until(async () => /^[123] of 3$/.test((await fact(page, "Start")) ?? ""), "the start that led to the mean");
    await page.getByLabel("Path", { exact: true }).check();
    assert.equal(await page.getByLabel("Searches from different starts, as a number").isVisible(), false);
    await closePage(page);
  });

  it("picks points where the surface is clicked, and takes them away", async () => {
    const page = await open();
    await upload(page, "tetrahedron.obj", TETRAHEDRON);
    await page.locator(".facts").getByText("Handles").waitFor();
    const box = await page.locator(".viewer canvas").boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.click(x - 20, y);
    await page.mouse.click(x + 30, y + 20);
    await until(async () => (await page.locator(".points li button").count()) === 2, "two points");
    await page.locator('[aria-label="Result"]').waitFor();
    assert.ok(Number(await fact(page, "Length")) > 0);
    // Dragging a picked point along the surface is one step of the history.
    const words = () => page.locator(".points li span").first().textContent();
    const [length, place] = [await fact(page, "Length"), await words()];
    await page.mouse.move(x - 20, y);
    await page.mouse.down();
    for (let step = 1; step <= 6; ++step) await page.mouse.move(x - 20 - 5 * step, y + 3 * step);
    await page.mouse.up();
    await until(async () => (await fact(page, "Length")) !== length, "another path");
    await page.getByRole("button", { name: "Undo (Ctrl+Z)" }).click();
    await until(async () => (await words()) === place, "the point where it was");
    await page.keyboard.press("Control+Shift+Z");
    await until(async () => (await words()) !== place, "the point where it went");
    await page.getByRole("button", { name: "Fit view" }).click();
    await page.locator(".points li button").first().click();
    await until(async () => !(await page.locator('[aria-label="Result"]').isVisible()), "no path of one point");
    await closePage(page);
  });

  it("takes points by their names, tells of those that are none, and is shared by a link", async () => {
    const page = await open();
    await upload(page, "tetrahedron.obj", TETRAHEDRON);
    await page.locator(".facts").getByText("Handles").waitFor();
    for (const name of ["v0", "v1"]) {
      await page.getByLabel("Add a point").fill(name);
      await page.getByLabel("Add a point").press("Enter");
    }
    await page.locator('[aria-label="Result"]').waitFor();
    assert.ok(Math.abs(Number(await fact(page, "Length")) - Math.sqrt(8)) < 1e-4, "the edge is the shortest path");
    await page.getByLabel("Add a point").fill("@-1,-1,-1");
    await page.getByLabel("Add a point").press("Enter");
    await page.getByText(/^The nearest point of the surface was added, \d.* away from the place\.$/).waitFor();
    assert.equal(await page.locator(".points li").count(), 3);
    await page.locator(".points li button").last().click();
    await page.getByLabel("Add a point").fill("v99");
    await page.getByLabel("Add a point").press("Enter");
    assert.equal(await page.getByLabel("Add a point").evaluate((field) => field.validity.customError), true);
    const other = await openPage(browser, page.url());
    await other.locator('[aria-label="Result"]').waitFor();
    assert.equal(await fact(other, "Length"), await fact(page, "Length"));
    await closePage(other);
    await closePage(page);
  });

  it("shows the server's words about a file that is no mesh", async () => {
    const page = await open();
    await upload(page, "broken.obj", "v 0 0 0\nf 1 2 3\n");
    await page.locator(".mesh-stage .note").waitFor();
    assert.ok((await page.locator(".mesh-stage .note").textContent()).length > 20);
    const [note, view] = [await page.locator(".mesh-stage .note").boundingBox(), await page.locator(".viewer").boundingBox()];
    assert.ok(note.y < view.y + 60, "it stands above the view, not below it");
    await closePage(page);
  });

  it("tells of cracks, and joins them where it is asked for whatever the mesh needs", async () => {
    const page = await open();
    const cracked = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 1 1 1e-7\nv 0 1 0\nv 0 0 1e-7\nf 1 2 3\nf 6 4 5\n";
    await upload(page, "cracked.obj", cracked);
    const notes = page.locator('[aria-label="Surface"] .note');
    await notes.filter({ hasText: "open along cracks: 2 vertices differ" }).waitFor();
    await page.getByText("Repairs at upload").click();
    await page.getByLabel("Drop faces without area").check();
    await page.getByLabel("Whatever the mesh needs").check();
    assert.equal(await page.getByLabel("Drop faces without area").isChecked(), false, "what is needed includes it");
    await upload(page, "cracked.obj", cracked);
    await notes.filter({ hasText: "Repaired: 6 vertices and 2 faces became 4 vertices and 2 faces." }).waitFor();
    await notes.filter({ hasText: "2 vertices were welded to an earlier one." }).waitFor();
    assert.equal(await notes.filter({ hasText: "cracks" }).count(), 0);
    await closePage(page);
  });

  it("repairs a cracked mesh by one click, whether it was just uploaded or opened from the list", async () => {
    const page = await open();
    const cracked = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 1 1 2e-7\nv 0 1 0\nv 0 0 2e-7\nf 1 2 3\nf 6 4 5\n";
    const notes = page.locator('[aria-label="Surface"] .note');
    const repair = page.getByRole("button", { name: "Repair the mesh" });
    await upload(page, "cracked.obj", cracked);
    await repair.waitFor();
    await picture(page, "mesh-cracked");
    const id = await page.getByLabel("Meshes on the server").inputValue();
    assert.ok(id, "the list names the mesh that is shown");
    for (const again of [false, true]) {
      if (again) {
        await page.getByLabel("Meshes on the server").selectOption(id);
        await notes.filter({ hasText: "open along cracks" }).waitFor();
      }
      await repair.click();
      await notes.filter({ hasText: "Repaired: 6 vertices and 2 faces became 4 vertices and 2 faces." }).waitFor();
      assert.equal(await notes.filter({ hasText: "cracks" }).count(), 0);
      assert.equal(await repair.count(), 0);
      assert.equal(await page.getByLabel("Whatever the mesh needs").isChecked(), false, "the next file is not repaired unasked");
    }
    await closePage(page);
  });

  it("offers the repairs that mend a file, makes them, and tells what they changed", async () => {
    const page = await open();
    await upload(page, "doubled.obj", `${TETRAHEDRON}v 0 1.5 0\nv 0 0 3\nf 1 2 3\nf 1 2 1\n`);
    const repair = page.getByRole("button", { name: "Repair and upload" });
    await repair.waitFor();
    await page.locator(".mesh-stage .note", { hasText: "degenerate" }).waitFor();
    assert.ok(await page.getByLabel("Whatever the mesh needs").isChecked(), "what helps is marked");
    assert.equal(await page.getByLabel("Drop faces that are given twice").isChecked(), false);
    await repair.click();
    await page.locator(".facts").getByText("Handles").waitFor();
    const notes = page.locator('[aria-label="Surface"] .note');
    await until(async () => /^Repaired: 6 vertices and 6 faces became \d+ vertices and 4 faces\.$/.test((await notes.first().textContent()) ?? ""), "the report");
    await notes.filter({ hasText: "1 degenerate face was dropped." }).waitFor();
    assert.equal(await repair.isVisible(), false);
    await page.getByText("Repairs at upload").click();
    assert.equal(await page.getByLabel("Whatever the mesh needs").isChecked(), false, "the next file is not repaired unasked");
    await picture(page, "mesh-repaired");
    await closePage(page);
  });

  it("turns by keys", async () => {
    const page = await open();
    await upload(page, "tetrahedron.obj", TETRAHEDRON);
    await page.locator(".facts").getByText("Handles").waitFor();
    const view = page.locator(".viewer canvas");
    const before = await view.screenshot();
    await view.focus();
    await page.keyboard.press("ArrowLeft");
    await page.keyboard.press("ArrowLeft");
    await page.waitForTimeout(200);
    assert.ok(!before.equals(await view.screenshot()), "another side of it");
    await closePage(page);
  });
});
