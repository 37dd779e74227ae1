// Runs test files one after another with one shared server and one shared browser of each kind, so that each starts only once:
//
//     node tests/browser/all.mjs [file ...]     runs all files of this folder if none are named
//
// `node --test FILE` runs one file with its own server and browser.
import { spawn } from "node:child_process";
import { readdir } from "node:fs/promises";
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

const given = process.argv.slice(2);
const files = given.length > 0 ? given : (await readdir(folder)).filter((name) => name.endsWith(".test.mjs")).sort();
const server = await Server.start();
const browsers = { plain: await launchServer(), webgl: await launchServer({ webgl: true }) };
const shared = { url: server.url, plain: browsers.plain.wsEndpoint(), webgl: browsers.webgl.wsEndpoint() };
let reached = 0;
let failed = 0;
try {
  for (const file of files) {
    const begin = Date.now();
    const { status, output } = await run(path.resolve(folder, path.basename(file)), shared);
    const count = (what) => Number(output.match(new RegExp(`^# ${what} (\\d+)$`, "m"))?.[1] ?? 0);
    reached += count("tests");
    if (status !== 0 || server.process.exitCode !== null) {
      ++failed;
      console.log(output);
    }
    console.log(`${path.basename(file)}: tests ${count("tests")}, pass ${count("pass")}, fail ${count("fail")}, ${Math.round((Date.now() - begin) / 1000)} s`);
    if (server.process.exitCode !== null) {
      console.log(`the server ended with ${server.process.exitCode}:\n${server.log.slice(-4000)}`);
      break;
    }
  }
} finally {
  await browsers.plain.close();
  await browsers.webgl.close();
  await server.close();
}
console.log(`${reached} browser tests were reached`);
process.exitCode = failed > 0 || reached === 0 ? 1 : 0;
