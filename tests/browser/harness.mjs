// The test harness: a real server with the built editor, and a real browser. Unexpected messages of a page are failures.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { copyFile, cp, mkdir, mkdtemp, rm } from "node:fs/promises";
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
/** Models of two families, which offer a choice and still allow quick searches over all families. */
const MODELS = ["ih29.h5", "ih67.h5"];
const ATLASES = "models/families/atlas";
const START_MS = 60_000;
/** Folder for pictures of the pages; without it none are taken. */
const SCREENS = process.env.SUPPLE_SCREENS;
export const WAIT_MS = 60_000;

async function freePort() {
  const probe = createServer();
  await new Promise((resolve) => probe.listen(0, "127.0.0.1", resolve));
  const { port } = probe.address();
  await new Promise((resolve) => probe.close(resolve));
  return port;
}

/** A supple-server whose port stays the same over restarts. */
export class Server {
  /** Starts a server. `keys`: it requires a key, which is then in `key`. */
  static async start({ keys = false, models = MODELS } = {}) {
    for (const file of [SERVER, path.join(EDITOR, "index.html")]) assert.ok(existsSync(file), `${file} is missing: build it first`);
    const server = new Server();
    server.folder = await mkdtemp(path.join(tmpdir(), "supple-browser-"));
    await mkdir(path.join(server.folder, "models"));
    for (const model of models) await copyFile(path.join(ROOT, "models", model), path.join(server.folder, "models", model));
    // The atlases of the families come with the models.
    await cp(path.join(ROOT, ATLASES), path.join(server.folder, ATLASES), { recursive: true });
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
        // the server is not ready yet
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
 * WebGL runs on the CPU here. The rest of a page is rasterized without the emulated device, which takes half the time; Debian's Chromium
 * would use the device for it by default. Compositing still uses the device, because reading each picture back takes longer.
 */
const WEBGL = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-gpu-rasterization"];

function optionsOf(webgl) {
  return {
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: ["--no-sandbox", ...(webgl ? WEBGL : ["--disable-gpu"])], // root has no sandbox in a container
  };
}

export function launch({ webgl = false } = {}) {
  return chromium.launch(optionsOf(webgl));
}

/** A browser to which several test files connect, each with its own pages. */
export function launchServer({ webgl = false } = {}) {
  return chromium.launchServer(optionsOf(webgl));
}

/** The addresses of the shared server and browsers that all.mjs has started. */
const SHARED = process.env.SUPPLE_SHARED ? JSON.parse(process.env.SUPPLE_SHARED) : undefined;

/** Server and browser of a test file. They are set before the first test, and closed or left after the last. */
export let server;
export let browser;
/** Sets up server and browser for a test file. The server is not shared if it requires keys, if it has other models, or with `own`, for tests that stop it. */
export function setUp(options = {}) {
  const shares = SHARED && !options.own && !options.keys && !options.models;
  before(async () => {
    server = shares ? { url: SHARED.url, async close() {} } : await Server.start(options);
    if (SHARED) downloads = await mkdtemp(path.join(tmpdir(), "supple-downloads-"));
    browser = SHARED ? await chromium.connect(options.webgl ? SHARED.webgl : SHARED.plain) : await launch(options);
  });
  after(async () => {
    await browser?.close(); // a shared browser keeps running and closes only the pages of this file
    await server?.close();
    if (downloads) await rm(downloads, { recursive: true, force: true });
  });
}

/** Folder for downloads from a shared browser, which does not report the paths of its own copies. */
let downloads;
let fileCount = 0;
function keepDownloads(page) {
  page.on("download", (download) => {
    const file = path.join(downloads, `${++fileCount}-${path.basename(download.suggestedFilename())}`);
    let saved;
    download.path = () => (saved ??= download.saveAs(file).then(() => file));
  });
}

/**
 * Allowed messages of the console. Failed requests are among them, because pages handle and show these. A page that is left for about:blank
 * may still ask for its icon, which is refused then.
 */
const EXPECTED = [/Failed to load resource/, /GPU stall due to ReadPixels/, /GL Driver Message/, /favicon\.svg' from origin 'null'/];

/**
 * Opens a page that records its complaints and the requests for designs. `background`: whether the design page verifies and looks for ways
 * out by itself. It does not otherwise, since each such request would be counted and would compete with the others. `firstVisit`: whether
 * the page shows the words for a first visit. `patience`: how long actions and searches may take.
 */
export async function openPage(browser, url, { background = false, firstVisit = false, patience = WAIT_MS, ...options } = {}) {
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, acceptDownloads: true, ...options });
  if (!background) await context.addInitScript(() => location.protocol.startsWith("http") && localStorage.setItem("supple-background", "off"));
  const page = await context.newPage();
  page.setDefaultTimeout(patience);
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
  // Requests are counted in the page, because the browser may report the end of one after the beginning of the next.
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
  if (!firstVisit) {
    await page.addInitScript(() => {
      try {
        localStorage.setItem("supple-welcome", "closed");
      } catch {
        // an empty page has no storage
      }
    });
  }
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
 * Answers requests to `path` for which `holds` is true with a job that never ends. The test sets its progress with `tell(progress, stage)`,
 * also before the first request. The job has no event stream, so that pages poll it.
 */
export async function heldJob(page, path, holds = () => true) {
  const job = { id: "held", kind: "designs", state: "running", progress: 0, stage: "", priority: "normal", created: "2026-01-01T00:00:00Z", deadline: 600, remaining_seconds: null };
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

/** Records all announcements to screen readers from now on, even short-lived ones. The returned function gives them. */
export async function announcements(page) {
  await page.evaluate(() => {
    const region = document.getElementById("announcements");
    window.heard = [];
    new MutationObserver(() => window.heard.push(region.textContent)).observe(region, { childList: true, characterData: true, subtree: true });
  });
  return () => page.evaluate(() => window.heard);
}

/** Records all texts of the first element of a selector from now on, even short-lived ones. The returned function gives them. */
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

/** Waits until check() returns a truthy value, and returns that. */
export async function until(check, what, wait = WAIT_MS) {
  const end = Date.now() + wait;
  for (;;) {
    const value = await check();
    if (value) return value;
    assert.ok(Date.now() < end, `${what} did not happen within ${wait} ms`);
    await new Promise((resolve) => setTimeout(resolve, 40));
  }
}
