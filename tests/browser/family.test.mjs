// The family page: types, drags, checks, files, the server's families, atlases and trainings.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { describe, it } from "node:test";
import { FamilyPage, GAPS, linkTo, SLANTED } from "./family_page.mjs";
import { announcements, browser, closePage, heldJob, openPage, picture, server, setUp, until } from "./harness.mjs";

setUp();

const ATLAS_MS = 180_000;

const withFamily = async (link, act, options) => {
  const family = await FamilyPage.open(browser, server.url, link, options);
  await act(family, family.page);
  await closePage(family.page);
};

/** Removes what a test has added, so that each finds the names free. */
const removed = (id) => fetch(`${server.url}/v1/families/${id}`, { method: "DELETE" });

describe("the family page", () => {
  it("begins with an isohedral type, whose tiling is drawn and fills the plane", () =>
    withFamily("", async (family, page) => {
      assert.match(await page.locator(".family-tiling").getAttribute("aria-label"), /^Tiling of my-ih21 at 0\.1/);
      assert.match(await family.summary.textContent(), /^The tiles fill the plane within all bounds/);
      assert.equal(await family.handles.count(), 5 + 3, "vertices, and one for each shape of edges");
      assert.ok((await page.locator(".beams use").count()) > 4, "copies of the cell fill the drawing");
      await picture(page, "family");
    }));

  it("offers each of the 81 types and the families of the server, and draws the one that is chosen", () =>
    withFamily("", async (family, page) => {
      await page.locator(".type-menu summary").click();
      await page.getByRole("button", { name: "IH93, no parameters" }).waitFor();
      assert.equal(await page.getByRole("list", { name: "Isohedral types" }).locator("li").count(), 81);
      await picture(page, "family-types");
      await page.getByRole("button", { name: "IH41, 2 parameters" }).click();
      await until(async () => /my-ih41/.test(await page.locator(".family-tiling").getAttribute("aria-label")), "the other type");
      await family.checked();
      await page.locator(".type-menu summary").click();
      await page.getByRole("list", { name: "Families of this server" }).getByRole("button", { name: /^IH29:/ }).click();
      await until(async () => (await family.value("Height of the pentagon")) > 0, "the parameter of the family");
      await until(async () => /^IH29 comes with the server/.test(await page.locator(".library-state").textContent()), "the family of the server");
      await family.button("Undo (Ctrl+Z)").click();
      await until(async () => /my-ih41/.test(await page.locator(".family-tiling").getAttribute("aria-label")), "the type before");
    }));

  it("draws the tiling while a vertex is dragged, which moves the parameters and is one step", () =>
    withFamily(linkTo(SLANTED), async (family, page) => {
      const before = await family.tile();
      await family.drag("Vertex 3", 20, -30, async () => {
        assert.notEqual(await family.tile(), before, "drawn before the mouse is released");
      });
      await until(async () => (await family.value("Slant")) > 0.3, "the parameter that has moved");
      await family.button("Undo (Ctrl+Z)").click();
      await until(async () => (await family.value("Slant")) === 0.3, "the parameter of before");
      assert.equal(await family.tile(), before);
      await page.keyboard.press("Control+Shift+Z");
      await until(async () => (await family.value("Slant")) > 0.3, "the drag again");
      await family.drag("Vertex 2", 20, 0);
      assert.equal(await family.handle("Vertex 2").evaluate((one) => one.classList.contains("held")), true, "no parameter moves it");
    }));

  it("draws within a frame of each movement of the pointer", () =>
    withFamily("", async (family, page) => {
      const late = await page.evaluate(async () => {
        const handle = [...document.querySelectorAll(".family-tiling .handle")][1];
        const tile = document.querySelector(".tile-outline");
        const { x, y, width, height } = handle.getBoundingClientRect();
        const at = (dx) => ({ bubbles: true, pointerId: 1, isPrimary: true, button: 0, clientX: x + width / 2 + dx, clientY: y + height / 2 - dx });
        handle.setPointerCapture = () => {};
        handle.dispatchEvent(new PointerEvent("pointerdown", at(0)));
        let missed = 0;
        for (let step = 1; step <= 20; ++step) {
          const before = tile.getAttribute("d");
          handle.dispatchEvent(new PointerEvent("pointermove", at(step)));
          await new Promise((resolve) => requestAnimationFrame(resolve));
          if (tile.getAttribute("d") === before) ++missed;
        }
        handle.dispatchEvent(new PointerEvent("pointerup", at(20)));
        return missed;
      });
      assert.equal(late, 0, "each movement was drawn in the next frame");
    }));

  it("changes the tile itself, whose neighbours follow, and makes a drag a parameter", () =>
    withFamily(linkTo(SLANTED), async (family, page) => {
      await page.getByRole("radio", { name: "The tile", exact: true }).check();
      await family.drag("Vertex 2", 30, -20);
      await family.checked();
      assert.equal(await family.summary.getAttribute("data-grade"), "good", "the tiles still fill the plane");
      await family.button("Make the last drag a parameter").click();
      await until(async () => (await family.value("Place of vertex 2")) === 1, "the parameter");
      const after = await family.tile();
      await family.number("Place of vertex 2").fill("0");
      await family.number("Place of vertex 2").press("Enter");
      await until(async () => (await family.tile()) !== after, "the tile before the drag");
      await family.checked();
      assert.equal(await family.summary.getAttribute("data-grade"), "good");
    }));

  it("bends edges, whose heights become parameters", () =>
    withFamily("", async (family, page) => {
      const straight = await family.tile();
      await family.drag("Height of the edges b", 12, 8);
      assert.notEqual(await family.tile(), straight);
      await until(async () => (await page.getByLabel("Edges b", { exact: true }).inputValue()) === "curve", "the line of the edge");
      await page.getByRole("button", { name: "Height as a parameter (edges b)" }).click();
      await until(async () => (await family.number("Height of the edges b").count()) === 1, "the parameter of the height");
      await page.getByLabel("Edges c", { exact: true }).selectOption("bent");
      await family.handle("Point 1 of the edges c").waitFor();
      await family.checked();
      await picture(page, "family-edges");
      await family.handle("Point 1 of the edges c").focus();
      await page.keyboard.press("Delete");
      await until(async () => (await page.getByLabel("Edges c", { exact: true }).inputValue()) === "straight", "the edge without its point");
    }));

  it("has parameters with words and bounds, and beams that are fixed or a parameter", () =>
    withFamily(linkTo(SLANTED), async (family, page) => {
      await page.getByLabel("Words and bounds of “Slant”").click();
      await page.getByLabel("What changes with it").fill("How far it leans");
      await page.keyboard.press("Tab");
      await family.number("How far it leans").waitFor();
      await page.getByLabel("Words and bounds of “How far it leans”").click();
      await page.getByLabel("To", { exact: true }).fill("0.2");
      await page.getByLabel("To", { exact: true }).press("Enter");
      await until(async () => (await family.value("How far it leans")) === 0.2, "the parameter within its bounds");
      await page.getByLabel("From", { exact: true }).fill("0.9");
      await page.getByLabel("From", { exact: true }).press("Enter");
      assert.match(await page.getByLabel("From", { exact: true }).evaluate((field) => field.validationMessage), /must be below the upper one/);
      const relative = await family.value("Beam width over the mean side, %");
      assert.ok(relative > 9 && relative < 11, `${relative} % of sides of 1`);
      await family.button("Make it a parameter").click();
      await family.number("Width of the beams").waitFor();
      await page.getByText(/is parameter 2; here it is/).waitFor();
      await family.button("Fix the width").click();
      await until(async () => (await family.number("Width of the beams").count()) === 0, "the fixed width");
    }));

  it("marks what the server's check finds, in sentences without pointers", () =>
    withFamily(linkTo(GAPS), async (family, page) => {
      assert.equal(await family.summary.getAttribute("data-grade"), "faulty");
      const finding = await page.locator(".findings li").first().textContent();
      assert.match(finding, /gap/);
      assert.doesNotMatch(finding, /\/|definition|_/);
      assert.equal(await page.locator(".finding-mark.fault").count(), 1);
      assert.equal(await family.button("Add to the server").isDisabled(), true, "a family with faults is not added");
      await picture(page, "family-gap");
      await family.number("Slant").fill("0.4");
      await family.number("Slant").press("Enter");
      await until(async () => (await page.locator(".finding-mark").count()) === 0, "no mark at other parameters");
      await page.getByRole("button", { name: /^Show where/ }).click();
      await until(async () => (await page.locator(".finding-mark").count()) === 1, "the mark where it was found");
    }));

  it("marks at once where the shown tile crosses itself", () =>
    withFamily(linkTo({ ...SLANTED, tile: { ...SLANTED.tile, vertices: [[0, 0], [[0, 1], 1], [1, 0], [[1, 1], 1]] } }), async (family, page) => {
      assert.ok((await page.locator(".crossing-mark").count()) > 0);
      await page.getByText("The shown tile").waitFor();
    }));

  it("is used by the keyboard alone", () =>
    withFamily(linkTo(SLANTED), async (family, page) => {
      const heard = await announcements(page);
      await family.handle("Vertex 3").focus();
      for (let k = 0; k < 3; ++k) await page.keyboard.press("ArrowRight");
      await until(async () => (await family.value("Slant")) > 0.3, "the vertex that has moved");
      await until(async () => (await heard()).some((words) => /Vertex 3: x /.test(words)), "the announcement");
      await page.keyboard.press("Control+z");
      await until(async () => (await family.value("Slant")) === 0.3, "one step for the series of keys");
    }));

  it("is shared by a link", () =>
    withFamily(linkTo(SLANTED), async (family, page) => {
      await family.drag("Vertex 3", 15, 0);
      await until(async () => /shown=0\.3\d/.test(page.url()), "the parameters in the address");
      const other = new FamilyPage(await openPage(browser, page.url()));
      await other.checked();
      assert.equal(await other.value("Slant"), await family.value("Slant"));
      await closePage(other.page);
    }));
});

