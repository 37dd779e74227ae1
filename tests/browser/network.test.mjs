// Networks on the mesh page: construction, fixed points, relaxation with intermediate states, and files.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { announcements, browser, closePage, openPage, picture, server, setUp, until, wordsOf } from "./harness.mjs";
import { saved } from "./weave_page.mjs";

setUp({ webgl: true });

/** A plane square with side 2. */
const SQUARE = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\n";

/** A torus around the y axis, with `along` vertices along it and `around` vertices around its tube. */
function torus(along, around) {
  const rows = [];
  for (let i = 0; i < along; ++i) {
    for (let j = 0; j < around; ++j) {
      const [u, v] = [(2 * Math.PI * i) / along, (2 * Math.PI * j) / around];
      const out = 1.2 + 0.5 * Math.cos(v);
      rows.push(`v ${out * Math.sin(u)} ${0.5 * Math.sin(v)} ${out * Math.cos(u)}`);
    }
  }
  const number = (i, j) => (i % along) * around + (j % around) + 1;
  for (let i = 0; i < along; ++i) {
    for (let j = 0; j < around; ++j) rows.push(`f ${number(i, j)} ${number(i + 1, j)} ${number(i + 1, j + 1)}`, `f ${number(i, j)} ${number(i + 1, j + 1)} ${number(i, j + 1)}`);
  }
  return rows.join("\n");
}

const fact = (page, term) => page.locator(".relaxation:not(.voronoi) .facts dt", { hasText: term }).locator("+ dd").textContent();
const button = (page, name) => page.getByRole("button", { name, exact: true });
// Only the visible field is used, because other tools have hidden fields with the same names.
const number = (page, name) => page.getByLabel(`${name}, as a number`, { exact: true }).locator("visible=true");

async function enter(page, name, value) {
  await number(page, name).fill(String(value));
  await number(page, name).press("Enter");
}

async function open(options) {
  const page = await openPage(browser, `${server.url}/#/mesh`, options);
  await page.getByText("Open a mesh").waitFor();
  page.relaxations = [];
  page.on("request", (request) => {
    if (request.method() === "POST" && request.url().endsWith("/v1/embedded-systems")) page.relaxations.push(request.postDataJSON());
  });
  return page;
}

const square = (options) => surface(SQUARE, options);

async function surface(obj, options) {
  const page = await open(options);
  await page.locator('input[type="file"]').setInputFiles({ name: "surface.obj", mimeType: "model/obj", buffer: Buffer.from(obj) });
  await page.locator(".facts").getByText("Handles").waitFor();
  await page.getByRole("radio", { name: "Network", exact: true }).check();
  return page;
}

async function sample() {
  const page = await open();
  await button(page, "Sample").click();
  await page.locator('[aria-label="Result"]').waitFor();
  await page.getByRole("radio", { name: "Network", exact: true }).check();
  return page;
}

const rested = (page) => page.locator(".relaxation:not(.voronoi) .stop", { hasText: "is at rest" }).waitFor();

/** Number of pixels of a picture of the view that are darker than the background. */
const covered = (page, png) => page.evaluate(async (bytes) => {
  const bitmap = await createImageBitmap(new Blob([new Uint8Array(bytes)], { type: "image/png" }));
  const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
  context.drawImage(bitmap, 0, 0);
  const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
  let count = 0;
  for (let k = 0; k < data.length; k += 4) if (data[k] < 225) ++count;
  return count;
}, [...png]);

/** Clicks at an offset in pixels from the middle of the view. */
async function clickView(page, right, down) {
  const box = await page.locator(".viewer canvas").boundingBox();
  await page.mouse.click(box.x + box.width / 2 + right, box.y + box.height / 2 + down);
}

/** A picture of the view. The page is scrolled to its top before, so that rows of pixels at the view's edges are the same in each. */
async function seen(page) {
  await page.evaluate(() => scrollTo(0, 0));
  return page.locator(".viewer canvas").screenshot();
}

