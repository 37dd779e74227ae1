// Signing in on a server that requires a key.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { browser, closePage, openPage, picture, server, setUp } from "./harness.mjs";

setUp({ keys: true });

const dialog = (page) => page.getByRole("dialog", { name: "Sign in" });

describe("signing in", () => {
  it("is asked for once, goes on where the page was, and outlives a reload", async () => {
    const page = await openPage(browser, server.url);
    await dialog(page).waitFor();
    await picture(page, "sign-in");
    assert.equal(await page.locator("dialog[open]").count(), 1);
    await page.keyboard.press("Escape");
    assert.ok(await dialog(page).isVisible(), "without a key there is nothing to see");

    const key = dialog(page).getByLabel("Key");
    await key.fill(`${server.key.slice(0, -1)}${server.key.endsWith("0") ? "1" : "0"}`);
    await dialog(page).getByRole("button", { name: "Sign in" }).click();
    await dialog(page).getByText("The server does not accept this key.").waitFor();
    await key.fill(server.key);
    await page.keyboard.press("Enter");
    await dialog(page).waitFor({ state: "hidden" });
    await page.locator(".plot-card path").first().waitFor({ state: "attached" });
    await page.getByText("a person").waitFor();
    assert.ok(!(await page.content()).includes(server.key), "the key is kept nowhere");
    assert.deepEqual(await page.evaluate(() => [document.cookie, localStorage.length ? JSON.stringify(localStorage) : ""].filter((kept) => /supple_/.test(kept))), []);
    const cookies = await page.context().cookies();
    assert.deepEqual(cookies.map((cookie) => [cookie.name, cookie.httpOnly, cookie.sameSite]), [["supple_session", true, "Strict"]]);

    await page.reload();
    await page.getByRole("button", { name: "Sign out" }).waitFor();
    assert.ok(!(await dialog(page).isVisible()));
    await page.setViewportSize({ width: 360, height: 740 });
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "who is signed in does not make the page wider than a small screen");
    await picture(page, "sign-in-small");
    await closePage(page);
  });

  it("ends where somebody signs out", async () => {
    const page = await openPage(browser, server.url);
    await dialog(page).getByLabel("Key").fill(server.key);
    await page.keyboard.press("Enter");
    await page.getByRole("button", { name: "Sign out" }).click();
    await dialog(page).waitFor();
    assert.deepEqual(await page.context().cookies(), []);
    await closePage(page);
  });
});