describe("a file", () => {
  it("of a definition is opened, saved and refused with a sentence", () =>
    withFamily("", async (family, page) => {
      await family.openFile("slanted.json", JSON.stringify({ definition: SLANTED }));
      await until(async () => (await family.number("Slant").count()) === 1, "the parameter of the file");
      const waiting = page.waitForEvent("download");
      await family.button("Save").click();
      const file = await waiting;
      assert.equal(file.suggestedFilename(), "slanted.json");
      assert.deepEqual(JSON.parse(await readFile(await file.path(), "utf8")).tile.vertices, SLANTED.tile.vertices);
      await family.openFile("broken.json", JSON.stringify({ ...SLANTED, beam_width: "wide" }));
      await page.getByText("broken.json: This is no definition of a family: the width of the beams must be a number").waitFor();
    }));

  it("with the drawing of a tile becomes a family of the type that is chosen", async () => {
    await removed("leaning");
    await withFamily("", async (family, page) => {
      await family.openFile("leaning.svg", "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 200 100'><path d='M0 0 H100 L130 80 H30 Z'/></svg>", "image/svg+xml");
      await page.getByLabel("Isohedral type of the drawn tile").selectOption("41");
      await family.button("Make a family of it").click();
      await page.locator(".library .note", { hasText: "leaning is on the server." }).waitFor();
      await until(async () => /^Tiling of leaning/.test(await page.locator(".family-tiling").getAttribute("aria-label")), "the drawn tile");
      await family.button("Remove from the server").click();
      await page.getByText("The server does not have this family yet.").waitFor();
    });
  });
});