describe("a network on a surface", () => {
  it("of random points is made, relaxed with its progress in sight, looked at iteration by iteration, and saved", async () => {
    const page = await sample();
    const view = await page.locator(".viewer").boundingBox();
    await enter(page, "Least distance of two points", 0.35);
    await button(page, "Make the network").click();
    await until(() => button(page, "Make the network").isDisabled(), "the network");
    assert.equal(page.relaxations[0].points.radius, 0.35);
    await picture(page, "network-made");
    await button(page, "Relax").click();
    await page.locator(".relaxation:not(.voronoi) .stop", { hasText: /at rest|limit|equally short/ }).waitFor();
    await picture(page, "network-relaxed");
    const place = () => page.locator(".viewer").evaluate((viewer) => [viewer.clientHeight, viewer.offsetTop]);
    const relaxed = await place();
    assert.equal(relaxed[0], view.height, "the card below the view does not change its height");
    await page.getByRole("radio", { name: "Path", exact: true }).check();
    assert.deepEqual(await place(), relaxed, "nor does another tool");
    await page.getByRole("radio", { name: "Network", exact: true }).check();
    const iterations = Number((await fact(page, "Iteration")).split(" of ")[1]);
    assert.ok(iterations > 1, `${iterations} iterations`);
    assert.ok((await page.locator(".convergence .achieved").first().getAttribute("d")).length > 20);
    const energy = await fact(page, "Energy");
    await enter(page, "Iteration that is seen", 0);
    await until(async () => (await fact(page, "Iteration")).startsWith("0 of"), "the start");
    assert.notEqual(await fact(page, "Energy"), energy);
    const obj = await saved(page, () => button(page, "OBJ").click());
    assert.equal(obj.name, "network.obj");
    assert.match(obj.text, /^l \d+ \d+/m);
    assert.match((await saved(page, () => button(page, "VTU").click())).text, /UnstructuredGrid/);
    assert.match((await saved(page, () => button(page, "SVG").click())).text, /<svg[^>]*>[^]*10⁻/);
    assert.deepEqual(JSON.parse((await saved(page, () => button(page, "Request").click())).text), page.relaxations[1]);
    await page.getByText("Effects, bill and history").click();
    await page.locator('[aria-label="Effects"] tbody', { hasText: "kept strips" }).waitFor();
    await page.locator(".bill").scrollIntoViewIfNeeded();
    await picture(page, "network-bill");
    await closePage(page);
  });

  it("of picked points is drawn with springs, has fixed points, and comes to rest where the plane says", async () => {
    const page = await square();
    await page.getByRole("combobox", { name: "Points", exact: true }).selectOption("picked");
    for (const name of ["v0", "v1", "v2", "0:0.4,0.4,0.2"]) {
      await page.getByLabel("Add a point").fill(name);
      await page.getByLabel("Add a point").press("Enter");
    }
    await page.getByRole("combobox", { name: "Springs", exact: true }).selectOption("drawn");
    await page.getByLabel("Springs between points").fill("0-3, 1-3::2, 2-3");
    await page.getByLabel("Springs between points").press("Enter");
    await page.getByLabel("Fixed points").fill("0, 1, 2");
    await page.getByLabel("Fixed points").press("Enter");
    await button(page, "Relax").click();
    await rested(page);
    assert.deepEqual(page.relaxations[0].fixed_points, [0, 1, 2]);
    assert.deepEqual(page.relaxations[0].springs[1], { between: [1, 3], rest_length: 0, weight: 2 });
    // The energy |p - a|^2 + 2 |p - b|^2 + |p - c|^2 at p = (0.5, -0.5) is 2.5 + 2 * 0.5 + 2.5.
    assert.equal(await fact(page, "Energy"), "6");
    await picture(page, "network-picked");
    await page.getByLabel("Fixed points").fill("0, 9");
    await page.getByLabel("Fixed points").press("Enter");
    assert.equal(await page.getByLabel("Fixed points").evaluate((field) => field.validity.customError), true);
    await closePage(page);
  });

  it("is picked, joined and fixed by clicks, and shared by a link", async () => {
    const page = await square();
    await page.getByRole("combobox", { name: "Points", exact: true }).selectOption("picked");
    await page.getByRole("combobox", { name: "Springs", exact: true }).selectOption("drawn");
    for (const [right, down] of [[-60, 20], [60, 20], [0, -40]]) await clickView(page, right, down);
    await until(async () => (await page.locator(".points li button").count()) === 3, "three points");
    await page.getByLabel("Joins", { exact: true }).check();
    for (const [right, down] of [[-60, 20], [0, -40], [60, 20], [0, -40]]) await clickView(page, right, down);
    await until(async () => (await page.getByLabel("Springs between points").inputValue()) === "0-2, 1-2", "both springs");
    await page.getByLabel("Fixes", { exact: true }).check();
    for (const [right, down] of [[-60, 20], [60, 20], [0, 60]]) await clickView(page, right, down);
    await until(async () => (await page.getByLabel("Fixed points").inputValue()) === "0, 1", "both fixed points");
    await button(page, "Relax").click();
    await rested(page);
    await picture(page, "network-clicked");
    const other = await openPage(browser, page.url());
    await until(async () => (await other.getByLabel("Fixed points").inputValue()) === "0, 1", "the network of the link");
    await button(other, "Relax").click();
    await rested(other);
    assert.equal(await fact(other, "Energy"), await fact(page, "Energy"));
    await closePage(other);
    await enter(page, "Rest length", 0.5);
    await page.locator(".relaxation:not(.voronoi) .note", { hasText: "changed since" }).waitFor();
    await page.locator(".points li button").first().click();
    assert.equal(await page.getByLabel("Fixed points").inputValue(), "0", "the others have smaller numbers");
    assert.equal(await page.locator(".relaxation:not(.voronoi)").isVisible(), false);
    await closePage(page);
  });

  it("is seen on its way, and can be cancelled", async () => {
    const page = await sample();
    await enter(page, "Least distance of two points", 0.35);
    await button(page, "Make the network").click();
    await until(() => button(page, "Make the network").isDisabled(), "the network");
    assert.equal(await page.locator(".relaxation:not(.voronoi)").isVisible(), false, "nothing is relaxed yet");
    // Gradient descent takes long enough to observe and to cancel it.
    await page.getByText("Accuracy, method and effects").click();
    await page.getByRole("region", { name: "Network" }).getByLabel("Method", { exact: true }).selectOption("gradient_descent");
    await page.getByRole("region", { name: "Network" }).getByLabel("Tolerance of the gradient").selectOption("1e-12");
    await enter(page, "Most iterations", 2000);
    await page.getByLabel("Fixed points").fill("0, 7");
    await page.getByLabel("Fixed points").press("Enter");
    await button(page, "Relax").click();
    await page.locator(".working", { hasText: /Relaxing, iteration \d+/ }).waitFor();
    await until(async () => Number(await fact(page, "Iteration")) > 2, "iterations");
    await picture(page, "network-running");
    const dismissed = page.waitForRequest((request) => request.method() === "DELETE");
    await page.locator(".working").getByRole("button", { name: "Cancel" }).click();
    await dismissed;
    await until(async () => !(await page.locator(".working").isVisible()), "the end of the work");
    assert.equal(await page.locator(".relaxation:not(.voronoi)").isVisible(), false);
    await enter(page, "Most iterations", 3);
    await button(page, "Relax").click();
    await page.locator(".relaxation:not(.voronoi) .stop", { hasText: "not at rest yet" }).waitFor();
    const energy = Number(await fact(page, "Energy"));
    await button(page, "Go on from here").click();
    await until(async () => Number(await fact(page, "Energy")) < energy, "less energy");
    await closePage(page);
  });

  it("is a membrane whose triangles are seen by their stretches, on the way and at the end, and saved as it came to rest", async () => {
    const page = await sample();
    await enter(page, "Least distance of two points", 0.5);
    await page.getByRole("radio", { name: "Membrane", exact: true }).check();
    assert.equal(await page.getByRole("combobox", { name: "Springs", exact: true }).isVisible(), false);
    await enter(page, "Rest scale", 0.92);
    await enter(page, "Young’s modulus", 4);
    await enter(page, "Poisson’s ratio", 0.7);
    await button(page, "Make the network").click();
    await until(() => button(page, "Make the network").isDisabled(), "the membrane");
    assert.deepEqual(page.relaxations[0].springs, []);
    assert.deepEqual(page.relaxations[0].triangles, { kind: "voronoi_dual" });
    await picture(page, "membrane-made");
    await page.getByText("Accuracy, method and effects").click();
    assert.equal(await page.getByLabel("Length of a spring").isVisible(), false, "sides are shortest paths");
    await enter(page, "Most iterations", 30);
    const heard = await announcements(page);
    const facts = await wordsOf(page, ".relaxation:not(.voronoi) .facts");
    await button(page, "Relax").click();
    // The texts are recorded, because the relaxation may end between two checks.
    await until(async () => (await facts()).some((words) => words.includes("≈")), "stretches on the way");
    await picture(page, "membrane-running");
    await page.locator(".relaxation:not(.voronoi) .stop", { hasText: /at rest|limit|equally short/ }).waitFor();
    const request = page.relaxations[1];
    assert.deepEqual(request.membrane, { youngs_modulus: 4, poisson_ratio: 0.49, thickness: 1, rest_scale: 0.92 }, "no more than the page offers");
    assert.equal(Number((await fact(page, "Triangles")).replace(",", "")), request.triangles.length);
    const [least, greatest] = [Number(await fact(page, "Least stretch")), Number(await fact(page, "Greatest stretch"))];
    assert.ok(least > 0 && least < greatest, `${least} to ${greatest}`);
    await until(async () => (await heard()).some((words) => words.includes("Greatest stretch: ")), "words about the end");
    assert.equal(await page.getByLabel("Colour of the springs").isVisible(), false);
    const ends = page.locator(".ramp-choice:visible .ramp-words span");
    const most = Number(await ends.nth(1).textContent());
    assert.ok(Math.abs(most - greatest) <= 0.006 * greatest, `the legend ends at ${most}, the stretches at ${greatest}`);
    await picture(page, "membrane-relaxed");
    await page.getByLabel("Colour of the triangles").selectOption("density");
    await until(async () => Number(await ends.nth(1).textContent()) !== most, "another legend");
    await picture(page, "membrane-energy");
    await enter(page, "Iteration that is seen", 0);
    await until(async () => (await fact(page, "Greatest stretch")) === "≈ 1.087", "the start");
    const vtu = await saved(page, () => button(page, "VTU").click());
    const stretches = /Name="greater_stretch"[^>]*>([^<]*)</.exec(vtu.text)[1].trim().split(/\s+/).map(Number);
    assert.equal(stretches.length, request.triangles.length);
    assert.equal(Number(Math.max(...stretches).toPrecision(4)), greatest, "the file has the membrane at rest, not at its start");
    assert.match((await saved(page, () => button(page, "OBJ").click())).text, /^f \d+ \d+ \d+/m);
    await closePage(page);
  });

  it("has springs beside a membrane, each with colours of its own", async () => {
    const page = await square();
    await page.getByRole("combobox", { name: "Points", exact: true }).selectOption("picked");
    for (const name of ["v0", "v1", "v2", "v3", "0:0.3,0.4,0.3"]) {
      await page.getByLabel("Add a point").fill(name);
      await page.getByLabel("Add a point").press("Enter");
    }
    await page.getByRole("radio", { name: "Both", exact: true }).check();
    await page.getByRole("combobox", { name: "Springs", exact: true }).selectOption("drawn");
    await page.getByLabel("Springs between points").fill("0-4");
    await page.getByLabel("Springs between points").press("Enter");
    await page.getByLabel("Fixed points").fill("0, 1, 2, 3");
    await page.getByLabel("Fixed points").press("Enter");
    await enter(page, "Rest scale", 1);
    await button(page, "Relax").click();
    await rested(page);
    assert.equal(await fact(page, "Springs"), "1");
    assert.equal(await fact(page, "Triangles"), "2", "the other two would be obtuse at the border");
    assert.ok(Number(await fact(page, "Least stretch")) < 1 && Number(await fact(page, "Greatest stretch")) > 1, "the spring pulls one point");
    for (const name of ["Colour of the springs", "Colour of the triangles"]) assert.equal(await page.getByLabel(name).isVisible(), true);
    await page.emulateMedia({ colorScheme: "dark" });
    await page.waitForTimeout(300);
    await picture(page, "membrane-both");
    const other = await openPage(browser, page.url());
    await until(() => other.getByRole("radio", { name: "Both", exact: true }).isChecked(), "the membrane of the link");
    await button(other, "Relax").click();
    await rested(other);
    assert.equal(await fact(other, "Energy"), await fact(page, "Energy"));
    await closePage(other);
    await closePage(page);
  });

  it("lies on a shell that gives way before one's eyes, held at some vertices, and is saved with it", async () => {
    const page = await surface(torus(30, 14));
    const canvas = page.locator(".viewer canvas");
    await enter(page, "Least distance of two points", 0.5);
    await page.getByRole("radio", { name: "Shell", exact: true }).check();
    await enter(page, "Young’s modulus of the shell (energy / length³)", 500);
    await button(page, "Hold the lowest tenth").click();
    const held = await page.getByLabel("Held vertices").inputValue();
    assert.match(held, /^\d+.*\d$/);
    await page.getByLabel(/^Supports: a click/).check();
    const heard = await announcements(page);
    await clickView(page, 0, 0);
    await until(async () => (await page.getByLabel("Held vertices").inputValue()) !== held, "another support");
    await until(async () => (await heard()).some((words) => /Vertex \d+ is held/.test(words)), "words about it");
    await clickView(page, 0, 0);
    await until(async () => (await page.getByLabel("Held vertices").inputValue()) === held, "that it is let go again");
    await page.getByLabel(/^Supports: a click/).uncheck();
    await button(page, "Make the network").click();
    await until(() => button(page, "Make the network").isDisabled(), "the network");
    await canvas.focus();
    for (let k = 0; k < 14; ++k) await page.keyboard.press("ArrowRight");
    await page.waitForTimeout(300);
    await picture(page, "host-made");
    const before = await seen(page);
    await button(page, "Relax").click();
    await rested(page);
    assert.equal(await page.locator(".host-legend").isVisible(), true);
    const { host } = page.relaxations.at(-1);
    assert.equal(host.kind, "shell");
    assert.equal(host.youngs_modulus, 500);
    assert.ok(host.fixed_vertices.length > 2);
    assert.ok(Number(await fact(page, "Largest displacement")) > 0.02);
    assert.ok(Number(await fact(page, "Volume over that at rest")) < 0.99);
    const sum = (await Promise.all(["springs", "stretching the shell", "bending the shell"].map((term) => fact(page, `Energy of ${term}`)))).reduce((all, text) => all + Number(text), 0);
    const energy = Number(await page.locator(".relaxation:not(.voronoi) .facts dt", { hasText: /^Energy$/ }).locator("+ dd").textContent());
    assert.ok(Math.abs(sum - energy) < 0.002 * energy, `${sum} is ${energy}`);
    await page.waitForTimeout(300);
    await picture(page, "host-shell");
    const after = await seen(page);
    assert.notDeepEqual(after, before, "the surface is drawn as it is now");
    await page.getByLabel("Colour of the surface").selectOption("none");
    await page.waitForTimeout(300);
    const bent = await seen(page);
    await enter(page, "Iteration that is seen", 0);
    await until(async () => !(await seen(page)).equals(bent), "the start");
    await enter(page, "Iteration that is seen", 999);
    await until(async () => (await seen(page)).equals(bent), "the end again");
    await page.getByLabel("Show the shape at rest").check();
    await page.waitForTimeout(300);
    const [less, more] = [await covered(page, bent), await covered(page, await seen(page))];
    assert.ok(more > 10000 && less < 0.95 * more, `the surface, which shrinks, covers ${less} pixels, and ${more} at rest`);
    await page.getByLabel("Colour of the surface").selectOption("stretch");
    await page.waitForTimeout(300);
    await picture(page, "host-at-rest");
    await page.getByLabel("Show the shape at rest").uncheck();
    const [obj, again] = [await saved(page, () => button(page, "OBJ").click()), page.relaxations.at(-1)];
    assert.match(obj.text, /^o host/m);
    assert.deepEqual(again, page.relaxations.at(-2), "the file is of the same request");
    const other = await openPage(browser, page.url());
    await until(() => other.getByRole("radio", { name: "Shell", exact: true }).isChecked(), "the host of the link");
    assert.equal(await other.getByLabel("Held vertices").inputValue(), held);
    await button(other, "Relax").click();
    await rested(other);
    assert.equal(await fact(other, "Largest displacement"), await fact(page, "Largest displacement"));
    await closePage(other);
    await page.getByRole("radio", { name: "Solid", exact: true }).check();
    await enter(page, "Gravity along −z (energy / length⁴)", 5);
    await page.emulateMedia({ colorScheme: "dark" });
    await button(page, "Relax").click();
    await page.locator(".relaxation:not(.voronoi) .facts dt", { hasText: "Tetrahedra" }).waitFor();
    assert.ok(page.relaxations.at(-1).host.gravity[2] < 0);
    await page.waitForTimeout(300);
    await picture(page, "host-solid");
    await closePage(page);
  });

  it("follows supports that are dragged, moved by keys or written, and lets them back", async () => {
    // In a view of this height the vertex that a click in its middle holds is so near to it that a drag from there takes it along.
    const page = await surface(torus(30, 14), { viewport: { width: 1440, height: 720 } });
    const canvas = page.locator(".viewer canvas");
    await enter(page, "Least distance of two points", 0.7);
    await page.getByRole("radio", { name: "Shell", exact: true }).check();
    await button(page, "Hold the lowest tenth").click();
    const standing = await page.getByLabel("Held vertices").inputValue();
    await page.getByLabel(/^Supports: a click/).check();
    await clickView(page, 0, 0);
    await until(async () => (await page.getByLabel("Held vertices").inputValue()) !== standing, "another support");
    await page.getByLabel(/^Supports: a click/).uncheck();
    await button(page, "Relax").click();
    await rested(page);
    const before = page.relaxations.length;
    const still = await seen(page);
    const box = await canvas.boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    for (const share of [0.25, 0.5, 0.75, 1]) {
      await page.mouse.move(x + 50 * share, y - 70 * share);
      await page.waitForTimeout(60);
    }
    await until(() => page.relaxations.length > before, "a relaxation on the way");
    await page.mouse.up();
    const movedTo = () => page.relaxations.at(-1).host.moved_vertices?.[0]?.positions[0];
    assert.equal(page.relaxations.at(-1).host.moved_vertices.length, 1);
    const { vertex } = page.relaxations.at(-1).host.moved_vertices[0];
    assert.ok(!page.relaxations.at(-1).host.fixed_vertices.includes(vertex));
    await until(async () => Number(await fact(page, "Largest displacement")) > 0.3, "the host after the support");
    await rested(page);
    assert.ok(await page.getByText(`Vertex ${vertex} is at`).isVisible());
    await page.waitForTimeout(300);
    await picture(page, "supports-dragged");
    // The drag has not rotated the view: after the supports were put back, the picture is as before.
    const dragged = JSON.stringify(movedTo());
    await button(page, "Put supports back").click();
    await until(() => page.relaxations.at(-1).host.moved_vertices === undefined, "the request without moves");
    await page.mouse.move(box.x + 5, box.y + 5);
    await until(async () => Number(await fact(page, "Largest displacement")) < 0.3, "the host as it was");
    const [atFirst, putBack] = [await covered(page, still), await covered(page, await seen(page))];
    assert.ok(Math.abs(putBack - atFirst) < 0.05 * atFirst, `${putBack} pixels instead of ${atFirst}`);
    // Keys move the chosen support, too.
    await canvas.focus();
    await page.keyboard.press("Shift+ArrowUp");
    await until(() => movedTo(), "the support moved by a key");
    const once = JSON.stringify(movedTo());
    assert.notEqual(once, dragged);
    await button(page, "Move the chosen support left").click();
    await until(() => JSON.stringify(movedTo()) !== once, "the support moved by a button");
    await page.getByLabel("Moved supports").fill(`${vertex}: 1.7 0.2 0.3`);
    await page.getByLabel("Moved supports").press("Enter");
    await until(() => JSON.stringify(movedTo()) === "[1.7,0.2,0.3]", "the support moved to a place that is written");
    await rested(page);
    const other = await openPage(browser, page.url());
    await until(async () => (await other.getByLabel("Moved supports").inputValue()) === `${vertex}: 1.7 0.2 0.3`, "the moves of the link");
    await closePage(other);
    await page.getByLabel("Moved supports").fill("99999: 0 0 0");
    await page.getByLabel("Moved supports").press("Enter");
    assert.equal(await page.getByLabel("Moved supports").evaluate((input) => input.validity.valid), false);
    await page.getByLabel("Moved supports").fill("");
    await page.getByLabel("Moved supports").press("Enter");
    // Connected supports move together.
    await enter(page, "Chosen support", 5);
    await button(page, "Move the chosen support down").click();
    await until(() => (page.relaxations.at(-1).host.moved_vertices?.length ?? 0) > 10, "all of the lowest tenth moved");
    await rested(page);
    await picture(page, "supports-patch");
    await closePage(page);
  });

  it("gives way on the sample as it is offered, and comes to rest", async () => {
    const page = await sample();
    for (const kind of ["Shell", "Solid"]) {
      await page.getByRole("radio", { name: kind, exact: true }).check();
      await button(page, "Relax").click();
      await page.locator(".relaxation:not(.voronoi) .stop", { hasText: "is relaxing" }).waitFor();
      await page.locator(".host-legend").waitFor();
      assert.equal(await page.locator(".working").isVisible(), true, "the surface is redrawn while it is worked on");
      await picture(page, `host-sample-${kind.toLowerCase()}-running`);
      await page.locator(".relaxation:not(.voronoi) .facts dt", { hasText: kind === "Shell" ? "bending the shell" : "Tetrahedra" }).waitFor();
      await rested(page);
      await page.waitForTimeout(300);
      await picture(page, `host-sample-${kind.toLowerCase()}`);
    }
    await closePage(page);
  });

  it("tells of compressed springs, and shows the server's words about what it refuses", async () => {
    const page = await square();
    await page.getByRole("combobox", { name: "Points", exact: true }).selectOption("per_face");
    await page.getByRole("combobox", { name: "Springs", exact: true }).selectOption("adjacent_faces");
    await page.getByLabel("Fixed points").fill("0, 1");
    await page.getByLabel("Fixed points").press("Enter");
    await enter(page, "Rest length", 1.4);
    await button(page, "Relax").click();
    await page.locator(".relaxation:not(.voronoi) .notes .note", { hasText: /compress/ }).waitFor();
    assert.equal(await fact(page, "Under compression"), "1");
    await page.route("**/v1/embedded-systems", (route) =>
      route.fulfill({ status: 422, contentType: "application/problem+json", body: JSON.stringify({ type: "urn:supple:error:network.radius", title: "Radius not possible", status: 422, detail: "Too many points may fit.", code: "network.radius" }) }));
    await page.getByRole("combobox", { name: "Points", exact: true }).selectOption("poisson_disk");
    await button(page, "Make the network").click();
    await page.locator(".mesh-stage .note", { hasText: "Too many points may fit." }).waitFor();
    await closePage(page);
  });
});
