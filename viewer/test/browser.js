/** Headless Chromium, and what tests ask of a page that shows the viewer. */

import { existsSync } from "node:fs";
import { join } from "node:path";
import { after, before } from "node:test";
import { chromium } from "playwright-core";
import { GOLDEN, ROOT } from "./command.js";
import { readPng, rgba } from "./png.js";
import { serve } from "./server.js";

const PLACES = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
export const CHROMIUM = PLACES.find((path) => path && existsSync(path));
const PATIENCE = 60_000;

export function launch() {
  if (!CHROMIUM) throw new Error("the tests need Chromium (Debian: apt-get install chromium), or CHROMIUM=/path/to/it");
  return chromium.launch({ executablePath: CHROMIUM, args: ["--no-sandbox"] });
}

/** What the tests of a file have: a browser, and a server of golden streams, the package and test pages. */
export function stand() {
  const found = {};
  before(async () => {
    const pages = { "/files/": GOLDEN, "/src/": join(ROOT, "viewer/src"), "/": join(ROOT, "viewer/test/pages") };
    found.server = await serve(pages);
    found.browser = await launch();
  });
  after(async () => {
    await found.browser?.close();
    await found.server?.close();
  });
  return found;
}

/** A new page of 800×600 pixels. What it throws fails the test that asks `errors`. script: what runs before its own. */
export async function pageOf(browser, address, { script, ...options } = {}) {
  const context = await browser.newContext({ viewport: { width: 800, height: 600 }, ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(PATIENCE);
  page.errors = [];
  page.on("pageerror", (error) => page.errors.push(error.message));
  if (script) await page.addInitScript(script);
  await page.goto(address);
  return page;
}

/** Waits until the page shows the best there is of what it should show. */
export async function settled(page) {
  await page.waitForFunction(() => globalThis.sgiViewer?.scene.layers.length && sgiViewer.scene.isDone, null, { polling: 50 });
}

/** Has the upper left corner of the canvas show the picture from (x, y) on, at a scale. */
export async function show(page, x, y, scale) {
  await page.evaluate(
    ([left, top, factor]) =>
      sgiViewer.scene.move((camera) => {
        camera.scale = factor;
        camera.x = left + camera.columns / 2 / factor;
        camera.y = top + camera.rows / 2 / factor;
      }),
    [x, y, scale],
  );
  await settled(page);
}

/** Pixels of the screen from the canvas's upper left corner on. */
export async function shot(page, width, height) {
  await page.evaluate(() => document.activeElement?.blur());
  return rgba(readPng(await page.screenshot({ clip: { x: 0, y: 0, width, height } })));
}

/** The sentence that the page shows, once it shows one. */
export async function message(page) {
  await page.waitForSelector("#message:not([hidden])");
  return page.textContent("#message");
}

/** What workers were asked while the picture moved by 8 pixels of the screen to the right, eight times. */
export function askedWhilePanning(page) {
  return page.evaluate(async () => {
    const { scene } = sgiViewer;
    scene.refine = () => (scene.timer = 0);
    const tasks = [];
    const { file } = scene.decoder;
    const run = file.run.bind(file);
    file.run = (task, ...rest) => tasks.push(task) && run(task, ...rest);
    for (let step = 0; step < 8; step++) {
      scene.move((camera) => camera.pan(-8, 0));
      await new Promise((drawn) => scene.addEventListener("drawn", drawn, { once: true }));
    }
    return tasks;
  });
}