describe("the server", () => {
  it("gets a family, tells of another one of its name, replaces it and removes it", async () => {
    await removed("slanted");
    await withFamily(linkTo(SLANTED), async (family, page) => {
      await family.button("Add to the server").click();
      await until(async () => (await page.locator(".library-state").textContent()) === "The server has slanted.", "the family");
      await page.getByText("Designs need a network of the family: train one below.").waitFor();
      await page.getByRole("radio", { name: "The tile", exact: true }).check();
      await family.drag("Vertex 2", 20, 0);
      await page.getByText("The server has another family of the name slanted.").waitFor();
      await family.checked();
      await family.button("Replace the stored one").click();
      await page.getByText("The server has slanted.", { exact: true }).waitFor();
      await family.button("Remove from the server").click();
      await page.getByText("The server does not have this family yet.").waitFor();
    });
  });

  it("has families of its own, whose changes need another name", () =>
    withFamily("", async (family, page) => {
      await page.locator(".type-menu summary").click();
      await page.getByRole("list", { name: "Families of this server" }).getByRole("button", { name: /^IH67:/ }).click();
      await page.getByText("IH67 comes with the server.", { exact: true }).waitFor();
      await page.getByRole("radio", { name: "The tile", exact: true }).check();
      await family.drag("Vertex 3", 10, 5);
      await page.getByText("IH67 comes with the server: choose another name.").waitFor();
      await family.button("Give it a free name").click();
      await page.getByText("The server does not have this family yet.").waitFor();
      assert.equal(await page.getByLabel("Name", { exact: true }).inputValue(), "my-ih67-2");
    }));

  it("uses a family that has a network on the page Design", () =>
    withFamily("", async (family, page) => {
      await page.locator(".type-menu summary").click();
      await page.getByRole("list", { name: "Families of this server" }).getByRole("button", { name: /^IH67:/ }).click();
      await family.button("Use it on the page Design").click();
      await page.locator(".design-page .result .family").waitFor();
      assert.match(page.url(), /#\/design\?.*family=IH67/);
      assert.equal(await page.getByLabel("Family of tilings").inputValue(), "IH67");
    }));
});

describe("an atlas", () => {
  it("of a family of the server comes at once, and its samples are drawn", () =>
    withFamily("", async (family, page) => {
      await page.locator(".type-menu summary").click();
      await page.getByRole("list", { name: "Families of this server" }).getByRole("button", { name: /^IH21:/ }).click();
      await family.button("Make the atlas").click();
      await page.locator(".reach-row").first().waitFor({ timeout: ATLAS_MS });
      assert.equal(await page.locator(".reach-row").count(), 18);
      assert.match(await page.locator(".atlas-words p").first().textContent(), /^The family meets \d+ of 18 reference profiles at rest/);
      assert.ok((await page.locator(".sample-plot .sample").count()) > 100);
      await until(async () => ((await page.locator(".other-samples").getAttribute("d")) ?? "").length > 1000, "the samples of other families");
      await picture(page, "family-atlas");
      const before = await family.tile();
      const mark = page.getByRole("slider", { name: "Sample of the atlas" });
      await mark.focus();
      await page.keyboard.press("End");
      await until(async () => (await family.tile()) !== before, "the tiling of the sample");
      await page.getByLabel("Across", { exact: true }).selectOption("parameter-0");
      await page.getByText("Values of the atlas as tables").click();
      assert.equal(await page.locator('[aria-label^="Reference profiles: deviation"] tbody tr').count(), 18);
    }));

  it("of one's own is a job with progress, which is in the tray and can be cancelled", () =>
    withFamily(linkTo(SLANTED), async (family, page) => {
      const job = await heldJob(page, "/v1/family-atlases");
      job.tell(0.3, "stiffness");
      await family.button("Make the atlas").click();
      await page.getByText("Making the atlas: stiffness").waitFor();
      await page.locator(".job-tray > summary").click();
      await page.locator(".job-tray .job", { hasText: "Atlas: slanted" }).waitFor();
      await page.keyboard.press("Escape");
      let asked = 0;
      page.on("request", (request) => (asked += request.method() === "POST" && request.url().endsWith("/v1/family-atlases") ? 1 : 0));
      await page.reload();
      await family.checked();
      await page.locator(".job-tray > summary").click();
      await page.getByRole("button", { name: "Show: Atlas: slanted" }).click();
      await page.getByText("Making the atlas: stiffness").waitFor();
      assert.equal(asked, 0, "the job goes on after a reload, and is not begun again");
      await page.locator(".atlas").getByRole("button", { name: "Cancel" }).click();
      await until(async () => (await page.locator(".atlas .working").count()) === 0, "the end of it");
    }));
});

const ESTIMATE = { simulation: 9000, training: 3000, designs: 1800, chosen_designs: 900 };
const COST = { seconds: 1, stages: [], quantities: {} };

/** A family that the server has, so that it may be trained. */
async function withStored(act) {
  await removed("slanted");
  await fetch(`${server.url}/v1/families`, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ definition: SLANTED }) });
  await withFamily(linkTo(SLANTED), act);
  await removed("slanted");
}

