// Runs test files, two at a time where there are two cores, because a file mostly waits for the server or for its browser. Each of the two lanes has one
// server and one browser of each kind, which start only once:
//
//     node tests/browser/all.mjs [file ...]     runs all files of this folder if none are named
//
// `node --test FILE` runs one file with its own server and browser.
import { spawn } from "node:child_process";
import { readdir } from "node:fs/promises";
import { cpus } from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { launchServer, Server } from "./harness.mjs";

const folder = path.dirname(fileURLToPath(import.meta.url));

/** Runs the tests of a file with node. Returns the exit status and the output. */
function run(file, shared) {
  return new Promise((resolve) => {
    let output = "";
    const child = spawn(process.execPath, ["--test", "--test-reporter=tap", file], {
      env: { ...process.env, SUPPLE_SHARED: JSON.stringify(shared) },
      stdio: ["ignore", "pipe", "pipe"],
    });
    for (const stream of [child.stdout, child.stderr]) stream.on("data", (text) => (output += text));
    child.once("close", (status) => resolve({ status, output }));
  });
}

/** The files that take longest come first, so that neither lane has to wait for the other at the end. */
const LONGEST = ["network", "accessibility", "design", "regions", "verification", "targets", "made", "ways_out", "weave"].map((name) => `${name}.test.mjs`);
const LANES = Math.max(1, Math.min(2, Number(process.env.SUPPLE_JOBS) || cpus().length));

const given = process.argv.slice(2).map((file) => path.basename(file));
const found = given.length > 0 ? given : (await readdir(folder)).filter((name) => name.endsWith(".test.mjs")).sort();
const files = [...LONGEST.filter((file) => found.includes(file)), ...found.filter((file) => !LONGEST.includes(file))];
let reached = 0;
let failed = 0;

/** Takes files until none are left. A server that ends is a failure, and ends its lane. */
async function runLane() {
  const server = await Server.start();
  const browsers = { plain: await launchServer(), webgl: await launchServer({ webgl: true }) };
  const shared = { url: server.url, plain: browsers.plain.wsEndpoint(), webgl: browsers.webgl.wsEndpoint() };
  try {
    for (let file = files.shift(); file; file = files.shift()) {
      const begin = Date.now();
      const { status, output } = await run(path.resolve(folder, file), shared);
      const count = (what) => Number(output.match(new RegExp(`^# ${what} (\\d+)$`, "m"))?.[1] ?? 0);
      reached += count("tests");
      const serverEnded = server.process.exitCode !== null;
      if (status !== 0 || serverEnded) {
        ++failed;
        console.log(output);
      }
      console.log(`${file}: tests ${count("tests")}, pass ${count("pass")}, fail ${count("fail")}, ${Math.round((Date.now() - begin) / 1000)} s`);
      if (serverEnded) {
        console.log(`the server ended with ${server.process.exitCode}:\n${server.log.slice(-4000)}`);
        return;
      }
    }
  } finally {
    await browsers.plain.close();
    await browsers.webgl.close();
    await server.close();
  }
}

for (const lane of await Promise.allSettled(Array.from({ length: Math.min(LANES, files.length) }, runLane))) {
  if (lane.status === "fulfilled") continue;
  ++failed;
  console.log(lane.reason);
}
console.log(`${reached} browser tests were reached`);
process.exitCode = failed > 0 || reached === 0 || files.length > 0 ? 1 : 0;
