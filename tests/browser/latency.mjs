// The latency of a dragged control point: from the mouse event to the repaint after the tiling was redrawn, in a real browser with the
// real page and a real server with all models.
//
//     node latency.mjs ../../docs/bench [DRAGS] [--busy N]
//
// writes editor-latency.csv and a section of designs.md there. The numbers are meaningful only on an otherwise idle machine. With --busy
// the drags are measured once more while N processes compute at the server's own priority of the system (nice 0). The
// section and the table are written anew by each run, so that the figures of a busy machine are there only after a run with --busy.
import { spawn } from "node:child_process";
import { readdir, readFile, writeFile } from "node:fs/promises";
import os from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { DesignPage } from "./design_page.mjs";
import { launch, Server } from "./harness.mjs";

/** A family with three parameters; families have one to four. The searches between the drags are of this family. */
const FAMILY = "IH22";
const REDRAW_MS = 5_000;
/** Lengths of the drags, which go back and forth. They differ, and are long enough that the design changes. */
const PIXELS = [9, 14, 19, 24];
const ASKED_MS = 100;
const ASKED_BUSY_MS = 200;

const { values: options, positionals } = parseArgs({ allowPositionals: true, options: { busy: { type: "string", default: "0" } } });
const [folder, count = "60"] = positionals;
const DRAGS = Number(count);
const BUSY = Number(options.busy);
if (!folder || !(DRAGS > 0) || !(Number.isInteger(BUSY) && BUSY >= 0)) {
  console.error("usage: node latency.mjs FOLDER [DRAGS] [--busy N]");
  process.exit(1);
}

/** Runs in the page: records the time of the last mouse event, and the times at which the drawings after it became visible. */
function watch() {
  const seen = { mouse: NaN, curve: NaN, tiling: NaN };
  window.seen = seen;
  window.addEventListener("pointermove", (event) => {
    if (event.buttons === 1 && Number.isNaN(seen.mouse)) seen.mouse = event.timeStamp;
  }, { capture: true });
  const note = (what) => {
    if (Number.isNaN(seen.mouse) || !Number.isNaN(seen[what])) return;
    const before = seen.mouse;
    // A task that is queued in an animation frame runs after that frame was drawn.
    requestAnimationFrame(() => setTimeout(() => {
      if (before === seen.mouse) seen[what] = performance.now();
    }));
  };
  const changes = (selector, what) => new MutationObserver(() => note(what)).observe(document.querySelector(selector), { attributes: true, attributeFilter: ["d"] });
  changes(".tiling .solid", "tiling");
  changes(".plot .curve.achieved", "curve");
}

async function measureDrag(design, index, pixels) {
  const { page } = design;
  const [x, y] = await design.centre(index);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.evaluate(() => Object.assign(window.seen, { mouse: NaN, curve: NaN, tiling: NaN }));
  await page.mouse.move(x, y + pixels);
  const redrawn = await page.waitForFunction(() => !Number.isNaN(window.seen.tiling), undefined, { timeout: REDRAW_MS, polling: 20 }).then(() => true, () => false);
  const { mouse, curve, tiling } = await page.evaluate(() => window.seen);
  await page.mouse.up();
  await design.settled();
  return { curve: curve - mouse, tiling: redrawn ? tiling - mouse : NaN };
}

async function measureDrags(design, index) {
  const rows = [];
  for (let drag = 0; drag < DRAGS; ++drag) {
    const pixels = PIXELS[Math.floor(drag / 2) % PIXELS.length] * (drag % 2 === 0 ? -1 : 1);
    const { curve, tiling } = await measureDrag(design, index, pixels);
    rows.push({ drag: drag + 1, pixels, curve, tiling, load: os.loadavg()[0] });
  }
  return rows;
}

/** Calls `work` while `count` processes compute. They end with it. */
async function whileBusy(count, work) {
  const processes = Array.from({ length: count }, () => spawn(process.execPath, ["-e", "for (;;);"], { stdio: "ignore" }));
  try {
    return await work();
  } finally {
    for (const one of processes) one.kill("SIGKILL");
  }
}

/** A quantile of values, with linear interpolation between neighbours. */
function quantile(values, share) {
  const sorted = [...values].sort((a, b) => a - b);
  const at = share * (sorted.length - 1);
  const lower = Math.floor(at);
  return sorted[lower] + (at - lower) * ((sorted[lower + 1] ?? sorted[lower]) - sorted[lower]);
}