describe("a training", () => {
  it("needs the family on the server, and a server that trains networks", async () => {
    await removed("slanted");
    await withFamily(linkTo(SLANTED), async (family, page) => {
      await page.getByText("A training needs the family on the server: add it first.").waitFor();
      assert.equal(await family.button("Train a network").isDisabled(), true);
    });
    await withStored(async (family, page) => {
      const problem = { type: "urn:supple:error:training.unavailable", title: "Networks are not trained here", status: 503, detail: "This server has no supple-lab, which trains networks.", code: "training.unavailable" };
      await page.route("**/v1/training-plans", (route) => route.fulfill({ status: 503, contentType: "application/problem+json", json: problem }));
      await family.button("Estimate").click();
      await page.locator(".training .note", { hasText: "This server trains no networks" }).waitFor();
    });
  });

  it("is estimated, draws its errors while it learns, is stopped and goes on, and ends with a network", () =>
    withStored(async (family, page) => {
      await page.route("**/v1/training-plans", (route) => route.fulfill({ json: { family: "slanted", estimate: ESTIMATE, effects: [], cost: COST } }));
      await family.button("Estimate").click();
      await page.locator(".plan", { hasText: "About 3.3 h of one core: 2.5 h for simulations of 1,800 designs and 50 min for networks." }).waitFor();
      const job = { id: "t1", kind: "trainings", state: "running", progress: 0.4, stage: "committee", priority: "background", created: "2026-01-01T00:00:00Z", deadline: 9, remaining_seconds: 4000 };
      job.partial = { family: "slanted", errors: [{ designs: 60, error: 0.12 }, { designs: 90, error: 0.07 }] };
      const requests = [];
      await page.route("**/v1/trainings", (route) => {
        requests.push(route.request().postDataJSON());
        return route.fulfill({ status: 202, json: job });
      });
      await page.route("**/v1/jobs/t1", (route) => route.fulfill({ json: job }));
      await page.getByLabel("End earlier at a mean error of").selectOption("0.02");
      await family.button("Train a network").click();
      await page.getByText("slanted is being trained. So far: 7 % in the mean, with 90 designs.").waitFor();
      assert.match(await page.locator(".training .convergence").getAttribute("aria-label"), /12 % at first, 7 % after 90/);
      await picture(page, "family-training");
      await page.locator(".training").getByRole("button", { name: "Cancel" }).click();
      await page.getByText(/^The training of slanted is stopped\. What is done is kept/).waitFor();
      await page.unroute("**/v1/trainings");
      await page.route("**/v1/trainings", (route) => {
        requests.push(route.request().postDataJSON());
        return route.fulfill({ json: { model: "slanted-1", family: "slanted", error: 0.019, designs: 150, estimate: ESTIMATE, effects: [], cost: COST } });
      });
      await family.button("Go on").click();
      await page.locator(".run-words", { hasText: "The network slanted-1 has learned from 150 designs." }).waitFor();
      assert.deepEqual(requests[1], requests[0]);
      assert.deepEqual(requests[0], { family: "slanted", budget: { core_seconds: 14_400 }, accuracy: { error: 0.02 }, priority: "background" });
    }));
});

