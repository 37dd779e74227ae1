// A real server with the built editor, and a real browser. Everything that a page should never say is a failure.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { mkdir, mkdtemp, rm, copyFile } from "node:fs/promises";
import { existsSync } from "node:fs";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import path from "node:path";
import { after, before } from "node:test";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const ROOT = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");
const BUILD = process.env.SUPPLE_BUILD ?? path.join(ROOT, "build/release");
const SERVER = path.join(BUILD, "server/supple-server");
const EDITOR = process.env.SUPPLE_EDITOR ?? path.join(ROOT, "clients/web/dist");
/** Models of two families: enough for a choice, few enough for a quick search over all. */
const MODELS = ["ih29.h5", "ih67.h5"];
const START_MS = 60_000;
/** Where pictures of the pages go; none are taken without it. */
const SCREENS = process.env.SUPPLE_SCREENS;
export const WAIT_MS = 60_000;

async function freePort() {
  const probe = createServer();
  await new Promise((resolve) => probe.listen(0, "127.0.0.1", resolve));
  const { port } = probe.address();
  await new Promise((resolve) => probe.close(resolve));
  return port;
}

/** supple-server on a port that it keeps over restarts. */
export class Server {
  /** `keys`: it answers holders of a key alone, which is `key`. */
  static async start({ keys = false, models = MODELS } = {}) {
    for (const file of [SERVER, path.join(EDITOR, "index.html")]) assert.ok(existsSync(file), `${file} is missing: build it first`);
    const server = new Server();
    server.folder = await mkdtemp(path.join(tmpdir(), "supple-browser-"));
    await mkdir(path.join(server.folder, "models"));
    for (const model of models) await copyFile(path.join(ROOT, "models", model), path.join(server.folder, "models", model));
    const data = path.join(server.folder, "data");
    if (keys) server.key = execFileSync(SERVER, ["keys", "add", "--data", data, "--name", "a person", "--scopes", "read,compute"], { encoding: "utf8", stdio: ["ignore", "pipe", "ignore"] }).trim();
    server.port = await freePort();
    server.url = `http://127.0.0.1:${server.port}`;
    await server.run();
    return server;
  }

  async run() {
    const options = ["--port", String(this.port), "--data", path.join(this.folder, "data"), "--models", path.join(this.folder, "models"), "--web", EDITOR];
    this.log = "";
    this.process = spawn(SERVER, options, { stdio: ["ignore", "pipe", "pipe"] });
    for (const stream of [this.process.stdout, this.process.stderr]) stream.on("data", (text) => (this.log += text));
    const end = Date.now() + START_MS;
    while (Date.now() < end) {
      if (this.process.exitCode !== null) throw new Error(`the server ended with ${this.process.exitCode}:\n${this.log}`);
      try {
        if ((await fetch(`${this.url}/readyz`)).ok) return;
      } catch {
        // not yet
      }
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
    throw new Error(`the server was not ready within ${START_MS} ms:\n${this.log}`);
  }

  async stop() {
    const ended = new Promise((resolve) => this.process.once("exit", resolve));
    if (this.process.exitCode === null) {
      this.process.kill("SIGTERM");
      await ended;
    }
  }

  async close() {
    await this.stop();
    await rm(this.folder, { recursive: true, force: true });
  }
}

/**
 * WebGL is computed by the processor here. The rest of a page is drawn without it, in half the time: Debian's Chromium would
 * have the emulated device draw that too. Its pictures are still put together there, for to read each one back takes longer.
 */
const WEBGL = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-gpu-rasterization"];

function optionsOf(webgl) {
  return {
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: ["--no-sandbox", ...(webgl ? WEBGL : ["--disable-gpu"])], // root in a container has no sandbox
  };
}

export function launch({ webgl = false } = {}) {
  return chromium.launch(optionsOf(webgl));
}

/** A browser to which several files of tests connect, each with pages of its own. */
export function launchServer({ webgl = false } = {}) {
  return chromium.launchServer(optionsOf(webgl));
}

/** What all.mjs has started for all files: the server's address and those of the browsers. */
const SHARED = process.env.SUPPLE_SHARED ? JSON.parse(process.env.SUPPLE_SHARED) : undefined;

/** What a file of tests works with: there before its first test, left or ended after its last. */
export let server;
export let browser;
/** `own`: the file stops its server on the way. It never shares one that asks for keys or has other models, either. */
export function setUp(options = {}) {
  const shares = SHARED && !options.own && !options.keys && !options.models;
  before(async () => {
    server = shares ? { url: SHARED.url, async close() {} } : await Server.start(options);
    if (SHARED) downloads = await mkdtemp(path.join(tmpdir(), "supple-downloads-"));
    browser = SHARED ? await chromium.connect(options.webgl ? SHARED.webgl : SHARED.plain) : await launch(options);
  });
  after(async () => {
    await browser?.close(); // a shared one loses the pages of this file, and goes on
    await server?.close();
    if (downloads) await rm(downloads, { recursive: true, force: true });
  });
}

/** Where files from a shared browser are kept: it does not tell where its own are. */
let downloads;
let fileCount = 0;
function keepDownloads(page) {
  page.on("download", (download) => {
    const file = path.join(downloads, `${++fileCount}-${path.basename(download.suggestedFilename())}`);
    let saved;
    download.path = () => (saved ??= download.saveAs(file).then(() => file));
  });
}

/** What the console may say: that a request failed is the page's business, and it must show it. */
const EXPECTED = [/Failed to load resource/, /GPU stall due to ReadPixels/, /GL Driver Message/];

/** A page that remembers what it complained about, and which designs were asked for. */
export async function openPage(browser, url, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, acceptDownloads: true, ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(WAIT_MS);
  if (SHARED) keepDownloads(page);
  page.complaints = [];
  page.on("pageerror", (error) => page.complaints.push(error.stack ?? String(error)));
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type()) && !EXPECTED.some((known) => known.test(message.text()))) page.complaints.push(message.text());
  });
  page.designs = { asked: [], answered: 0 };
  const isDesign = (request) => request.method() === "POST" && request.url().endsWith("/v1/designs");
  page.on("request", (request) => {
    if (!isDesign(request)) return;
    page.designs.asked.push(request.postDataJSON());
  });
  page.on("requestfinished", (request) => {
    if (isDesign(request)) ++page.designs.answered;
  });
  // Counted where they are sent: what the browser reports of a request's end may come after the next one's beginning.
  await page.addInitScript(() => {
    window.designsAtOnce = { running: 0, most: 0 };
    const send = window.fetch;
    window.fetch = (...request) => {
      const sent = send(...request);
      if (!String(request[0]?.url ?? request[0]).endsWith("/v1/designs")) return sent;
      const count = window.designsAtOnce;
      count.most = Math.max(count.most, ++count.running);
      return sent.finally(() => --count.running);
    };
  });
  await page.goto(url);
  return page;
}