const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");
const models = (await readdir(path.join(root, "models"))).filter((name) => name.endsWith(".h5"));
const server = await Server.start({ models });
const browser = await launch();
let rows = [];
let busyRows = [];
const load = [os.loadavg()[0]];
try {
  const design = await DesignPage.open(browser, server.url);
  const { page } = design;
  await page.getByLabel("Family of tilings").selectOption(FAMILY);
  await design.settled();
  await page.evaluate(watch);
  const index = await design.movable();
  rows = await measureDrags(design, index);
  load.push(os.loadavg()[0]);
  if (BUSY > 0) busyRows = await whileBusy(BUSY, () => measureDrags(design, index));
} finally {
  await browser.close();
  await server.close();
}

const measured = (of, what) => of.map((row) => row[what]).filter(Number.isFinite);
const known = measured(rows, "tiling");
const missed = rows.length - known.length;
const curves = measured(rows, "curve");
const ms = (value) => `${Math.round(value)} ms`;
const [median, p90] = [quantile(known, 0.5), quantile(known, 0.9)];
const cores = os.cpus();
// Only the load before the measurement counts, because the measurement itself causes load.
const busy = load[0] > 0.5 * cores.length;
const table = (name, values) => `| ${name} | ${ms(quantile(values, 0.5))} | ${ms(quantile(values, 0.9))} | ${ms(Math.max(...values))} |`;
const busyMedian = BUSY > 0 ? quantile(measured(busyRows, "tiling"), 0.5) : NaN;
const busyMissed = busyRows.length - measured(busyRows, "tiling").length;
const busyText = BUSY === 0 ? "" : `
The same drags once more, while ${BUSY} other ${BUSY === 1 ? "process computes" : "processes compute"} without a pause:

| From the mouse to | Median | 90 of 100 | Longest |
|---|--:|--:|--:|
${table("the design's curve", measured(busyRows, "curve"))}
${table("the tiling", measured(busyRows, "tiling"))}

Asked is a median of less than ${ASKED_BUSY_MS} ms. ${busyMedian < ASKED_BUSY_MS ? "It is met." : "It is not met."}${busyMissed === 0 ? "" : ` In ${busyMissed} drags the tiling did not change within ${REDRAW_MS / 1000} s.`}
`;
const lines = (of, processes) => of.map(({ drag, pixels, curve, tiling, load: now }) =>
  [drag, pixels, Number.isFinite(curve) ? curve.toFixed(1) : "", Number.isFinite(tiling) ? tiling.toFixed(1) : "", now.toFixed(2), processes].join(","));
await writeFile(path.join(folder, "editor-latency.csv"), `${["drag,pixels,curve_ms,tiling_ms,load,busy_processes", ...lines(rows, 0), ...lines(busyRows, BUSY)].join("\n")}\n`);
const file = path.join(folder, "designs.md");
const [begin, end] = ["<!-- section: editor -->\n", "<!-- /section: editor -->\n"];
const old = await readFile(file, "utf8").catch(() => "# Measurements: designs\n");
const [before, after] = old.includes(begin) ? [old.split(begin)[0], old.split(end)[1]] : [`${old}\n`, ""];
await writeFile(file, `${before}${begin}## How fast the editor follows the mouse

A control point of a target is dragged ${rows.length} times on the page *Design* in headless Chromium, with a server that has all models. Each time the clock runs from the
mouse's event to the picture after the tiling was redrawn. In between are the search for a design that follows the moved target, the drawing of its curve, and the
request for its structure and the drawing of that. The family is ${FAMILY}. [All drags](editor-latency.csv).

\`\`\`text
node tests/browser/latency.mjs docs/bench${count === "60" ? "" : ` ${DRAGS}`}${BUSY > 0 ? ` --busy ${BUSY}` : ""}
\`\`\`

| From the mouse to | Median | 90 of 100 | Longest |
|---|--:|--:|--:|
${table("the design's curve", curves)}
${table("the tiling", known)}

Measured on ${new Date().toISOString().slice(0, 10)} on ${cores.length} cores of ${cores[0].model.trim()}, with a load of ${load[0].toFixed(1)} (average of one minute) before
and ${load[1].toFixed(1)} after, of the measurement itself. ${busy ? "The machine was busy with other work, so that these are no times of an idle machine; measure again there." : "The machine did nothing else."}
${missed === 0 ? "Every drag changed the tiling." : `In ${missed} drags the tiling did not change within ${REDRAW_MS / 1000} s; they are not in the table.`}

Asked is a median of less than ${ASKED_MS} ms on an idle machine. ${median < ASKED_MS ? "It is met." : busy ? "It is not met on this busy one." : "It is not met."}
${busyText}${end}${after}`);
console.log(`median ${ms(median)}, 90 of 100 within ${ms(p90)}, of ${known.length} drags; load ${load.map((value) => value.toFixed(1)).join(" to ")}`);
if (BUSY > 0) console.log(`median ${ms(busyMedian)} while ${BUSY} processes compute`);