describe("a finger", () => {
  it("drags a vertex on a phone, where nothing is wider than the screen", async () => {
    const options = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };
    await withFamily(linkTo(SLANTED), async (family, page) => {
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "no scrolling to the side");
      await family.handle("Vertex 3").scrollIntoViewIfNeeded();
      const [x, y] = await family.centre("Vertex 3");
      const touch = await page.context().newCDPSession(page);
      const send = (type, points) => touch.send("Input.dispatchTouchEvent", { type, touchPoints: points });
      await send("touchStart", [{ x, y }]);
      for (let step = 1; step <= 5; ++step) await send("touchMove", [{ x: x + 4 * step, y: y - 3 * step }]);
      await send("touchEnd", []);
      await until(async () => (await family.value("Slant")) > 0.3, "the parameter that has moved");
      await picture(page, "family-390");
    }, options);
  });

  it("opens the list of types on a phone, within the screen", async () => {
    const page = await openPage(browser, `${server.url}/#/family`, { viewport: { width: 390, height: 844 }, hasTouch: true });
    await page.locator(".type-menu summary").click();
    await page.getByRole("button", { name: "IH01, 4 parameters" }).waitFor();
    const { x, width } = await page.locator(".type-menu .menu-body").boundingBox();
    assert.ok(x >= 0 && x + width <= 390, `${x} to ${x + width}`);
    await picture(page, "family-types-390");
    await closePage(page);
  });
});
