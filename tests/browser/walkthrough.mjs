// What the walkthroughs of docs/walkthroughs share: their files, generous waits, and their pictures. With SUPPLE_WALKTHROUGHS=FOLDER the
// tests write a picture of each step there, as in
//
//     SUPPLE_WALKTHROUGHS=docs/images/walkthroughs node --test tests/browser/walkthrough_*.test.mjs
//     docs/images/palette.py docs/images/walkthroughs/*.png
//
// where the second line makes the files small.
import { mkdir, readFile } from "node:fs/promises";
import path from "node:path";

const PICTURES = process.env.SUPPLE_WALKTHROUGHS;
/** A person waits for a simulation; a test waits longer, because other tests may have the cores. */
export const PATIENCE_MS = 300_000;
/** The window of the pictures, and how long its page may take. */
export const WINDOW = { patience: PATIENCE_MS, viewport: { width: 1280, height: 800 }, colorScheme: "light", reducedMotion: "reduce" };
/** All models, as a person's own server has them. */
export const ALL_MODELS = ["ih01.h5", "ih21.h5", "ih22.h5", "ih28.h5", "ih29.h5", "ih50.h5", "ih67.h5"];

/** The text of a file that a walkthrough offers for download. */
export function fileOf(name) {
  return readFile(new URL(`../../docs/walkthroughs/files/${name}`, import.meta.url), "utf8");
}

/** Takes the picture of a step after the page was drawn; `from` is brought to the top of the window. */
export async function step(page, name, from) {
  if (!PICTURES) return;
  if (from) await from.evaluate((element) => scrollTo(0, Math.max(0, element.getBoundingClientRect().top + scrollY - 70)));
  else await page.evaluate(() => scrollTo(0, 0));
  await page.mouse.move(2, 2);
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  await mkdir(PICTURES, { recursive: true });
  await page.screenshot({ path: path.join(PICTURES, `${name}.png`) });
}

/** The file that a press saves: its name and its bytes. */
export async function savedFile(page, press) {
  const waiting = page.waitForEvent("download");
  await press();
  const file = await waiting;
  return { name: file.suggestedFilename(), bytes: await readFile(await file.path()) };
}