export async function closePage(page) {
  await page.context().close();
  assert.deepEqual(page.complaints, []);
}

export async function picture(page, name) {
  if (!SCREENS) return;
  await mkdir(SCREENS, { recursive: true });
  await page.screenshot({ path: path.join(SCREENS, `${name}.png`) });
}

/**
 * Answers requests to `path` that `holds` is true of by a job that never ends and is as far as the test says: `tell(progress, stage)`
 * before the first of them and whenever it goes on. Pages ask after it, since it has no events.
 */
export async function heldJob(page, path, holds = () => true) {
  const job = { id: "held", kind: "designs", state: "running", progress: 0, stage: "", created: "2026-01-01T00:00:00Z", deadline: 600 };
  const problem = { type: "urn:supple:error:server.too_many_event_streams", title: "Too many event streams", status: 503, detail: "Ask after the job instead.", code: "server.too_many_event_streams" };
  await page.route(`**${path}`, (route) => (holds(route.request()) ? route.fulfill({ status: 202, json: job }) : route.fallback()));
  await page.route("**/v1/jobs/held", (route) => route.fulfill({ status: 200, json: job }));
  await page.route("**/v1/jobs/held/events", (route) => route.fulfill({ status: 503, contentType: "application/problem+json", json: problem }));
  return {
    tell(progress, stage) {
      Object.assign(job, { progress, stage });
    },
  };
}

/** From now on keeps what a screen reader is given to say, however soon the next sentences follow; calling the result gives all of it. */
export async function announcements(page) {
  await page.evaluate(() => {
    const region = document.getElementById("announcements");
    window.heard = [];
    new MutationObserver(() => window.heard.push(region.textContent)).observe(region, { childList: true, characterData: true, subtree: true });
  });
  return () => page.evaluate(() => window.heard);
}

/** From now on keeps what the first element of a kind says, however soon it says something else; calling the result gives all of it. */
export async function wordsOf(page, selector) {
  await page.evaluate((wanted) => {
    window.said = [];
    new MutationObserver(() => {
      const words = document.querySelector(wanted)?.textContent;
      if (words && words !== window.said.at(-1)) window.said.push(words);
    }).observe(document.body, { childList: true, characterData: true, subtree: true });
  }, selector);
  return () => page.evaluate(() => window.said);
}

/** Waits until check() gives something true, and returns it. */
export async function until(check, what, wait = WAIT_MS) {
  const end = Date.now() + wait;
  for (;;) {
    const value = await check();
    if (value) return value;
    assert.ok(Date.now() < end, `${what} did not happen within ${wait} ms`);
    await new Promise((resolve) => setTimeout(resolve, 40));
  }
}
